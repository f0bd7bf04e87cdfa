"""The README's table of the models: what each assumes, what it costs, and how exact it is."""

from __future__ import annotations

import math
from pathlib import Path

from metafem.drawing import svg
from validation.cost.measured import LOADS, models
from validation.cost.times import in_words
from validation.cost.work_precision import TABLE_SCENE, one_panel
from validation.readme import renew
from validation.scenes.costs import AUTOMATIC, ORDER_3, RESOLVED, SCENES, Reference, reference
from validation.scenes.models import AREA_ERROR, CAP_ERROR

MARKS = ("<!-- models: python -m validation --readme -->", "<!-- end of the models -->")
PICTURE = Path(__file__).parents[1] / "work_precision.svg"

# The models of the table: name, line and setting, assumption, range.
TABLE = (
    (
        "Independent()", "Independent()", "",
        "each contact obeys Hertz, or the law of another cap; neighbours have no influence",
        "loads up to base contact; a/R up to about 0.5 with a fitted modulus",
    ),
    (
        "MeanField()", "MeanField()", "",
        "the mean pressure on a half-space sinks all asperities equally",
        "many asperities; A0(P) is that of `Independent()`, the separation is not",
    ),
    (
        "Interacting(order=1)", "Interacting(order=1)", "",
        "each contact acts on the others as a point load, on a half-space, a layer or the true block",
        "a/r up to about 0.15: the error grows as (a/r)³",
    ),
    (
        "Interacting()", ORDER_3, "",
        "as order 1, with the size of the contacts and the slope and curvature of their fields",
        f"A0 to {1e2 * AREA_ERROR:g} % up to a/r = 0.32 on a half-space, spheres and caps of power "
        f"3 or 4 to {1e2 * CAP_ERROR:g} %; to 0.2 % up to a/t = 0.3 on a layer; no overlap; timed up to 10⁴ "
        "asperities, order 1 to 10⁶",
    ),
    (
        "BoundaryElements(0.01)", RESOLVED, "10 µm",
        "nothing about single contacts; pressures on cells of 10 µm",
        "any contacts, also merged ones; at least four cells per radius of the largest contact",
    ),
    (
        "Automatic(1e-3)", AUTOMATIC, "0.001",
        "that of the first of independent asperities, orders 1 and 3 and resolved contacts whose estimated "
        "error of A0(P) is within the tolerance",
        "that of the chosen model; `state.notes` gives the reason",
    ),
)  # fmt: skip


def renew_readme() -> None:
    """Write the table and the picture of the README from what was measured in this run."""
    renew(MARKS, readme_table())
    PICTURE.write_text(svg(one_panel(TABLE_SCENE), "Seconds against error of the models"), "utf-8")


def readme_table() -> str:
    """Return the table in Markdown, with times rounded to 1, 2 or 5."""
    count = SCENES[TABLE_SCENE].surface.count
    lines = [
        f"| model | assumes | one load, {count} asperities | each of {LOADS} loads "
        "| error in A0(P), Fig. 4 red | error in P(δ) | range |",
        "|---|---|---|---|---|---|---|",
    ]
    found = {(each.line, each.setting): each for each in models(TABLE_SCENE)}
    for name, line, setting, assumption, span in TABLE:
        point = found[line, setting]
        per_load = in_words(point.per_load) if math.isfinite(point.per_load) else "–"
        area, load = shown_errors((point.area_error, point.load_error), reference(TABLE_SCENE))
        lines.append(
            f"| `{name}` | {assumption} | {in_words(point.cold)} | {per_load} | {area} | {load} | {span} |"
        )
    return "\n".join(lines)


def shown_errors(errors: tuple[float, float], exact: Reference) -> tuple[str, str]:
    """Return the errors of A0 and P to two digits, or the reference's uncertainty if they are smaller."""
    area, load = (
        _percent(error) if error > uncertainty else f"below {_percent(uncertainty)}"
        for error, uncertainty in zip(errors, (exact.area_uncertainty, exact.load_uncertainty), strict=True)
    )
    return area, load


def _percent(value: float) -> str:
    """Return a percentage to two digits, without an exponent."""
    return f"{float(f'{100.0 * value:.2g}'):g} %"
