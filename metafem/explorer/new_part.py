"""The dialog for a new part, and its specification from a few values."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from nicegui import ui

from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.explorer.control import Control
from metafem.explorer.fields import with_points, with_unit
from metafem.explorer.table import Table, on_page, written
from metafem.files import quantity

# The fields with their labels, units and first values, those of the paper's part.
FIELDS = {
    "size": ("Block: width × length × thickness", "mm", "20 × 20 × 7.2"),
    "asperities": ("Asperities: rows × columns", "", "8 × 8"),
    "radius": ("Radius of curvature", "um", "526"),
    "modulus": ("Composite modulus E*", "MPa", "1.36"),
    "young": ("or Young's modulus E", "MPa", ""),
    "stress": ("Friction per contact area σB", "MPa", "0.31"),
    "coefficient": ("Friction coefficient μ", "", "1.5"),
    "loads": ("over the loads, such as 0.1 – 0.5; empty: any", "N", ""),
}
FIRST = {name: first for name, (_, _, first) in FIELDS.items()}

# Largest height of the summits over their radius, and error of a height [um].
HIGHEST, ERROR = 0.5, "0.9 um"

# What separates numbers.
SEPARATOR = re.compile(r"(?:[\s×xX*;–]|(?<![eE])-)+")


def new_part(typed: Mapping[str, str]) -> Table:
    """Return the table of a part from the texts of the fields; its lattice fills the block.

    Raises
    ------
    InvalidInput
        If sizes or numbers of asperities are no numbers. Other values are judged with the specification.

    Examples
    --------
    >>> new_part(FIRST)["lattice"]
    {'shape': [8, 8], 'pitch': '2.5 mm', 'radius': '526 um'}
    """
    width, length, thickness = _numbers("size", typed, 3)
    rows, columns = _numbers("asperities", typed, 2)
    if not (rows.is_integer() and columns.is_integer()):
        raise InvalidInput(f"asperities = {typed['asperities']} must be whole numbers, such as 8 × 8")
    stiffness = "young" if typed["young"].strip() else "modulus"
    radius, modulus, stress = (
        with_unit(typed[name], FIELDS[name][1]) for name in ("radius", stiffness, "stress")
    )
    highest = HIGHEST * MICROMETRES * quantity("radius", radius, "mm")
    target: dict[str, Any] = {
        "kind": "linear",
        "friction_coefficient": _number(with_points(typed["coefficient"])),
    }
    if typed["loads"].strip():
        target["load_range"] = [f"{load:g} N" for load in _numbers("loads", typed, 2)]
    material = {
        "young_modulus" if stiffness == "young" else "composite_modulus": modulus,
        "poisson_ratio": 0.5,
    }
    return {
        "target": target,
        "material": material,
        "friction": {"shear_strength": stress, "area_ratio": 1.0},
        "block": {"width": f"{width:g} mm", "length": f"{length:g} mm", "thickness": f"{thickness:g} mm"},
        "lattice": {
            "shape": [int(rows), int(columns)],
            "pitch": f"{min(width / columns, length / rows):.4g} mm",
            "radius": radius,
        },
        "limits": {"max_height": f"{highest:.6g} um", "height_sd": ERROR},
        "model": {"kind": "independent"},
    }


def _numbers(name: str, typed: Mapping[str, str], count: int) -> list[float]:
    """Return the numbers in the text of a field."""
    try:
        found = [float(each) for each in SEPARATOR.split(with_points(typed[name]).strip())]
    except ValueError:
        found = []
    if len(found) != count or not all(0.0 < each < float("inf") for each in found):
        example = FIELDS[name][2]
        raise InvalidInput(f"{name} = {typed[name]:.40} must be {count} numbers above 0, such as {example}")
    return found


def _number(text: str) -> float | str:
    """Return a number, or text that the reader of the specification reports."""
    try:
        return float(text)
    except ValueError:
        return text


class NewPart:
    """A dialog with the fields of a new part."""

    def __init__(self, page: Control) -> None:
        self.page = page

    def open(self, _: object) -> None:
        """Open the dialog."""
        self.dialog.open()

    @cached_property
    def dialog(self) -> ui.dialog:
        """The dialog, which is created when it is first opened."""
        with ui.dialog().props('aria-labelledby="new-part"') as dialog, ui.card().classes("new-part"):
            ui.html("<h2 id='new-part'>New part</h2>", sanitize=False)
            ui.label(
                "The lattice fills the block. Numbers have the units beside them. Undo restores the part."
            ).classes("quiet small")
            self.fields = {
                name: ui.input(label, value=first)
                .props(f'dense outlined suffix="{unit}"')
                .on("keydown.enter", self.make)
                for name, (label, unit, first) in FIELDS.items()
            }
            self.words = ui.label().classes("warn").props('role="status"')
            self.words.set_visibility(False)
            with ui.element("div").classes("row"):
                ui.button("Make it", on_click=self.make).props("no-caps unelevated")
                ui.button("Cancel", on_click=dialog.close).props("no-caps flat")
        return dialog

    async def make(self) -> None:
        """Show the part as one step of the history, or which value cannot be read."""
        try:
            text = written(new_part({name: field.value for name, field in self.fields.items()}))
        except InvalidInput as error:
            self.words.text = on_page(str(error))
            self.words.set_visibility(True)
            return
        self.words.set_visibility(False)
        self.dialog.close()
        await self.page.alter(text=text, load=None)
