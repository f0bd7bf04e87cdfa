"""The law of an answer as data of its plot."""

from __future__ import annotations

from typing import Any

from metafem._validate import FloatArray
from metafem.explorer.answer import Answer


def law_data(answer: Answer) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units that are shown."""
    data: dict[str, Any] = {
        "number": answer.number,
        "x": {"label": "load P/E*", "unit": "mm²"},
        "y": {"label": "friction F/(σB)", "unit": "mm²"},
        "achieved": None,
        "wanted": None,
        "nearest": None,
        "refusal": answer.refusal,
        "handles": [],
    }
    if answer.design is not None:
        law = answer.design.law
        data["achieved"] = _line(law.rescaled_load, law.rescaled_friction)
    if answer.nearest is not None:
        data["nearest"] = _line(*answer.nearest)
    return data


def _line(x: FloatArray, y: FloatArray) -> dict[str, list[float]]:
    return {"x": x.tolist(), "y": y.tolist()}
