"""Warnings of designs at random against what their reports compute."""

import re
from contextlib import suppress
from itertools import islice

import numpy as np

import metafem as mf
from metafem.prediction.validity import BOUND
from metafem.report import all_notes
from metafem.report.comparison import compared

# Half of them crowded or on thin blocks.
DESIGNS = 40

# A report warns of more than this; the notes do so from BOUND on.
WARNED = 0.05


def random_designs():
    """Yield designs at random whose targets are within reach."""
    rng = np.random.default_rng(0)
    while True:
        side, pitch = int(rng.integers(4, 9)), float(rng.choice([0.3, 0.5, 0.8, 1.5]))
        thickness, size = float(rng.choice([0.2, 0.5, 1.0, 3.0, 7.2])), side * pitch + 10.0
        template = mf.Surface.square_lattice(
            0.12, (side, side), pitch, radius=0.526,
            material=mf.Material(1.36, float(rng.choice([0.3, 0.5]))),
            block=None if rng.random() < 0.3 else mf.Block(size, size, thickness),
        )  # fmt: skip
        share = side**2 / 64
        targets = (
            mf.LinearLaw(float(rng.uniform(5.0, 9.0))),
            mf.OperatingPoints(share * np.array([0.144, 0.336]), share * np.array([0.84, 1.68])),
            mf.BilinearLaw((7.15, 12.52), 0.038 * share),
        )
        target, model = targets[rng.integers(3)], (mf.Independent(), mf.MeanField())[rng.integers(2)]
        limits = mf.Limits(float(rng.choice([0.12, 0.27])), offset=float(rng.choice([0.0, 0.08])))
        with suppress(mf.Infeasible):
            yield mf.design(target, template, model, limits, int(rng.integers(100)))


def test_notes_warn_of_differences_in_the_report():
    judged, off = 0, []
    for design in islice(random_designs(), DESIGNS):
        warnings = [note.text for note in all_notes(design) if note.warns]
        texts = " ".join(map(str, design.notes))
        nearest = "half-space" if design.surface.block is None else "layer"
        for comparison in compared(design)[0]:
            rms = float(np.sqrt((comparison.difference**2).mean()))
            assert warnings or rms <= WARNED, (design, comparison.name, rms)
            if comparison.name != nearest or rms < 0.01:
                continue
            found = re.search(r"by ([\d.]+) % rms", texts)
            estimate = float(found[1]) / 100.0 if found else 0.0
            judged += 1
            if not (0.5 < estimate / rms < 2.0):
                off.append((rms, estimate, texts))
            assert (rms <= WARNED) or any("changes A0" in text or "elastic" in text for text in warnings)
            assert (rms > 0.8 * BOUND) or not any("changes A0" in text for text in warnings)
        state = mf.equilibrium(design.surface, design.law.model, load=float(design.law.load[-1]))
        assert (state.base_gap <= 0.0) == any("base plane would touch" in text for text in warnings)
    assert judged > DESIGNS / 3
    assert not off
