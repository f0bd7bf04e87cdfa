"""The best results known, `best/NN-name.json`: designs of metafem, and their scores."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import metafem as mf
from validation.challenge.entry import Entry, read
from validation.challenge.score import Score, score, sums_misfit
from validation.challenge.search import refined, searched, stepped
from validation.challenge.task import FOLDER, Target

BEST = Path(__file__).parent / "best"
MACHINE = "two cores of a laptop-class processor"

# Digits of heights [mm] that are written: a tenth of a nanometre.
DIGITS = 10


def path_of(name: str) -> Path:
    """Return the file of the best result of a target."""
    return BEST / f"{name}.json"


def best(name: str) -> Entry:
    """Return the best result of a target."""
    return read(path_of(name))


def renewed(wanted: Target) -> tuple[Entry, Score]:
    """Design a surface for a target, score it, and write it with its misfit and time."""
    begin = time.perf_counter()
    found, method = _found(wanted)
    seconds = time.perf_counter() - begin
    found = replace(found, height=found.height.round(DIGITS), position=found.position.round(DIGITS))
    result = score(found)
    stated = {
        "target": wanted.name,
        "by": "metafem",
        "method": method,
        "misfit": float(f"{result.misfit:.6g}"),
        "seconds": float(f"{seconds:.2g}"),
        "machine": MACHINE,
        "position": found.position.tolist(),
        "height": found.height.tolist(),
        "tool": (found.tool + 1).tolist(),
    }
    rows = ",\n".join(f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in stated.items())
    path_of(wanted.name).write_text(f"{{\n{rows}\n}}\n", "utf-8")
    return found, result


def _found(wanted: Target) -> tuple[Entry, str]:
    """Return the best surface, and how it was found."""
    if not wanted.for_metafem or wanted.level == "impossible":  # metafem refuses what is impossible
        return searched(wanted)
    found = _designed(wanted)
    if "height_step" in wanted.limits:
        return stepped(found)
    if wanted.resolved or wanted.height_sd:
        return found, "metafem design"
    again = refined(found)[1]
    return min((found, again), key=sums_misfit), "metafem design, then least squares"


def _designed(wanted: Target) -> Entry:
    """Return the design of a specification."""
    surface = mf.read_spec(FOLDER / f"{wanted.name}.toml").design().surface
    radius = np.array([tool.radius for tool in wanted.tools])
    tool = np.abs(surface.radius[:, None] - radius).argmin(axis=1)
    return Entry(wanted, surface.position, surface.height, tool)
