"""The report of one design: one HTML text that opens offline."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._values import MICROMETRES, three_digits
from metafem.drawing.inline import drawn
from metafem.errors import MetafemError
from metafem.inversion import Design
from metafem.inversion.result import empty_sites_words
from metafem.prediction import onset
from metafem.prediction.validity import BASE, base_contact_load
from metafem.progress import doing
from metafem.report import figures, words
from metafem.report.html import render
from metafem.report.interaction import MOST_COMPARED, compared, interaction_figure, interaction_rows
from metafem.report.studies import study_sections
from metafem.report.words import Row

if TYPE_CHECKING:
    from xarray import Dataset

# Largest number of summits in the table; heights.csv lists all.
MOST_LISTED = 200


@doing("drawing the report")
def page(
    design: Design,
    hardness: float | None = None,
    *,
    studies: Mapping[str, Dataset] | None = None,
) -> str:
    """Return the report of a design as one self-contained HTML text.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        Hardness H of the softer material [MPa]; default: None, without the plasticity index.
    studies : mapping of str to xarray.Dataset, optional
        Studies of this design by name; the report shows their answers and figures. Default: none.

    Returns
    -------
    str

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> text = page(mf.design(mf.LinearLaw(6.87), template))
    >>> text[:15], "http" in text.replace("http://www.w3.org", "")
    ('<!doctype html>', False)
    """
    surface, friction = design.surface, design.surface.friction
    laws, left_out = compared(design)
    parts: dict[str, Any] = {
        "law": drawn(figures.law_figure(design), "Target and achieved friction law"),
        "heights": drawn(figures.height_figure(design), "Summit heights at their sites"),
        "contacts": drawn(figures.contact_figure(design), "Real contacts at three loads"),
        **study_sections(design, studies or {}),
    }
    if friction is not None:
        sliding = onset(surface, design.law.model, load=float(design.law.load[-1]))
        parts["coefficient"] = drawn(figures.coefficient_figure(design, friction), "Friction coefficient")
        parts["sliding"] = drawn(figures.onset_figure(sliding), "Onset of sliding")
        parts["sliding_words"] = words.onset_words(sliding)
    if surface.count <= MOST_COMPARED:
        parts["sensitivities"] = drawn(figures.sensitivity_figure(design), "Sensitivity of A0 to each height")
    if laws:
        parts["interaction"] = drawn(interaction_figure(laws), "Change by elastic interaction")
        parts["interactions"] = interaction_rows(laws)
    return render(
        "page.html",
        design=design,
        tiles=_tiles(design),
        notes=words.all_notes(design, hardness),
        hardness=hardness,
        left_out=left_out,
        fits=words.fit_table(design),
        parameters=words.parameter_rows(design),
        inputs=_inputs(design),
        summits=_summits(design),
        model_error=words.error_words(design.law.model_error),
        **parts,
    )


def _tiles(design: Design) -> list[tuple[str, str]]:
    heights = design.surface.height * MICROMETRES
    return [
        words.misfit_words(design),
        (
            "sites with an asperity",
            f"{design.surface.count} of {design.template.count}{empty_sites_words(design)}",
        ),
        ("heights", f"{heights.min():.1f} – {heights.max():.1f} µm"),
        ("largest load shown", f"{three_digits(design.law.load[-1])} N"),
    ]


def _summits(design: Design) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return headings and rows of the summits, or of the first 200 summits if there are more."""
    surface = design.surface
    columns = ("site", "x [mm]", "y [mm]", "height [µm]", "radius [µm]")
    rows = [
        (
            str(design.sites[i]),
            *(f"{coordinate:.4f}" for coordinate in surface.position[i]),
            f"{surface.height[i] * MICROMETRES:.2f}",
            f"{surface.radius[i] * MICROMETRES:.6g}",
        )
        for i in range(min(surface.count, MOST_LISTED))
    ]
    return columns, rows


def _inputs(design: Design) -> list[Row]:
    """Return the names, values and units of what was given, and the load at which the base is touched."""
    given, limits = design.template, design.limits
    ends = np.unique([radius(design.surface.radius) for radius in (np.min, np.max)])
    rows = [
        ("composite modulus E*", f"{given.material.composite_modulus:g}", "MPa"),
        ("Poisson's ratio ν", f"{given.material.poisson_ratio:g}", ""),
        ("summit radius R", " – ".join(f"{MICROMETRES * end:.6g}" for end in ends), "µm"),
        ("sites for asperities", f"{given.count}", ""),
    ]
    if given.friction is not None:
        rows.append(("shear strength σ", f"{given.friction.shear_strength:g}", "MPa"))
        rows.append(("area ratio B", f"{given.friction.area_ratio:g}", ""))
    if given.block is not None:
        sides = (given.block.width, given.block.length, given.block.thickness)
        rows.append(("block", " × ".join(f"{side:g}" for side in sides), "mm"))
    if design.tools is not None:
        rows.append(("tools to choose from, lengths in mm", repr(design.tools), ""))
    lengths = {
        "largest height h_m": limits.max_height,
        "offset h_0": limits.offset,
        "height step": limits.height_step,
        "height error": limits.height_sd,
        **{f"given height of site {site}": height for site, height in design.pinned.items()},
    }
    rows += [(name, f"{value * MICROMETRES:g}", "µm") for name, value in lengths.items() if value is not None]
    empty = [str(site) for site, height in design.pinned.items() if height is None]
    if empty:
        rows.append(("sites that stay empty by the specification", ", ".join(empty), ""))
    try:
        load = given.material.composite_modulus * base_contact_load(design.surface, design.law.model)
        rows.append((BASE, f"{load:.4g}", "N"))
    except MetafemError as reason:
        rows.append((BASE, f"unknown: {reason}", ""))
    return rows
