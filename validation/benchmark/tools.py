"""Power laws, second slopes, saturation and plateaus of tools of several shapes, and of one cap.

Run ``python -m validation.benchmark.tools``.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import metafem as mf
from metafem.inversion.targets.target import Target

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36))
LIMITS, LOADS = mf.Limits(0.3), (0.1, 0.4)

# Exponents of power laws.
EXPONENTS = np.arange(5, 21) / 10.0

# What may make the caps: spheres of one radius, or power caps.
TOOLS: dict[str, Any] = {
    "spheres": None,
    "three exponents": [mf.Tool(0.526, mf.Power(n)) for n in (1.5, 2.0, 6.0)],
    "exponents 1.2 to 6": mf.PowerRange(1.2, 6.0),
}

# Loads P/E* [mm^2] of laws given by samples: a constant friction up to a crossover, saturation, and steps.
SAMPLES = np.linspace(0.05, 0.4, 30)
SHAPES = {
    "saturation, 1 - exp(-P/.2)": 1.0 - np.exp(-SAMPLES / 0.2),
    "plateau of exponent .35 from .15 to .3": np.exp(
        np.interp(
            np.log(SAMPLES),
            np.log([0.05, 0.15, 0.3, 0.4]),
            np.cumsum([0.0, *np.array([1.0, 0.35, 1.0]) * np.diff(np.log([0.05, 0.15, 0.3, 0.4]))]),
        )
    ),
}


def main() -> None:
    """Print the misfit of each law with each choice of tools, the number of tools used, and the time."""
    for name, tools in TOOLS.items():
        for exponent in EXPONENTS.tolist():
            _report(f"{name}: exponent {exponent:g}", mf.PowerLaw(exponent, LOADS), tools)
        for slopes in ((8.0, 16.0), (8.0, 24.0), (8.0, 4.0), (8.0, 2.5)):
            law = mf.MultilinearLaw(slopes, [(0.18, 0.22)], LOADS)
            _report(f"{name}: slopes {slopes[0]:g} and {slopes[1]:g}", law, tools)
        for what, shape in SHAPES.items():
            best = min(
                (_designed(_sampled(scale * shape), tools) for scale in (2.0, 3.0, 4.0, 6.0)), key=_misfit
            )
            print(f"{name}: {what}: {_words(best)}")


def _sampled(friction: Any) -> mf.SampledLaw:
    return mf.SampledLaw(SAMPLES, friction)


def _designed(law: Target, tools: Any) -> mf.Design | mf.Infeasible:
    try:
        return mf.design(law, LATTICE, limits=LIMITS, tools=tools)
    except mf.Infeasible as error:
        return error


def _misfit(found: mf.Design | mf.Infeasible) -> float:
    return np.inf if isinstance(found, mf.Infeasible) else found.misfit


def _words(found: mf.Design | mf.Infeasible) -> str:
    if isinstance(found, mf.Infeasible):
        return f"refused: {found!s:.110}"
    used = {(found.surface.cap.one(i), found.surface.radius[i]) for i in range(found.surface.count)}
    return f"misfit {100.0 * found.misfit:.3f} %, {found.surface.count} asperities of {len(used)} tools"


def _report(name: str, law: Target, tools: Any) -> None:
    start = time.perf_counter()
    found = _designed(law, tools)
    print(f"{name}: {_words(found)}, {time.perf_counter() - start:.2f} s")


if __name__ == "__main__":
    main()
