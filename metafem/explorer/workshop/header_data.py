"""Data for the header of the page."""

from __future__ import annotations

from typing import Any

from metafem._values import percent
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.text.document import Document
from metafem.inversion import Design, DesignStatus
from metafem.inversion.assessment import misfit_text

# Words for each status, and its kind: "good", "warn" or "" for neither.
STATUS = {
    DesignStatus.EXACT: ("meets the target exactly", "good"),
    DesignStatus.REACHED: ("meets the target", "good"),
    DesignStatus.WITHIN_ERRORS: ("meets the target", "good"),
    DesignStatus.REFINED: ("meets the target", "good"),
    DesignStatus.APPROXIMATE: ("approximate", ""),
    DesignStatus.ROBUST: ("least expected misfit", ""),
    DesignStatus.UNCORRECTED: ("approximate", ""),
    DesignStatus.MISSED: ("misses the target", "warn"),
}

STOPPED = "stopped: change something, or compute again"


def header_data(answer: Answer) -> dict[str, Any]:
    """Return the target in words, the status with its kind and meaning, and the model of an answer."""
    status, kind = _status(answer)
    data = {"status": status, "kind": kind, "meaning": answer.refused, "stopped": answer.stopped}
    if answer.current and answer.design is not None:
        data["meaning"] = _meaning(answer.design)
    model = _model(answer.state.text)
    if model is not None:
        data |= {"model": model, "solved": model}
    if answer.specification is not None:
        data["title"] = answer.specification.target.title
    return data


def _status(answer: Answer) -> tuple[str, str]:
    if answer.stopped:
        return STOPPED, ""
    if answer.failed:
        return "no design: the computation failed", "warn"
    if answer.problems:
        count = len(answer.problems)
        return f"{count} problem{'s' if count > 1 else ''} in the specification", "warn"
    if answer.refusal or answer.design is None:
        return "refused: no surface reaches the target", "warn"
    words, kind = STATUS[answer.design.status]
    if answer.simplified:
        words, kind = f"draft under {answer.design.law.model.name}", ""
    if answer.design.status is not DesignStatus.EXACT:
        words = f"{words}, misfit {misfit_text(answer.design.misfit)}"
    return words, kind


def _meaning(design: Design) -> str:
    """Return the status of a design, what its misfit measures, and the largest good value, as sentences."""
    status, bound = design.status.value, percent(design.largest_misfit, ".3g")
    good = f"The misfit is the {design.misfit_meaning}; up to {bound} is good."
    return f"{status[:1].upper()}{status[1:]}. {good}"


def _model(text: str) -> str | None:
    """Return the model kind in a text, even if the text has other problems; None if it cannot be read."""
    try:
        kind = Document(text).section("model").get("kind", "independent")
    except InvalidInput:
        return None
    return kind if isinstance(kind, str) else None
