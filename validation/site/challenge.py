"""The page of the challenge: how to enter a result, the targets, and the best results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from metafem.drawing import ACHIEVED, TARGET
from metafem.drawing.inline import Drawn, drawn
from validation.challenge import genetic, resolved
from validation.challenge.best_results import best
from validation.challenge.caps import Caps
from validation.challenge.certificates import certified, checked
from validation.challenge.score import DRAWS
from validation.challenge.sums import independent
from validation.challenge.task import Target, names, target
from validation.pages import site_page

# Mean error of the friction laws of a generative network, as its abstract states it, and its source.
NETWORK, NETWORK_DOI = 0.38, "10.48550/arXiv.2511.03735"

# Numbers in the text of the page.
NUMBERS = {
    "network": NETWORK,
    "doi": NETWORK_DOI,
    "cell": resolved.CELL,
    "error": resolved.ERROR,
    "draws": DRAWS,
    "evaluations": genetic.SIZE * genetic.GENERATIONS,
}

ADDRESS = "challenge/index.html"


def write_challenge(folder: Path) -> list[str]:
    """Write the page into ``folder/challenge``, and return its address."""
    found = json.loads(genetic.RESULTS.read_text("utf-8"))
    rows = [_row(target(name), found.get(name)) for name in names()]
    (folder / ADDRESS).parent.mkdir(parents=True, exist_ok=True)
    text = site_page("challenge.html", here=ADDRESS, rows=rows, numbers=NUMBERS)
    (folder / ADDRESS).write_text(text, "utf-8")
    return [ADDRESS]


def _row(wanted: Target, searched: dict[str, float] | None) -> dict[str, Any]:
    """Return what the page shows of a target."""
    stated = best(wanted.name).stated
    return {
        "target": wanted,
        "picture": _picture(wanted),
        "best": stated,
        "bound": checked(wanted.name) if wanted.name in certified() else None,
        "genetic": searched,
        "judge": "resolved contacts" if wanted.resolved else "closed forms",
    }


def _picture(wanted: Target) -> Drawn:
    """Return a small picture of the wanted law, and of that of the best result."""
    figure = Figure(figsize=(2.5, 1.6), layout="constrained")
    ax = figure.add_subplot()
    law = wanted.friction
    value = law.value
    if not wanted.resolved:
        entry = best(wanted.name)
        area, _ = independent(Caps.of(wanted.tools, entry.tool), entry.height, law.load)
        value = value * ((area / value).mean() if law.free else 1.0)
        ax.plot(law.load, area, color=ACHIEVED, label="best")
    ax.plot(law.load, value, ".", ms=4, color=TARGET, label="target")
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("P/E* [mm²]", fontsize=7)
    ax.set_ylabel("F/(σB) [mm²]", fontsize=7)
    ax.tick_params(labelsize=6)
    return drawn(figure, f"Target {wanted.name}")
