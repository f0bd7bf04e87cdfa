"""What the head of the page says."""

from __future__ import annotations

import tomllib
from typing import Any

from metafem.explorer.answer import Answer
from metafem.inversion import DesignStatus
from metafem.inversion.assessment import misfit_text

# Words and kind of each status: "good", "warn" or neither.
STATUS = {
    DesignStatus.EXACT: ("meets the target", "good"),
    DesignStatus.REACHED: ("meets the target", "good"),
    DesignStatus.REFINED: ("meets the target", "good"),
    DesignStatus.APPROXIMATE: ("approximate", ""),
    DesignStatus.ROBUST: ("robust", ""),
    DesignStatus.UNCORRECTED: ("approximate", ""),
    DesignStatus.MISSED: ("misses the target", "warn"),
}


def header_data(answer: Answer) -> dict[str, Any]:
    """Return the target in words, the status with its kind, and the model of an answer."""
    status, kind = _status(answer)
    data = {"status": status, "kind": kind}
    model = _model(answer.state.text)
    if model is not None:
        data["model"] = model
    if answer.specification is not None:
        data["title"] = answer.specification.target.title
    return data


def _status(answer: Answer) -> tuple[str, str]:
    if answer.problems:
        count = len(answer.problems)
        return f"{count} problem{'s' if count > 1 else ''} in the specification", "warn"
    if answer.refusal or answer.design is None:
        return "refused: no surface reaches the target", "warn"
    words, kind = STATUS[answer.design.status]
    return f"{words}, misfit {misfit_text(answer.design.misfit)}", kind


def _model(text: str) -> str | None:
    """Return the model that a text names, also where it has other problems; None if it cannot be read."""
    try:
        section = tomllib.loads(text).get("model", {})
    except (ValueError, RecursionError):
        return None
    kind = section.get("kind", "independent") if isinstance(section, dict) else None
    return kind if isinstance(kind, str) else None
