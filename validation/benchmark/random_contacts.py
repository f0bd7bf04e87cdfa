"""Random scenes, laws and models: none refused inside the documented ranges, few outside, with a reason.

``python -m validation.benchmark.random_contacts COUNT`` also prints every refusal.
"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import click

import metafem as mf
from validation.scenes.random_contacts import random_scene
from validation.timing import Row

SCENES = 2000

# Largest part of the scenes outside the ranges that may be refused.
REFUSED = 0.1


def outcome(seed: int, inside: bool) -> tuple[str, str]:
    """Solve a scene; return what happened, and the reason or the law and the model."""
    scene = random_scene(seed, inside)
    told = f"{scene.model!r}, {scene.surface.count} asperities"
    try:
        curve = scene.model.curve(scene.surface, scene.load / scene.surface.material.composite_modulus)
    except mf.MetafemError as error:
        return ("refused" if str(error) else "refused without a reason"), f"{told}: {error}"
    except Exception as error:
        return "failed", f"{told}: {error!r}"
    if not curve.converged:
        return "residual", f"{told}: {curve.residual.max():.1e}"
    return "solved", told


def outcomes(count: int, inside: bool) -> list[tuple[str, str]]:
    """Return what happened to the scenes, computed in processes."""
    with ProcessPoolExecutor() as processes:
        return list(processes.map(partial(outcome, inside=inside), range(count), chunksize=10))


def summary(inside: list[tuple[str, str]], outside: list[tuple[str, str]]) -> list[Row]:
    """Count what happened."""
    found = []
    for name, ends, most in (("inside", inside, 0.0), ("outside", outside, REFUSED)):
        count = Counter(end for end, _ in ends)
        refused = count["refused"] / len(ends)
        found += [
            Row(f"{name} the ranges, {len(ends)} scenes: refused", most, refused, ""),
            Row(f"{name}: above the promised residual", most and REFUSED, count["residual"] / len(ends), ""),
            Row(
                f"{name}: without a reason", 0, float(count["refused without a reason"] + count["failed"]), ""
            ),
        ]
    return found


def long_rows() -> list[Row]:
    """Solve all scenes inside and outside the ranges."""
    return summary(outcomes(SCENES, True), outcomes(SCENES, False))


@click.command()
@click.argument("count", type=int)
def main(count: int) -> None:
    """Solve COUNT scenes inside the ranges and as many outside, and print those without a solution."""
    parts = [outcomes(count, inside) for inside in (True, False)]
    for name, ends in zip(("inside", "outside"), parts, strict=True):
        for seed, (end, told) in enumerate(ends):
            if end != "solved":
                click.echo(f"{name} {seed}: {end}, {told}")
    for row in summary(*parts):
        click.echo(f"{row.what}: {row.measured:.3g} (at most {row.required:g})")


if __name__ == "__main__":
    main()
