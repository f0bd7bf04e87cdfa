"""The targets of the challenge, read from their files.

A target file is a specification of metafem, `metafem spec`, from which the sections below are read. Those
marked * are of the challenge alone. Its first two comments are the title and how hard it is.

    [target]      kind = "power": exponent, load_range; any prefactor; misfit: rms relative difference
                  kind = "sampled": rescaled_load, rescaled_friction; misfit: rms relative difference
                  kind = "operating-points": the same keys; misfit: largest relative difference
    [stiffness] * rescaled_load, stiffness (k/E* [mm]); the misfit is the rms of both misfits
    [lattice]     shape, pitch, and radius if there are no tools
    [radii]       tools: the radii of which each asperity has one
    [[tools]] *   exponent, coefficient and radius of a cap, or sphere = true and its radius
    [cap], [contact]  caps other than spheres; "hertz" presses a cap by its paraboloid, "elastic" by its shape
    [limits]      max_height, min_height, offset, height_step
    [robust]      height_sd: the misfit is the root mean square over random errors of the heights
    [cell] *      width, length: the surface repeats; the summits may be anywhere, at most lattice.shape many
    [model]       kind: independent, half-space or layer; the last two are judged by resolved contacts
    [block]       thickness, of the layer
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from validation.challenge.caps import Tool
from validation.challenge.substrate import HalfSpace, Layer, PeriodicHalfSpace, Substrate

FOLDER = Path(__file__).parent / "targets"

UNITS = {"mm": 1.0, "um": 1e-3, "mm^2": 1.0, "um^2": 1e-6, "MPa": 1.0}

# Number of loads at which a power law is compared.
POINTS = 30


class BadInput(Exception):
    """An entry or a target file that cannot be read; the message names the key and the remedy."""


@dataclass(frozen=True)
class Law:
    """Values wanted at loads P/E* [mm^2]."""

    load: np.ndarray
    value: np.ndarray
    free: bool = False  # whether any multiple of the values is wanted
    pointwise: bool = False  # whether the misfit is the largest difference instead of the rms

    def difference(self, value: np.ndarray) -> np.ndarray:
        """Return the relative differences (..., k) of values (..., k) [-]."""
        ratio = value / self.value
        return ratio / (ratio.mean(axis=-1, keepdims=True) if self.free else 1.0) - 1.0

    def misfit(self, value: np.ndarray) -> np.ndarray:
        """Return the misfit (...) of values (..., k)."""
        difference = self.difference(value)
        return np.abs(difference).max(axis=-1) if self.pointwise else np.sqrt((difference**2).mean(axis=-1))


@dataclass(frozen=True)
class Target:
    """A target with the limits of its surfaces."""

    name: str
    title: str
    level: str
    friction: Law
    stiffness: Law | None
    tools: tuple[Tool, ...]
    shape: tuple[int, int]  # rows along y, columns along x
    pitch: float
    limits: dict[str, float]
    height_sd: float
    model: str
    substrate: Substrate
    cell: tuple[float, float] | None
    spec: dict[str, Any] = field(repr=False, compare=False, default_factory=dict)

    @property
    def count(self) -> int:
        """Largest number of asperities."""
        return self.shape[0] * self.shape[1]

    @property
    def sites(self) -> np.ndarray:
        """The sites of the lattice, centred on the origin, row by row along x, (n, 2) [mm]."""
        rows, columns = self.shape
        x = self.pitch * (np.arange(columns) - 0.5 * (columns - 1))
        y = self.pitch * (np.arange(rows) - 0.5 * (rows - 1))
        return np.column_stack([np.tile(x, rows), np.repeat(y, columns)])

    @property
    def resolved(self) -> bool:
        """Whether resolved contacts decide, because asperities act on each other."""
        return self.model != "independent"

    @property
    def for_metafem(self) -> bool:
        """Whether metafem reads the file as a specification."""
        return not {"stiffness", "tools", "cell"} & set(self.spec)

    def misfit(self, area: np.ndarray, stiffness: np.ndarray | None) -> np.ndarray:
        """Return the misfit (...) of areas and stiffnesses (..., k) at the loads of the laws."""
        found = self.friction.misfit(area)
        if self.stiffness is None or stiffness is None:
            return found
        return np.sqrt(0.5 * (found**2 + self.stiffness.misfit(stiffness) ** 2))


def names() -> list[str]:
    """Return the names of all targets in their order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def target(name: str) -> Target:
    """Return the target of a name."""
    if name not in names():
        raise BadInput(f'target = "{name}" is unknown; the targets are {", ".join(names())}')
    text = (FOLDER / f"{name}.toml").read_text("utf-8")
    title, level = (line.removeprefix("# ") for line in text.splitlines()[:2])
    spec = tomllib.loads(text)
    lattice, limits, cell = spec["lattice"], spec["limits"], spec.get("cell")
    model = spec.get("model", {}).get("kind", "independent")
    return Target(
        name=name,
        title=title,
        level=level,
        friction=_friction(spec["target"]),
        stiffness=_stiffness(spec),
        tools=_tools(spec),
        shape=tuple(lattice["shape"]),
        pitch=number(lattice["pitch"]),
        limits={key: number(value) for key, value in limits.items()},
        height_sd=number(spec.get("robust", {}).get("height_sd", 0.0)),
        model=model,
        substrate=_substrate(spec, model),
        cell=None if cell is None else (number(cell["width"]), number(cell["length"])),
        spec=spec,
    )


