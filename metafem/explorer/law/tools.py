"""Data of the controls above the plot."""

from __future__ import annotations

from typing import Any

from metafem.explorer.answer import Answer
from metafem.explorer.law.others import QUICK, SLOW, Block, own_name
from metafem.inversion import Design

# Why the axes cannot be in newtons, and why the law under the block model cannot be computed.
NO_FORCES = "Newtons need “Friction” with its shear strength and area ratio in the workshop."
NO_BLOCK = "The block model needs “Block” with its width, length and thickness in the workshop."


def tools_data(answer: Answer) -> dict[str, Any]:
    """Return the available axes and models, and the current choices.

    ``block`` says whether the law under the block model is available, see `block_data`.
    """
    design = answer.design
    template = None if design is None else design.template
    own = "" if design is None else own_name(design)
    return {
        "newtons": answer.state.newtons,
        "no_forces": NO_FORCES if template is None or template.friction is None else "",
        "models": [{"name": name, "on": name in answer.state.models} for name in QUICK if name != own],
        "block": own != SLOW,
    }


def block_data(block: Block, design: Design | None) -> dict[str, Any]:
    """Return the state of the law under the block model, and why it cannot be computed, "" if it can."""
    missing = design is None or design.template.block is None
    return {**block.state(design), "missing": NO_BLOCK if missing else ""}
