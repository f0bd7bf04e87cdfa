"""Handles of operating points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from metafem.files import Specification
from metafem.inversion import Design, OperatingPoints

KEYS = ("rescaled_load", "rescaled_friction")


@dataclass(frozen=True)
class Handle:
    """A point that can be dragged."""

    id: str
    load: float
    friction: float
    moves: Literal["xy", "x", "y"]
    label: str


def handles(text: str, specification: Specification, design: Design | None) -> tuple[Handle, ...]:
    """Return the handles of a specification."""
    target = specification.target
    if not isinstance(target, OperatingPoints) or KEYS[0] not in text:
        return ()
    pairs = zip(target.rescaled_load.tolist(), target.rescaled_friction.tolist(), strict=True)
    return tuple(Handle(f"point-{i}", x, y, "xy", f"point {i + 1}") for i, (x, y) in enumerate(pairs))


def moved(
    text: str, specification: Specification, design: Design | None, id: str, load: float, friction: float
) -> str:
    """Return the text with another place of a handle."""
    import tomlkit

    document = tomlkit.parse(text)
    for key, value in zip(KEYS, (load, friction), strict=True):
        document["target"][key][int(id.removeprefix("point-"))] = f"{value:.6g} mm^2"
    return document.as_string()