def number(value: Any) -> float:
    """Return a number in mm, mm^2 or MPa, from a number or a text such as "526 um"."""
    if isinstance(value, str):
        size, _, unit = value.partition(" ")
        return float(size) * UNITS[unit]
    return float(value)


def _numbers(values: list[Any]) -> np.ndarray:
    return np.array([number(value) for value in values])


def _friction(given: dict[str, Any]) -> Law:
    """Return the wanted friction F/(sigma B) [mm^2]."""
    if given["kind"] == "power":
        load = np.geomspace(*_numbers(given["load_range"]), POINTS)
        return Law(load, load ** given["exponent"], free=True)
    pointwise = given["kind"] == "operating-points"
    return Law(_numbers(given["rescaled_load"]), _numbers(given["rescaled_friction"]), pointwise=pointwise)


def _stiffness(spec: dict[str, Any]) -> Law | None:
    given = spec.get("stiffness")
    return None if given is None else Law(_numbers(given["rescaled_load"]), _numbers(given["stiffness"]))


def _tools(spec: dict[str, Any]) -> tuple[Tool, ...]:
    """Return the caps that an asperity can have."""
    if "tools" in spec:
        numbers = ({key: v if key == "sphere" else number(v) for key, v in t.items()} for t in spec["tools"])
        return tuple(Tool(**each) for each in numbers)
    radii = spec["radii"]["tools"] if "radii" in spec else [spec["lattice"]["radius"]]
    cap, contact = spec.get("cap", {"kind": "sphere"}), spec.get("contact", {"kind": "hertz"})
    if cap["kind"] == "power":
        return tuple(Tool(number(r), cap["exponent"], cap.get("coefficient", 0.5)) for r in radii)
    sphere = cap["kind"] == "sphere"
    elastic = contact["kind"] == "elastic"
    return tuple(Tool(number(r), sphere=sphere and elastic, round_foot=sphere) for r in radii)


def _substrate(spec: dict[str, Any], model: str) -> Substrate:
    if "cell" in spec:
        return PeriodicHalfSpace(number(spec["cell"]["width"]), number(spec["cell"]["length"]))
    if model == "layer":
        ratio = spec["material"].get("poisson_ratio", 0.5)
        return Layer(number(spec["block"]["thickness"]), ratio)
    return HalfSpace()
