"""The report of one design: one HTML text that opens offline."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import astuple
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._values import MICROMETRES, percent, three_digits
from metafem.drawing.inline import drawn
from metafem.errors import MetafemError
from metafem.inversion import Design, PowerRange, RadiusRange, Tool
from metafem.inversion.result import empty_sites_words
from metafem.prediction.validity import base_contact_load
from metafem.progress import doing
from metafem.report.comparison import MOST_COMPARED, Comparison, compared
from metafem.report.figures import comparison_figure, force_figure, law_figure, sensitivity_figure
from metafem.report.fits import fit_table
from metafem.report.html import render
from metafem.report.names import all_notes, error_words, in_python, misfit_words, model_words
from metafem.report.sections.exactness import exactness_section
from metafem.report.sections.measured import measured_section
from metafem.report.sections.sliding import sliding_section
from metafem.report.views import MOST_SHAPED, contact_figure, height_figure
from metafem.studies.summary import summary

if TYPE_CHECKING:
    from xarray import Dataset

Row = tuple[str, str, str]

NO_STUDIES: Mapping[str, Dataset] = MappingProxyType({})

# Largest number of different radii that are listed; of more radii, only the range is stated.
MOST_NAMED = 5

# Largest number of summits in the table; heights.csv lists all.
MOST_LISTED = 200

# Significant digits of a parameter, and of a misfit.
DIGITS, MISFIT_DIGITS = 6, 3

# Areas below this fraction of the largest area are printed as 0; so are heights below this fraction of the
# largest height, and percentages below this fraction of 100 %.
ZERO = 1e-9

# Largest number of printed values of one parameter.
MOST_PRINTED = 24

# Labels, printed units, and factors to these units of the parameters that inversions report.
PARAMETERS = {
    "scale": ("scale λ of the height density", "µm", MICROMETRES),
    "weight": ("weight u of the upper branch", "", 1.0),
    "crossover_height": ("crossover height above the base", "µm", MICROMETRES),
    "intercept": ("intercept α of the asymptote", "mm²", 1.0),
    "foot_load": ("rescaled load at which the plane reaches the lowest asperity", "mm²", 1.0),
    "counts": ("numbers of asperities", "", 1.0),
    "levels": ("levels above the base", "µm", MICROMETRES),
    "prefactor": ("prefactor C of the power law", "mm^(2-2β)", 1.0),
    "intercepts": ("intercepts of the branches", "mm²", 1.0),
    "adjustment_heights": ("adjustment heights above the base", "µm", MICROMETRES),
    "adjustment_counts": ("numbers of adjustment asperities", "", 1.0),
    "load_range": ("rescaled loads over which friction is proportional to load", "mm²", 1.0),
    "span": ("depth of the lowest summit below the tallest", "µm", MICROMETRES),
    "tried_radii": ("radii tried", "µm", MICROMETRES),
    "lowest_coefficients": ("lowest friction coefficients of linear laws with them", "", 1.0),
    "highest_coefficients": ("highest friction coefficients of linear laws with them", "", 1.0),
    "used_radii": ("radii in use", "µm", MICROMETRES),
    "radius_counts": ("numbers of asperities with them", "", 1.0),
    "tool_counts": ("numbers of asperities of each tool", "", 1.0),
    "used_exponents": ("exponents of the caps in use", "", 1.0),
    "exponent_counts": ("numbers of asperities with them", "", 1.0),
    "lowest_radius": ("smallest radius in use", "µm", MICROMETRES),
    "highest_radius": ("largest radius in use", "µm", MICROMETRES),
    "level_radii": ("radii of the levels", "µm", MICROMETRES),
    "adjustment_radii": ("radii of the adjustment asperities", "µm", MICROMETRES),
    "reachable_coefficients": ("achievable friction coefficients of linear laws: from, to", "", 1.0),
    "tilt_before": ("rms change of A0 by the tilt, heights at random sites", "%", 100.0),
    "tilt_after": ("the same after exchanges of heights", "%", 100.0),
    "step_levels": ("levels after quantisation, above the base", "µm", MICROMETRES),
    "step_counts": ("numbers of asperities on these levels", "", 1.0),
    "step_loss": ("change of the misfit by quantisation", "%", 100.0),
}


@doing("drawing the report")
def page(
    design: Design,
    hardness: float | None = None,
    *,
    studies: Mapping[str, Dataset] = NO_STUDIES,
) -> str:
    """Return the report of a design as one self-contained HTML text.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        Hardness H of the softer material [MPa]; default: None, without the plasticity index.
    studies : mapping of str to xarray.Dataset
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
    comparisons, left_out = compared(design)
    fit_columns, fits = fit_table(design)
    notes, achieved = all_notes(design, hardness), design.status.name != "MISSED"
    return render(
        "page.html",
        design=design,
        achieved=achieved,
        tiles=_tiles(design),
        notes=notes,
        warned=not achieved or any(note.warns for note in notes),
        excerpt=design.surface.count > MOST_SHAPED,
        hardness=hardness,
        law=drawn(law_figure(design), "Target and achieved friction law"),
        forces=None
        if (friction := design.surface.friction) is None
        else drawn(force_figure(design, friction), "Friction force and friction coefficient"),
        heights=drawn(height_figure(design), "Summit heights at their sites"),
        sensitivities=drawn(sensitivity_figure(design), "Sensitivity of A0 to each height")
        if design.surface.count <= MOST_COMPARED
        else None,
        contacts=drawn(contact_figure(design), "Real contacts at three loads"),
        sliding=sliding_section(design),
        measured=measured_section(design, studies),
        comparison=drawn(comparison_figure(comparisons), "Change by elastic interaction")
        if comparisons
        else None,
        comparisons=_comparisons(comparisons),
        left_out=left_out,
        exactness=exactness_section(studies),
        explanation=summary(studies["explained"]) if "explained" in studies else None,
        parameters=parameter_rows(design),
        fit_columns=fit_columns,
        fits=fits,
        inputs=_inputs(design),
        summits=_summits(design),
        residual=f"{design.law.residual.max():.1e}",
        model=model_words(design.law.model),
        model_error=error_words(design.law.model_error),
        python=in_python(design.law.model),
    )


