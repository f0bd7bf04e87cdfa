"""Kinds of target laws: what a page calls them, and where each begins, near the law that is shown."""

from __future__ import annotations

from collections.abc import Mapping

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.law.shown import Units
from metafem.explorer.text.document import Document
from metafem.explorer.text.kinds import with_target_kind

KINDS: Mapping[str, str] = {
    "operating-points": "operating points",
    "linear": "straight line (linear)",
    "bilinear": "two branches (bilinear)",
    "power": "power law",
    "multilinear": "several branches (multilinear)",
    "sampled": "curve (sampled)",
}

# Digits of points.
DIGITS = 4


def kind_of(text: str) -> str:
    """Return the kind of the target of a specification's text, "" where it has none."""
    try:
        return str(Document(text).value("target.kind") or "")
    except InvalidInput:
        return ""


def with_kind(answer: Answer, kind: str) -> str:
    """Return the text of an answer with a target of another kind, near the law that is shown.

    Raises
    ------
    InvalidInput
        For an unknown kind, and where the text is no valid TOML.
    """
    text, newtons = answer.state.text, answer.state.newtons
    return with_target_kind(text, answer.specification, answer.design, kind, newtons)


def points(
    load: FloatArray, friction: FloatArray, units: Units, digits: int = DIGITS
) -> dict[str, list[str]]:
    """Return the keys of points, rescaled or in newtons."""
    keys = ("load", "friction_force") if units.newtons else ("rescaled_load", "rescaled_friction")
    unit = "N" if units.newtons else "mm^2"
    values = (units.load * load, units.friction * friction)
    return {
        key: [f"{value:.{digits}g} {unit}" for value in each] for key, each in zip(keys, values, strict=True)
    }
