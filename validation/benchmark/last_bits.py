"""In how many designs targets changed by 1e-13, or other kernels of BLAS, change the verdict or misfit."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import metafem as mf
from validation.timing import Row

DESIGNS, CHANGES, CHANGE = 200, 8, 1e-13

# Kernels that every processor with AVX2 has, by their names in OpenBLAS.
KERNELS = ("Prescott", "Haswell")

# A design meets its goal within this misfit, as the status of a design says.
GOAL = 0.01

# Misfit up to which all are alike, and largest ratio of two larger ones.
CLOSE, RATIO = 2e-3, 1.5

SHAPES = ((3, 3), (4, 4), (5, 5), (6, 6), (8, 8))
MODELS = (
    *4 * (mf.Independent(),),
    *(mf.Interacting(order=1), mf.Interacting(order=3), mf.Interacting(order=3, substrate=mf.BondedLayer())),
)
TOOLS = (*5 * (None,), (0.3, 0.526, 0.8), mf.RadiusRange(0.3, 0.8))
STEPS = (None, None, 0.005)
LARGEST = 0.27  # height [mm]

# Largest change of the exponent of a law, up to which about a quarter of the targets are missed.
BEND = 0.3

# A verdict, and a misfit, 0 if refused.
Outcome = tuple[str, float]

# Returns a value with each of its numbers changed, or as it is.
Changed = Callable[[object], np.ndarray]


def targets(load: np.ndarray, area: np.ndarray, bend: float, changed: Changed) -> list[mf.inversion.Target]:
    """Return a target of each kind from a law of 16 loads; with a bend some are met and some are not."""
    area = area * (load / load[9]) ** bend
    first, last = (load[4], load[7]), (load[10], load[15])
    slope = [float((area[j] - area[i]) / (load[j] - load[i])) for i, j in ((4, 7), (10, 15))]
    ratio = float(np.mean(area[6:] / load[6:]))
    exponent = float(np.polyfit(np.log(load[6:]), np.log(area[6:]), 1)[0])
    some = [5, 9, 14]
    return [
        mf.OperatingPoints(load[some], changed(area[some])),
        mf.LinearLaw(float(changed(1.05 * ratio))),
        mf.LinearLaw(float(changed(ratio)), (load[8], load[15])),
        mf.BilinearLaw(changed(slope), float(load[8])),
        mf.BilinearLaw(changed(slope), float(load[8]), (load[4], load[15])),
        mf.MultilinearLaw(changed(slope), [(first[1], last[0])], (first[0], last[1])),
        mf.PowerLaw(float(changed(exponent)), (load[6], load[15])),
        mf.SampledLaw(load[4:], changed(area[4:] * (1.0 + 0.02 * np.sin(np.arange(12))))),
        mf.Band(load[4:], changed(0.98 * area[4:]), changed(1.02 * area[4:])),
    ]


def outcomes(number: int) -> Iterator[Outcome]:
    """Yield the outcome of a random design, and of the same with changed targets."""
    material = mf.Material(1.36)
    rng = np.random.default_rng(number)
    shape = SHAPES[rng.integers(len(SHAPES))]
    template = mf.Surface.square_lattice(0.12, shape, pitch=1.5, radius=0.526, material=material)
    template = template.replaced(block=mf.Block(20.0, 20.0, 7.2))
    known = template.replaced(height=0.05 + np.minimum(rng.exponential(0.04, template.count), 0.2))
    model = MODELS[rng.integers(len(MODELS))]
    load = template.count / 64 * np.linspace(0.025, 0.4, 16)
    area = model.curve(known, load).area
    bend = rng.uniform(-BEND, BEND)
    kind = number % len(targets(load, area, bend, np.asarray))
    tools, step = TOOLS[rng.integers(len(TOOLS))], STEPS[rng.integers(len(STEPS))]
    limits = mf.Limits(LARGEST, offset=0.02, height_step=step)
    for change in range(1 + CHANGES):
        draws = np.random.default_rng([number, change])

        def changed(
            value: object, draws: np.random.Generator = draws, size: float = min(change, 1)
        ) -> np.ndarray:
            numbers = np.asarray(value, dtype=float)
            return numbers * (1.0 + size * CHANGE * draws.uniform(-1.0, 1.0, numbers.shape))

        try:
            target = targets(load, area, bend, changed)[kind]
            found = mf.design(target, template, model, limits, tools=tools)
            goal = "met" if found.misfit <= GOAL else "missed"
            yield f"{type(target).__name__}: {found.status.name}, goal {goal}", found.misfit
        except mf.MetafemError as error:
            yield type(error).__name__, 0.0


def differ(found: list[Outcome]) -> bool:
    """Return whether outcomes have different verdicts, or misfits of which one is RATIO times another."""
    misfits = [max(misfit, CLOSE) for _, misfit in found]
    return len({verdict for verdict, _ in found}) > 1 or max(misfits) > RATIO * min(misfits)


def measured(kernels: str, count: int) -> list[list[Outcome]]:
    """Return the outcomes of random designs, found by a process with these kernels."""
    environment = os.environ | {"OPENBLAS_CORETYPE": kernels, "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-W", "ignore", "-m", __name__, str(count)]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def rows(count: int = DESIGNS) -> list[Row]:
    """Measure in how many designs an outcome differs; each is printed."""
    with ThreadPoolExecutor(len(KERNELS)) as pool:
        found = dict(zip(KERNELS, pool.map(lambda name: measured(name, count), KERNELS), strict=True))
    for number in range(count):
        every = {name: found[name][number] for name in KERNELS}
        if differ([outcome for each in every.values() for outcome in each]):
            print(
                number,
                {name: sorted({f"{said}, {misfit:.2%}" for said, misfit in every[name]}) for name in every},
            )
    changed = [
        Row(f"targets changed by {CHANGE:g}, {name}: designs that differ, of {count}", 0.0,
            sum(map(differ, found[name])), "")
        for name in KERNELS
    ]  # fmt: skip
    other = sum(differ([a[0], b[0]]) for a, b in zip(*found.values(), strict=True))
    return [*changed, Row(f"{' and '.join(KERNELS)}: designs that differ, of {count}", 0.0, other, "")]


if __name__ == "__main__":
    for number in range(int(sys.argv[1])):
        print(json.dumps(list(outcomes(number))), flush=True)