def _tiles(design: Design) -> list[tuple[str, str]]:
    heights = design.surface.height * MICROMETRES
    return [
        misfit_words(design),
        (
            "sites with an asperity",
            f"{design.surface.count} of {design.template.count}{empty_sites_words(design)}",
        ),
        ("heights", f"{heights.min():.1f} – {heights.max():.1f} µm"),
        ("largest load shown", f"{three_digits(design.law.load[-1])} N"),
    ]


def parameter_rows(design: Design) -> list[Row]:
    """Return the labels, values and units of the parameters that the inversion determined."""
    rows = []
    heights = MICROMETRES * float(np.abs(design.surface.height).max())
    scales = {"%": 100.0, "mm²": float(design.law.rescaled_friction[-1]), "µm": heights}
    for name, value in design.parameters.items():
        words, unit, factor = PARAMETERS[name]
        numbers = np.atleast_1d(np.asarray(value) * (int(factor) if factor == 1.0 else factor))
        zero = ZERO * scales.get(unit, 0.0)
        digits = MISFIT_DIGITS if unit == "%" else DIGITS
        text = ", ".join(
            f"{0.0 if abs(number) < zero else number:.{digits}g}"
            for number in numbers[:MOST_PRINTED].tolist()
        )
        more = len(numbers) - MOST_PRINTED
        rows.append((words, f"{text}, and {more} more in design.json" if more > 0 else text, unit))
    return rows


def _summits(design: Design) -> dict[str, Any]:
    """Return the table of the summits, or of the first 200 summits if there are more."""
    surface = design.surface
    differ = bool(np.ptp(surface.radius) > 0.0)
    columns = ("site", "x [mm]", "y [mm]", "height [µm]", "radius [µm]")[: 4 + differ]
    rows = [
        (
            str(design.sites[i]),
            *(f"{coordinate:.4f}" for coordinate in surface.position[i]),
            f"{surface.height[i] * MICROMETRES:.2f}",
            f"{surface.radius[i] * MICROMETRES:.6g}",
        )[: len(columns)]
        for i in range(min(surface.count, MOST_LISTED))
    ]
    return {"columns": columns, "rows": rows, "count": surface.count}


def _comparisons(comparisons: tuple[Comparison, ...]) -> list[tuple[str, ...]]:
    return [
        (
            comparison.name,
            percent(math.sqrt(float((comparison.difference**2).mean())), ".2f"),
            percent(comparison.difference[np.abs(comparison.difference).argmax()], "+.2f"),
            f"{MICROMETRES * comparison.sinking[-1]:.1f} µm",
        )
        for comparison in comparisons
    ]


def _tool_words(tool: Tool) -> str:
    return f"{tool.cap!r} of R = {MICROMETRES * tool.radius:.6g} µm"


def _inputs(design: Design) -> list[Row]:
    surface, limits, radii = design.template, design.limits, np.unique(design.surface.radius) * MICROMETRES
    rows = [
        ("composite modulus E*", f"{surface.material.composite_modulus:g}", "MPa"),
        ("Poisson's ratio ν", f"{surface.material.poisson_ratio:g}", ""),
    ]
    if surface.friction is not None:
        rows.append(("shear strength σ", f"{surface.friction.shear_strength:g}", "MPa"))
        rows.append(("area ratio B", f"{surface.friction.area_ratio:g}", ""))
    few = ", ".join(f"{radius:.6g}" for radius in radii[:MOST_NAMED])
    words = few if len(radii) <= MOST_NAMED else f"{radii[0]:.4g} – {radii[-1]:.4g}"
    rows.append(("summit radius R", words, "µm"))
    if isinstance(design.tools, RadiusRange):
        low, high, step = (MICROMETRES * value for value in astuple(design.tools))
        rows.append(("radii to choose from", f"{low:g} – {high:g} in steps of {step:g}", "µm"))
    if isinstance(design.tools, PowerRange):
        low, high, step, _, coefficient = astuple(design.tools)
        words = f"{low:g} – {high:g} in steps of {step:g}, coefficient {coefficient:g}"
        rows.append(("exponents of power caps to choose from", words, ""))
    if isinstance(design.tools, tuple) and isinstance(design.tools[0], Tool):
        tools = (tool for tool in design.tools if isinstance(tool, Tool))
        words = "; ".join(map(_tool_words, tools))
        rows.append(("tools to choose from", words, ""))
    rows.append(("sites for asperities", f"{surface.count}", ""))
    if surface.block is not None:
        block = surface.block
        rows.append(("block", f"{block.width:g} × {block.length:g} × {block.thickness:g}", "mm"))
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
    words = "load at which the plane reaches the base plane"
    try:
        onset = surface.material.composite_modulus * base_contact_load(design.surface, design.law.model)
        rows.append((words, f"{onset:.4g}", "N"))
    except MetafemError as reason:
        rows.append((words, f"unknown: {reason}", ""))
    return rows
