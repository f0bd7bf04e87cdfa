"""The dialog for a new part, and its specification from a few values."""

from __future__ import annotations

import re
from collections.abc import Mapping

from nicegui import ui

from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.explorer.control import Control
from metafem.explorer.fields import with_points, with_unit
from metafem.explorer.table import Table, value_of, with_field, with_values, written
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

# The keys of the fields with a single value; of the two moduli, the last one that is typed.
KEYS = {
    "radius": "lattice.radius",
    "modulus": "material.composite_modulus",
    "young": "material.young_modulus",
    "stress": "friction.shear_strength",
    "coefficient": "target.friction_coefficient",
}

# What no field asks for, with the error of a height of the paper's moulds.
USUAL: Table = {
    "target": {"kind": "linear"},
    "material": {"poisson_ratio": 0.5},
    "friction": {"area_ratio": 1.0},
    "limits": {"height_sd": "0.9 um"},
    "model": {"kind": "independent"},
}

# Largest height of the summits over their radius.
HIGHEST = 0.5

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
    {'radius': '526 um', 'shape': [8, 8], 'pitch': '2.5 mm'}
    """
    width, length, thickness = _numbers("size", typed, 3)
    rows, columns = _numbers("asperities", typed, 2)
    if not (rows.is_integer() and columns.is_integer()):
        raise InvalidInput(f"asperities = {typed['asperities']} must be whole numbers, such as 8 × 8")
    table = USUAL
    for name, key in KEYS.items():
        if typed[name].strip():
            table = with_field(table, key, with_unit(typed[name], FIELDS[name][1]))
    radius = quantity("radius", value_of(table, "lattice.radius") or "", "mm")
    loads = [f"{load:g} N" for load in _numbers("loads", typed, 2)] if typed["loads"].strip() else None
    return with_values(
        table,
        {
            "target.load_range": loads,
            "block.width": f"{width:g} mm",
            "block.length": f"{length:g} mm",
            "block.thickness": f"{thickness:g} mm",
            "lattice.shape": [int(rows), int(columns)],
            "lattice.pitch": f"{min(width / columns, length / rows):.4g} mm",
            "limits.max_height": f"{HIGHEST * MICROMETRES * radius:.6g} um",
        },
    )


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


def new_part_dialog(page: Control) -> ui.dialog:
    """Return the dialog for a new part, which is one step of the history."""

    async def make() -> None:
        words.set_visibility(False)
        try:
            text = written(new_part({name: field.value for name, field in fields.items()}))
        except InvalidInput as error:
            words.text = str(error)
            words.set_visibility(True)
            return
        dialog.close()
        await page.alter(text=text, load=None)

    with ui.dialog().props('aria-labelledby="new-part"') as dialog, ui.card().classes("new-part"):
        ui.html("<h2 id='new-part'>New part</h2>", sanitize=False)
        ui.label(
            "The lattice fills the block. Numbers have the units beside them. Undo restores the part."
        ).classes("quiet small")
        fields = {
            name: ui.input(label, value=first)
            .props(f'dense outlined suffix="{unit}"')
            .on("keydown.enter", make)
            for name, (label, unit, first) in FIELDS.items()
        }
        words = ui.label().classes("warn").props('role="status"')
        words.set_visibility(False)
        with ui.element("div").classes("row"):
            ui.button("Make it", on_click=make).props("no-caps unelevated")
            ui.button("Cancel", on_click=dialog.close).props("no-caps flat")
    return dialog
