"""The report of one design: one HTML text that opens offline."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._values import MICROMETRES, percent, three_digits
from metafem.drawing.inline import drawn
from metafem.errors import MetafemError
from metafem.inversion import Design
from metafem.inversion.result import empty_sites_words
from metafem.models.error import without_jumps
from metafem.prediction import Onset, onset
from metafem.prediction.tolerances import scatter
from metafem.prediction.validity import BASE, base_contact_load
from metafem.progress import doing
from metafem.report import figures, words
from metafem.report.html import render
from metafem.report.studies import study_sections
from metafem.report.words import Row
from metafem.studies.models import compared
from metafem.studies.summary import summary

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.studies import Summary

# Largest number of asperities for which coupled laws are computed; they take a second or two.
MOST_COMPARED = 1500

# Largest number of loads of a target at which the scatter is computed: 256 surfaces of 64 adhesive asperities
# take a quarter of a second.
SCATTERED_LOADS = 30

# Standard deviation of the heights if the specification states none [mm]: the precision of the moulds of the
# source paper, doi:10.1126/science.adk4234.
HEIGHT_SD = 0.0009


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
    surface, friction, studies = design.surface, design.surface.friction, studies or {}
    parts: dict[str, Any] = {
        "law": drawn(figures.law_figure(design), "Target and achieved friction law"),
        "heights": drawn(figures.height_figure(design), "Summit heights at their sites"),
        "contacts": drawn(figures.contact_figure(design), "Real contacts at three loads"),
        **study_sections(design, studies),
    }
    sliding = None
    if friction is not None:
        sliding = onset(surface, design.law.model, load=float(design.law.load[-1]))
        parts["coefficient"] = drawn(figures.coefficient_figure(design, friction), "Friction coefficient")
        parts["sliding"] = drawn(figures.onset_figure(sliding), "Onset of sliding")
    if surface.count <= MOST_COMPARED or "fidelity" in studies:
        models = studies.get("fidelity")
        models = compared(design, wait=False) if models is None else models
        parts["interaction"] = drawn(figures.interaction_figure(models), "Change by elastic interaction")
        parts["models"] = summary(models)
    return render(
        "page.html",
        design=design,
        numbers=numbers(design),
        notes=words.all_notes(design, hardness),
        fits=words.fit_table(design),
        parameters=words.parameter_rows(design),
        inputs=_inputs(design),
        base=BASE,
        model_error=words.error_words(design.law.model_error),
        gists=_gists(design, sliding, parts.get("models")),
        **parts,
    )


def write(design: Design, path: Path | str, **options: Any) -> None:
    """Write the report of a design, the text that `page` returns with these options, into a file."""
    Path(path).write_text(page(design, **options), "utf-8")


def numbers(design: Design) -> list[tuple[str, str]]:
    """Return the three numbers by which a design is judged, each with what it means."""
    misfit, value = words.misfit_words(design)
    error, source = words.error_parts(design.law.model_error)
    scattered, errors = _scatter(design)
    return [
        (value, misfit),
        (error, f"error of the model: estimated error of A0(P), {source}"),
        (scattered, f"scatter when made: {errors}"),
    ]


def _scatter(design: Design) -> tuple[str, str]:
    """Return the relative change of A0 by errors of the heights, and its meaning."""
    target, sd = design.target_law, design.limits.height_sd
    assumed = ", the precision of the source paper's moulds" if sd is None else ""
    sd = HEIGHT_SD if sd is None else sd
    target, model = target.thinned(SCATTERED_LOADS), design.law.model
    try:
        mean, deviation = scatter(design.surface, model, target.load, sd)
    except MetafemError as reason:
        return "unknown", f"because {reason}"
    change = np.hypot(mean - 1.0, deviation)
    value, of = (change.max(), ", largest") if target.pointwise else (np.sqrt((change**2).mean()), "")
    bare = " without adhesion" if without_jumps(design.surface, model) != model else ""
    return percent(value), (
        f"rms change of A0{of} over the loads of the target, by errors of the heights of "
        f"{MICROMETRES * sd:.3g} µm (SD){assumed}; drawn with independent asperities{bare}"
    )


def _gists(design: Design, sliding: Onset | None, models: Summary | None) -> dict[str, str]:
    """Return what the folded parts of the page hold, in a line each."""
    surface, law, heights = design.surface, design.law, MICROMETRES * design.surface.height
    columns, rows = words.fit_table(design)
    friction = [f"{columns[1].capitalize()} {row[1]}, fitted {row[2]}" for row in rows]
    if sliding is not None:
        friction.append(f"μ = {law.friction_coefficient[-1]:.3g} at {three_digits(law.load[-1])} N")
        friction.append(words.onset_words(sliding))
    sites = f"{surface.count} of {design.template.count} sites{empty_sites_words(design)}"
    changes = [f"{row[0]} {row[1]} % rms" for row in models.rows[1:]] if models else []
    return {
        "friction": ". ".join([*friction, ""]),
        "heights": f"{heights.min():.1f} – {heights.max():.1f} µm on {sites}.",
        "interaction": f"Change of A0: {', '.join(changes)}." if changes else "",
    }


def _inputs(design: Design) -> list[Row]:
    """Return the names, values and units of what was given, and the load at which the base is touched."""
    given, limits, block, friction = (
        design.template, design.limits, design.template.block, design.template.friction,
    )  # fmt: skip
    radius = design.surface.radius
    ends = np.unique([radius.min(), radius.max()])
    empty = [str(site + 1) for site, height in design.pinned.items() if height is None]
    modulus = given.material.composite_modulus
    try:
        base, unit = f"{modulus * base_contact_load(design.surface, design.law.model):.4g}", "N"
    except MetafemError as reason:
        base, unit = f"unknown: {reason}", ""
    lengths = {
        "largest height h_m": limits.max_height,
        "offset h_0": limits.offset,
        "height step": limits.height_step,
        "height error": limits.height_sd,
        **{f"given height of site {site + 1}": height for site, height in design.pinned.items()},
    }
    rows = [
        ("composite modulus E*", modulus, "MPa"),
        ("Poisson's ratio ν", given.material.poisson_ratio, ""),
        ("summit radius R", " – ".join(f"{MICROMETRES * end:.6g}" for end in ends), "µm"),
        ("sites for asperities", str(given.count), ""),
        ("shear strength σ", friction and friction.shear_strength, "MPa"),
        ("area ratio B", friction and friction.area_ratio, ""),
        ("block", block and f"{block.width:g} × {block.length:g} × {block.thickness:g}", "mm"),
        ("tools to choose from, lengths in mm", design.tools and repr(design.tools), ""),
        *((name, length and MICROMETRES * length, "µm") for name, length in lengths.items()),
        ("sites that stay empty by the specification", ", ".join(empty) or None, ""),
        (BASE, base, unit),
    ]
    return [
        (name, value if isinstance(value, str) else f"{value:g}", unit)
        for name, value, unit in rows
        if value is not None
    ]
