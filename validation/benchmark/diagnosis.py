"""How often the 68 % intervals of explanations contain the truth."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from metafem.calibration import Priors, explain
from metafem.calibration.bounded_interval import WIDTH
from validation.calibration.diagnosis import ALONE, NAMES, covered, design, measured, part, trials
from validation.timing import Row

# Parts measured with the areas of their contacts and by friction alone, and those with errors of every height
# and radius.
PARTS, SINGLE_PARTS = 2000, 200


def rows() -> Iterator[Row]:
    """Explain parts drawn from the priors: half a minute with the areas, and as long by friction alone."""
    for areas, what, required in ((True, "with areas", 0.04), (False, "F(P) alone", 0.04)):
        shares = covered(trials(PARTS, areas))
        yield from (
            Row(f"{name}, {what}: coverage of 68 % off by", required, abs(float(share) - 0.68))
            for name, share in zip(NAMES, shares, strict=True)
        )


def long_rows() -> list[Row]:
    """Explain parts whose heights and radii have errors of their own, too."""
    priors = Priors()
    inside: dict[str, list[np.ndarray]] = {"height": [], "radius": []}
    for seed in range(SINGLE_PARTS):
        rng = np.random.default_rng(seed)
        _, surface, friction = part(rng)
        errors = {name: getattr(priors, f"{name}_sd") * rng.standard_normal(surface.count) for name in inside}
        changed = {name: getattr(surface, name) + error for name, error in errors.items()}
        made = surface.replaced(**changed)
        found = explain(measured(made, friction, rng, True), design(), priors, model=ALONE)
        for name, values in inside.items():
            one = found.single[name]
            values.append(np.abs(one.mean - errors[name]) <= WIDTH * one.sd)
    return [
        Row(f"single summits, {name}: coverage off by", 0.04, abs(np.mean(values) - 0.68))
        for name, values in inside.items()
    ]
