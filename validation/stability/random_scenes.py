"""Thousands of random scenes: none fails without a message, and few are refused.

``python -m validation.stability.random_scenes SEED ... [--outside]`` repeats single scenes.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass

import click
import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Check, Claim, Picture, Row, below, near, reported
from validation.scenes.random_contacts import random_scene
from validation.sources import known_input

# A minute and a half of one core.
SLOW = True

# Scenes of the report, half of them inside the documented ranges; the tests set a smaller number.
SCENES = 10_000

# Largest part of the scenes outside the ranges that may be refused.
REFUSED = 0.1

ENDS = ("converged", "refused", "failed")

STATED = known_input("largest residual of a converged equilibrium, stated by the model in Curve.tolerance")
NONE = known_input("the ranges that docstrings and README state: inside them every scene must be solved")
FEW = known_input("requirement: outside the ranges at most one scene in ten is refused")
REASON = known_input("a solution within its tolerance, or a MetafemError with a reason, must be the end")


@dataclass(frozen=True)
class Outcome:
    """What became of a scene: its end, the reason of a refusal or failure, and residual over tolerance."""

    seed: int
    inside: bool
    model: str
    law: str
    end: str
    reason: str = ""
    residual: float = 0.0


def outcome(seed: int, inside: bool) -> Outcome:
    """Solve a scene and return what became of it; any exception but a MetafemError is a failure."""
    scene = random_scene(seed, inside)
    names = seed, inside, _model_name(scene.model), type(scene.law).__name__
    try:
        curve = scene.model.curve(scene.surface, scene.load / scene.surface.material.composite_modulus)
        last = curve.last
    except mf.MetafemError as error:
        return Outcome(*names, "refused" if str(error) else "failed", str(error) or "no reason is given")
    except Exception as error:
        return Outcome(*names, "failed", repr(error))
    numbers = (curve.approach, curve.load, curve.area, curve.stiffness, last.load, last.area)
    if not all(np.isfinite(each).all() for each in numbers):
        return Outcome(*names, "failed", "a number is not finite")
    residual = float(curve.residual.max() / curve.tolerance)
    if not curve.converged:
        return Outcome(*names, "refused", f"{curve.status.value}, {residual:.2g} times", residual)
    return Outcome(*names, "converged", residual=residual)


def claim() -> Claim:
    """Solve all scenes and count how they end."""
    found = [outcome(seed, inside) for inside in (True, False) for seed in range(SCENES // 2)]
    return Claim(
        "Random scenes: surfaces, contact laws, models and loads",
        [*_checks(found), *_results(found)],
        {"ends by model and law": Picture(lambda: _ends(found), CAPTION)},
        _text(found),
    )


def _model_name(model: object) -> str:
    """Return the kind of a model with its order."""
    order = f" of order {model.order}" if isinstance(model, mf.Interacting) else ""
    return type(model).__name__ + order


def _checks(found: list[Outcome]) -> list[Check]:
    """Compare the numbers of failures and refusals with what is allowed."""
    failed = [each for each in found if each.end == "failed"]
    inside, outside = ([each for each in found if each.inside == side] for side in (True, False))
    solved = [each.residual for each in found if each.end == "converged"]
    return [
        near("scenes that fail", len(failed), 0, 0, REASON),
        near("inside the ranges: scenes that are refused", _count(inside, "refused"), 0, 0, NONE),
        below(
            "outside the ranges: part of the scenes that is refused",
            _count(outside, "refused") / len(outside), REFUSED, FEW,
        ),
        below("largest residual of a solved scene over its tolerance", max(solved), 1.0, STATED),
    ]  # fmt: skip


def _results(found: list[Outcome]) -> list[Row]:
    """State how many scenes of each model and of each law are solved."""
    rows: list[Row] = [reported("scenes", len(found), "half of them inside the documented ranges")]
    for kind in ("model", "law"):
        groups = _groups(found, kind)
        for name, group in groups.items():
            solved = _count(group, "converged")
            refused = f"of {len(group)} scenes; {_count(group, 'refused')} are refused, all outside"
            if any(each.inside and each.end == "refused" for each in group):
                refused = refused.replace("all outside", "some of them inside the ranges")
            rows.append(reported(f"{kind} {name}: scenes that converge", solved, refused))
    return rows


def _groups(found: list[Outcome], kind: str) -> dict[str, list[Outcome]]:
    """Return the outcomes by model or law, sorted by name."""
    groups = defaultdict(list)
    for each in found:
        groups[getattr(each, kind)].append(each)
    return dict(sorted(groups.items()))


def _count(found: list[Outcome], end: str) -> int:
    return sum(each.end == end for each in found)


def _text(found: list[Outcome]) -> str:
    """List the scenes that are not solved, by their reason without its numbers."""
    lists = defaultdict(list)
    for each in found:
        if each.end != "converged":
            reason = re.sub(r"\d[\d.e+-]*\d|\d", "…", each.reason)
            lists[each.end, reason].append(f"{'inside' if each.inside else 'outside'} {each.seed}")
    lines = [f"{end}, {reason}: {', '.join(seeds)}." for (end, reason), seeds in lists.items()]
    return " ".join(["Each scene follows from its seed.", *lines])


CAPTION = "Every bar is one model or law; the part that is not converged is refused with a reason."


def _ends(found: list[Outcome]):
    figure = new_figure(9.0, 4.0)
    for ax, kind in zip(figure.subplots(1, 2), ("model", "law"), strict=True):
        groups = _groups(found, kind)
        counts = {name: Counter(each.end for each in group) for name, group in groups.items()}
        left = np.zeros(len(groups))
        for end, colour in zip(ENDS, ("C0", "C1", "C3"), strict=True):
            width = np.array([100.0 * counts[name][end] / len(groups[name]) for name in groups])
            ax.barh(list(groups), width, left=left, color=colour, label=end)
            left += width
        ax.set(xlabel="part of the scenes [%]", xlim=(80, 100), title=f"by {kind}")
    ax.legend(frameon=False)
    return figure


@click.command()
@click.argument("seeds", type=int, nargs=-1, required=True)
@click.option("--outside", is_flag=True, help="The scenes outside the documented ranges.")
def main(seeds: tuple[int, ...], outside: bool) -> None:
    """Solve the scenes of SEEDS again and print what becomes of them."""
    for seed in seeds:
        click.echo(random_scene(seed, not outside))
        click.echo(outcome(seed, not outside))


if __name__ == "__main__":
    main()
