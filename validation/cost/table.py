"""The table of the models in the guide's proof."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np

from validation.cost.points import CURVES, LOADS, machine, points, reference, scenes
from validation.numbers import rounded

# The claim, from the guide; name, line and setting in the chapter on cost, assumption and range of each.
CLAIM, MODELS = "../../validation/cost/work_precision.py", Path(__file__).with_name("models.toml")


def table() -> str:
    """Return the table of the models in Markdown: what each assumes, what it costs, how exact it is."""
    exact, title = reference(CURVES), scenes()[CURVES].title.partition(",")[0]
    listed = tomllib.loads(MODELS.read_text("utf-8"))["model"]
    lines = [
        f"| model | assumes | one load, {scenes()[CURVES].surface.count} asperities | each of {LOADS} loads "
        f"| error in A0(P), {title} | error in P(δ) | range |",
        "|---|---|---|---|---|---|---|",
    ]
    found = {(each.line, each.setting): each for each in points(CURVES)}
    for each in listed:
        point = found[each["line"], each["setting"]]
        times = in_words(point.cold), in_words(point.per_load) if math.isfinite(point.per_load) else "–"
        unsure = exact.area_uncertainty, exact.load_uncertainty
        errors = map(percent, (point.area_error, point.load_error), unsure)
        cells = (f"`{each['name']}`", each["assumes"], *times, *errors, each["range"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, "", f"Measured by [work_precision]({CLAIM}) on {machine()}."])


def percent(value: float, unsure: float) -> str:
    """Return a percentage to two digits, without an exponent; a bound if it is near its uncertainty."""
    digits, small = {"precision": 2, "unique": False, "fractional": False, "trim": "-"}, value < 2.0 * unsure
    shown = np.format_float_positional(100.0 * (value + unsure if small else value), **digits)
    return f"{'below ' * small}{shown} %"


def in_words(seconds: float) -> str:
    """Return a time rounded to 1, 2 or 5 with its unit."""
    micro = round(1e6 * rounded(seconds), 3)
    for scale, unit in ((1e6, "s"), (1e3, "ms")):
        if micro >= scale:
            return f"{micro / scale:.0f} {unit}"
    return f"{micro:g} µs"
