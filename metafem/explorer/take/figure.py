"""A figure of the law and the surface for a paper, with its caption and its data."""

from __future__ import annotations

import math
from contextlib import suppress

from metafem import drawing
from metafem._values import percent
from metafem.drawing.paper import saved, scaled_axes, two_parts
from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.answer import Answer
from metafem.explorer.law.shown import Units
from metafem.explorer.take.files import tables_of
from metafem.explorer.text.fields import with_unit
from metafem.files import quantity
from metafem.inversion import Design
from metafem.report import misfit_words
from metafem.report.names import model_words

# Smallest and largest width and height [mm]; the larger of both is at least `LARGER`, which leaves room for
# the numbers and names of all axes. Size of a figure over two columns of a journal, and formats.
SMALLEST, LARGEST, LARGER = 40.0, 400.0, 80.0
WIDTH, HEIGHT, FORMATS = "170", "75", ("svg", "pdf")


def figure_files(answer: Answer, kind: str, width: str, height: str) -> dict[str, bytes]:
    """Return the files of a figure by name: the figure, its caption, and the data of law and heights.

    `kind` is the format, one of `FORMATS`; width and height are the texts of numbers in mm. The axes have the
    units of the page.

    Raises
    ------
    InvalidInput
        If the width or height is no number, too small or too large.
    """
    size, design = (_millimetres("width", width), _millimetres("height", height)), answer.design
    must = f"must be at least {LARGER:g} mm for a height of {size[1]:g} mm"
    refuse_if(max(size) < LARGER, must, key="width", value=width)
    assert design is not None
    figure, law, plan, scale = two_parts(*size)
    design.plot(law)
    surface = design.surface
    drawing.summits(plan, surface.position, surface.height, surface.radius, scale)
    drawing.plan(plan)
    units = Units.of_design(answer, answer.state.newtons)
    x, y = (f"{axis['label']} [{axis['unit']}]" for axis in units.axes().values())
    if units.newtons:
        scaled_axes(law, (units.load, x), (units.friction, y))
    else:
        law.set(xlabel=x, ylabel=y)
    tables = tables_of(answer)
    return {
        f"figure.{kind}": saved(figure, design.target.title, kind),
        "caption.txt": caption(design).encode("utf-8"),
        **{name: tables[name] for name in ("law.csv", "heights.csv")},
    }


def caption(design: Design) -> str:
    """Return the caption of the figure, with all parameters of the design."""
    surface, law, (name, misfit) = design.surface, design.law, misfit_words(design)
    error = float(law.model_error)
    return "\n".join(
        (
            f"{design.target.title}. (a) Law of the designed surface and target; (b) heights of its summits.",
            f"Target: {design.target!r}.",
            f"{str(surface).strip('<>')}; the template has {design.template.count} sites.",
            f"Largest height: {surface.height.max():.4g} mm, of at most {design.limits.max_height:g} mm.",
            f"Model: {model_words(law.model)}.",
            f"Largest load: {law.load[-1]:.4g} N.",
            f"{name[:1].upper()}{name[1:]}: {misfit}.",
            f"Error by interaction and model, estimated by {law.model_error.source}: "
            f"{'unknown' if math.isnan(error) else percent(error)}.",
            "",
        )
    )


def _millimetres(name: str, given: str) -> float:
    """Return a length [mm] from its text; a number without a unit is in mm."""
    value = math.nan
    with suppress(InvalidInput):
        value = quantity(name, with_unit(given, "mm"), "mm")
    must = f"must be a number of millimetres from {SMALLEST:g} to {LARGEST:g}"
    refuse_if(not SMALLEST <= value <= LARGEST, must, key=name, value=given, example="85")
    return value
