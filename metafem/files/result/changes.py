"""Detect changes of a result folder after metafem wrote it, and compute the law anew for changed heights."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from metafem.errors import MetafemError
from metafem.files.atomic import MANIFEST, unchanged, written
from metafem.files.reading import file_label
from metafem.inversion import Design
from metafem.inversion.assessment import misfit_text, reassessed
from metafem.notes import Note

RECORD = "design.json"

# Relative difference up to which a stored law agrees with the recomputed law of the stored heights. Another
# order of summation or another last iteration changes areas by 1e-12, and rounded heights by 1e-8.
SAME = 1e-6

# Relative amount by which a height may exceed its limits due to rounding.
ROUNDING = 1e-9


@dataclass(frozen=True)
class FolderNote(Note):
    """A note on a changed result folder; it is not saved if the design is saved in another folder."""


def compared(design: Design, folder: Path) -> tuple[Design, tuple[Note, ...]]:
    """Return a loaded design and notes on changes in its folder.

    If design.json was changed and its law is not that of its heights, the returned design has the recomputed
    law. The law is also checked if the folder has no list of files, for example because it was copied without
    hidden files. In this case it is not checked for models without gradients, whose laws take minutes.
    """
    known = written(folder) if (folder / MANIFEST).is_file() else {}
    changed = sorted(
        name
        for name, hashes in known.items()
        if (folder / name).exists() and not unchanged(folder / name, hashes)
    )
    notes: list[Note] = [
        FolderNote(
            f"{file_label(folder / name)} was changed since metafem wrote it; the design of {RECORD} counts"
        )
        for name in changed
        if name != RECORD
    ]
    model = design.law.model
    if RECORD in changed or (RECORD not in known and model.gradient_model == model):
        design, found = _recomputed(design, folder / RECORD, RECORD in changed)
        notes = [*found, *notes]
    return replace(design, notes=(*notes, *design.notes)) if notes else design, tuple(notes)


def _recomputed(design: Design, path: Path, changed: bool) -> tuple[Design, list[Note]]:
    """Return the design, with the law of its heights if the stored law differs from it, and notes on this."""
    name = file_label(path)
    words = f"{name} was changed since metafem wrote it" if changed else f"{name} does not fit together"
    try:
        again = reassessed(design)
    except MetafemError as reason:
        words = f"{words}: the law of its heights is not found ({reason})"
        return design, [FolderNote(words)] if changed else []
    misfits = f"the misfit of its heights is {misfit_text(again.misfit)}"
    limits, height = design.limits, design.surface.height
    low, high = limits.foot, limits.offset + limits.max_height
    slack = ROUNDING * high
    outside = int(((height < low - slack) | (height > high + slack)).sum())
    same = abs(again.misfit - design.misfit) <= SAME and _same_law(design, again)
    other = _other_target(design)
    notes: list[Note] = []
    if other:
        notes.append(FolderNote(f"{words}: {other}; run metafem design again"))
    if not same:
        stated = f"it states {misfit_text(design.misfit)}"
        notes.append(FolderNote(f"{words}: {misfits}, and {stated}; law and misfit are computed anew"))
    elif changed and not other:
        notes.append(FolderNote(f"{words}: {misfits}, as it states"))
    if outside:
        many = f"{outside} of {len(height)} heights"
        notes.append(FolderNote(f"{name} has {many} outside its limits, from {low:g} to {high:g} mm"))
    return design if same else again, notes


def _same_law(design: Design, again: Design) -> bool:
    stated, found = design.law, again.law
    return _same(stated.rescaled_load, found.rescaled_load) and _same(
        stated.rescaled_friction, found.rescaled_friction
    )


def _other_target(design: Design) -> str:
    """Return a sentence if the heights were designed for other lines than those of the target, else ""."""
    target, made = design.target, [branch for branch, _ in design.fits]
    wanted: ArrayLike = [(slope, *ends) for slope, ends in target.branches]
    found: ArrayLike = [(branch.slope, *branch.load_range) for branch in made]
    if not target.branches:  # the target states only slopes and crossover loads
        starts = [0.0, *(branch.load_range[1] for branch in made)]
        wanted = target.lines
        found = [(branch.slope, start) for branch, start in zip(made, starts, strict=False)]
    if _same(wanted, found):
        return ""
    lines = [f"slope {branch.slope:.4g} to {branch.load_range[1]:.4g} mm^2" for branch in made]
    words = " and ".join(lines) or "another law"
    return f'it states the target "{target.title}", but its heights were designed for {words}'


def _same(stated: ArrayLike, found: ArrayLike) -> bool:
    return np.shape(stated) == np.shape(found) and np.allclose(stated, found, rtol=SAME, atol=0.0)
