"""Targets of stiffness, tangential stiffness and conductance: laws of known surfaces are inverted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import metafem as mf
from metafem.models import Model
from validation.timing import Row, took

# Number of known surfaces of each quantity, and the loads P/E* of their laws [mm^2].
SURFACES, LOADS = 200, np.linspace(0.02, 0.3, 20)

QUANTITIES = ("stiffness", "tangential_stiffness", "conductance")

# Number of surfaces whose friction and stiffness are met together, and of those scaled to a pull-off force;
# adhesion energy [N/mm].
FEW, ENERGY = 40, 9e-6

# Misfit up to which a law is found, and that of surfaces under interaction.
FOUND, FOUND_TOGETHER = 5e-3, 2e-3

# Models with interaction, and the number of known surfaces of each quantity under each.
MODELS = (mf.MeanField(), mf.Interacting(1), mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer()))
INTERACTING = 5


def template() -> mf.Surface:
    """Return the sites and the largest height."""
    block = mf.Block(20.0, 20.0, 7.2)
    return mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36, 0.45), block=block)


def known(rng: np.random.Generator) -> mf.Surface:
    """Return a surface with random heights of a random distribution, with 10 to 64 asperities."""
    whole = template()
    heights = 0.12 * rng.beta(*rng.uniform(0.7, 4.0, 2), 64)
    some = rng.permutation(64)[: rng.integers(10, 65)]
    return whole.replaced(position=whole.position[some], height=heights[some], radius=0.526)


def law_of(surface: mf.Surface, of: str, model: Model | None = None) -> np.ndarray:
    """Return the rescaled quantity of a surface at the loads [mm], by the predictions."""
    modulus = surface.material.composite_modulus
    given: dict[str, Any] = {"load": modulus * LOADS}
    if of == "tangential_stiffness":
        return mf.tangential_stiffness(surface, model, **given) / modulus
    if of == "conductance":
        return mf.conductance(surface, model, **given, resistivity=1.0).rescaled_conductance
    return mf.friction_law(surface, model, **given).rescaled_stiffness


def interacting(of: str, model: Model) -> tuple[list[float], list[float]]:
    """Return the misfits of designs for a quantity of known surfaces, and their times [s]."""
    misfits, times = [], []
    for seed in range(INTERACTING):
        rng = np.random.default_rng(seed)
        surface = template().replaced(height=0.12 * rng.beta(*rng.uniform(0.7, 4.0, 2), 64))
        wanted = law_of(surface, of, model)
        target = mf.SampledLaw(LOADS, wanted, of=of)
        seconds, found = took(lambda t=target, s=seed: mf.design(t, template(), model, rng=s))
        misfits.append(float(np.sqrt(np.mean((law_of(found.surface, of, model) / wanted - 1.0) ** 2))))
        times.append(seconds)
    return misfits, times


def together(seed: int, model: Model | None = None) -> tuple[float, float]:
    """Return the larger misfit of the friction and the stiffness of a known surface, and the time [s]."""
    surface = known(np.random.default_rng(seed))
    law = mf.friction_law(surface, model, load=surface.material.composite_modulus * LOADS)
    friction = mf.SampledLaw(LOADS, law.area)
    stiffness = mf.SampledLaw(LOADS, law.rescaled_stiffness, of="stiffness")
    seconds, found = took(
        lambda: mf.trade_off(friction, stiffness, template(), model, rng=seed, weights=[0.5])
    )
    return float(found.misfits[found.best].max()), seconds


def least_of_both(radii: list[float] | None) -> float:
    """Return the least larger misfit of two power laws that one radius does not meet together."""
    friction = mf.PowerLaw(0.9, (0.05, 0.2), prefactor=6.5)
    stiffness = mf.PowerLaw(0.5, (0.05, 0.2), prefactor=17.0, of="stiffness")
    return float(mf.trade_off(friction, stiffness, template(), tools=radii).misfits.max(axis=1).min())


def pull_off_error(seed: int) -> float:
    """Return the relative error of the force of a surface scaled to a random pull-off force."""
    rng = np.random.default_rng(seed)
    surface = template().replaced(height=0.12 - 0.01 * rng.random(64))
    model = mf.Independent(mf.JKR(ENERGY))
    force = rng.uniform(0.2, 0.9) * 64 * 1.5 * np.pi * ENERGY * 0.526
    found = mf.scaled_to_pull_off(surface, force, model, load=0.1)
    return abs(mf.pull_off(found, model, load=0.1) / force - 1.0)


def rows() -> Iterator[Row]:
    """Invert the laws, and measure the share found, the misfits and the times."""
    for of in QUANTITIES:
        rng, misfits, times = np.random.default_rng(0), [], []
        for seed in range(SURFACES):
            target = mf.SampledLaw(LOADS, law_of(known(rng), of), of=of)
            try:
                seconds, design = took(lambda t=target, s=seed: mf.design(t, template(), rng=s))
            except mf.Infeasible:
                misfits.append(np.inf)
                continue
            again = law_of(design.surface, of) / target.rescaled_friction - 1.0
            misfits.append(float(np.sqrt(np.mean(again**2))))
            times.append(seconds)
        name = of.replace("_", " ")
        missed = float(np.mean(np.array(misfits) > FOUND))
        yield Row(f"share of {SURFACES} laws of the {name} that are not found", 0.0, missed)
        yield Row(f"largest misfit of a law of the {name}", FOUND, max(misfits))
        yield Row(f"median time of a design for the {name}", 0.3, float(np.median(times)), "s")
    for of in QUANTITIES:
        results = [interacting(of, model) for model in MODELS]
        worst = max(misfit for misfits, _ in results for misfit in misfits)
        spent = [seconds for _, times in results for seconds in times]
        name = f"{len(spent)} laws of the {of.replace('_', ' ')} under {len(MODELS)} models with interaction"
        yield Row(f"largest misfit of {name}", FOUND_TOGETHER, worst)
        yield Row(f"median time of a design for {name}", 5.0, float(np.median(spent)), "s")
    pairs = [together(seed, mf.Interacting()) for seed in range(INTERACTING)]
    worst = max(misfit for misfit, _ in pairs)
    name = f"{INTERACTING} pairs of friction and stiffness met together by order 3"
    yield Row(f"largest misfit of {name}", FOUND, worst)
    both = [together(seed) for seed in range(FEW)]
    worst, times = max(misfit for misfit, _ in both), [seconds for _, seconds in both]
    yield Row(f"largest misfit of {FEW} pairs of friction and stiffness met together", FOUND, worst)
    yield Row("median time for one weight", 1.0, float(np.median(times)), "s")
    yield Row("two power laws, least larger misfit with one radius", np.inf, least_of_both(None))
    yield Row("the same with radii of 0.2, 0.526 and 1 mm", FOUND, least_of_both([0.2, 0.526, 1.0]))
    forces = max(pull_off_error(seed) for seed in range(FEW))
    yield Row(f"largest error of {FEW} surfaces scaled to a pull-off force", 1e-6, forces)
