"""The table of the models: what each assumes, what it costs, and how exact it is."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

from validation.cost.measured import LOADS, models
from validation.cost.times import in_words, percent
from validation.cost.work_precision import TABLE_SCENE
from validation.scenes.costs import SCENES, Reference, reference

# The models of the table: name, line and setting, assumption, range.
TABLE = [
    tuple(each.values())
    for each in tomllib.loads(Path(__file__).with_name("models.toml").read_text("utf-8"))["model"]
]


def table() -> str:
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
        percent(error) if error > uncertainty else f"below {percent(uncertainty)}"
        for error, uncertainty in zip(errors, (exact.area_uncertainty, exact.load_uncertainty), strict=True)
    )
    return area, load
