"""Entries of the challenge: heights, sites and tools, as JSON or CSV, and the limits that they must keep."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from validation.challenge.task import BadInput, Target, target

# Length [mm] by which an entry may break a limit, which is rounding of printed numbers.
SLACK = 1e-6


@dataclass(frozen=True)
class Entry:
    """A surface for a target: its asperities and what its authors state."""

    target: Target
    position: np.ndarray  # (n, 2) [mm]
    height: np.ndarray  # (n,) [mm]
    tool: np.ndarray  # (n,), numbers of tools from 0
    stated: dict[str, Any] = field(default_factory=dict)


def read(path: Path) -> Entry:
    """Return the entry of a JSON or CSV file, or raise BadInput."""
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror}") from None
    try:
        found = _table(path, text) if path.suffix == ".csv" else json.loads(text)
        return made(found)
    except (BadInput, ValueError) as error:
        raise BadInput(f"{path}: {error}") from None


def _table(path: Path, text: str) -> dict[str, Any]:
    """Return the columns x, y, height and, optionally, tool of a CSV file, whose name is the target."""
    rows = list(csv.DictReader(text.splitlines()))
    missing = {"x", "y", "height"} - set(rows[0] if rows else ())
    if missing:
        raise BadInput(f"the column {sorted(missing)[0]} is missing; the first line must be x,y,height,tool")
    found: dict[str, Any] = {"target": path.stem, "height": [row["height"] for row in rows]}
    found["position"] = [[row["x"], row["y"]] for row in rows]
    if "tool" in rows[0]:
        found["tool"] = [row["tool"] for row in rows]
    return found


def made(given: Any) -> Entry:
    """Return an entry from the values of its file."""
    if not isinstance(given, dict):
        raise BadInput(
            'the file must hold an object such as {"target": "01-power-law", "height": [...], ...}'
        )
    for key in ("target", "position", "height"):
        if key not in given:
            raise BadInput(f"{key} is missing")
    wanted = target(given["target"])
    height = _array("height", given["height"])
    if height.ndim != 1 or not height.size:
        raise BadInput("height must be a list of at least one number [mm]")
    n = len(height)
    position = _array("position", given["position"])
    if position.shape != (n, 2):
        raise BadInput(
            f"position must hold x and y [mm] of each of the {n} heights, but has the shape {position.shape}"
        )
    most = len(wanted.tools)
    if "tool" not in given and most > 1:
        raise BadInput(f"tool is missing: the number of the tool of each asperity, from 1 to {most}")
    tool = _array("tool", given.get("tool", [1] * n))
    if tool.shape != (n,):
        raise BadInput(f"tool has {tool.size} entries for {n} heights")
    wrong = np.flatnonzero((tool != tool.round()) | (tool < 1) | (tool > most))
    if wrong.size:
        i = wrong[0]
        raise BadInput(f"tool[{i}] = {tool[i]:g} must be a whole number from 1 to {most}")
    misfit = given.get("misfit")
    if misfit is not None and not isinstance(misfit, (int, float)):
        raise BadInput(f"misfit = {misfit!r} must be a number, such as 0.0123, or left out")
    stated = {key: value for key, value in given.items() if key not in ("position", "height", "tool")}
    return Entry(wanted, position, height, tool.astype(int) - 1, stated)


def _array(name: str, values: Any) -> np.ndarray:
    try:
        found = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise BadInput(f"{name} must hold numbers, the same number of them in each row") from None
    wrong = np.argwhere(~np.isfinite(found))
    if wrong.size:
        raise BadInput(f"{name}[{', '.join(map(str, wrong[0]))}] is not finite")
    return found


def broken(entry: Entry) -> list[str]:
    """Return the limits that an entry breaks, in words."""
    return [*_sites(entry), *_heights(entry), *_feet(entry)]


def _sites(entry: Entry) -> list[str]:
    """Return what is wrong with the positions."""
    wanted, n = entry.target, len(entry.height)
    found = []
    if n > wanted.count:
        found.append(f"{n} asperities; at most {wanted.count} are allowed")
    if wanted.cell is not None:
        outside = np.flatnonzero((np.abs(entry.position) > 0.5 * np.array(wanted.cell) + SLACK).any(axis=1))
        if outside.size:
            found.append(
                f"position[{outside[0]}] is outside the periodic cell, which is centred on the origin"
            )
        return found
    distance = np.hypot(*np.moveaxis(entry.position[:, None] - wanted.sites, -1, 0))
    site, off = distance.argmin(axis=1), distance.min(axis=1)
    if off.max() > SLACK:
        i = int(off.argmax())
        found.append(f"position[{i}] is {off[i]:.3g} mm from the nearest site of the lattice")
    _, first = np.unique(site, return_index=True)
    twice = sorted(set(range(n)) - set(first.tolist()))
    if twice:
        found.append(f"position[{twice[0]}] is on a site that another asperity occupies")
    return found


def _heights(entry: Entry) -> list[str]:
    """Return what is wrong with the heights."""
    limits, h = entry.target.limits, entry.height
    offset, lowest = limits.get("offset", 0.0), limits.get("min_height", 0.0)
    found = []
    low, high = offset + lowest, offset + limits["max_height"]
    if (h <= 0.0).any():
        found.append(f"height[{h.argmin()}] = {h.min():g} mm is not positive")
    elif h.min() < low - SLACK:
        found.append(f"height[{h.argmin()}] = {h.min():g} mm is below {low:g} mm")
    if h.max() > high + SLACK:
        found.append(f"height[{h.argmax()}] = {h.max():g} mm is above {high:g} mm")
    step = limits.get("height_step")
    if step:
        level = (h - low) / step - 0.5
        off = step * np.abs(level - level.round())
        if off.max() > SLACK:
            found.append(
                f"height[{off.argmax()}] is {off.max():.3g} mm from the nearest level; levels are the "
                f"middles of steps of {step:g} mm from {low:g} mm"
            )
    return found


def _feet(entry: Entry) -> list[str]:
    """Return what is wrong with the feet: caps that are no caps of their height, or that overlap."""
    pairs = zip(entry.tool, np.maximum(entry.height, 0.0).tolist(), strict=True)
    foot = np.array([entry.target.tools[tool].foot(height) for tool, height in pairs])
    if np.isinf(foot).any():
        return [f"height[{foot.argmax()}] is larger than the radius of its sphere"]
    apart = entry.position[:, None] - entry.position
    if entry.target.cell is not None:
        sides = np.array(entry.target.cell)
        apart = apart - sides * np.round(apart / sides)
        wide = np.flatnonzero(2.0 * foot > sides.min() + SLACK)
        if wide.size:
            return [f"the foot of asperity {wide[0]} overlaps itself in the next period"]
    distance = np.hypot(*np.moveaxis(apart, -1, 0))
    np.fill_diagonal(distance, np.inf)
    over = foot[:, None] + foot - distance
    if over.max() > SLACK:
        i, j = sorted(map(int, np.unravel_index(over.argmax(), over.shape)))
        return [f"the feet of the asperities {i} and {j} overlap by {over.max():.3g} mm"]
    return []
