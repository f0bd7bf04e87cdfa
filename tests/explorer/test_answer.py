"""Drafts refuse what the whole search refuses, and what they leave undecided it decides."""

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.history import State
from metafem.files import demo_text, parsed

TEXT = demo_text("operating-points")

# Random targets of each kind: some of them are refused.
TRIALS = {"operating-points": 30, "sampled": 20, "linear": 6, "bilinear": 8, "power": 12, "multilinear": 8}

# A section by which each asperity can have one of two radii.
TOOLS = "[tools]\nradii = ['300 um', '526 um']\n"


def text_of(target, rows=8):
    """Return a specification of a target, the rest of which is that of the demo."""
    rest = TEXT[TEXT.index("[material]") :].replace("shape = [8, 8]", f"shape = [{rows}, {rows}]")
    return "\n".join(["[target]", *(f"{key} = {value!r}" for key, value in target.items()), "", rest])


def areas(*values):
    """Return areas [mm^2] as they are written in a specification."""
    return [f"{value:.6g} mm^2" for value in values]


def points(load, friction):
    """Return a target of operating points."""
    return {"kind": "operating-points", "rescaled_load": areas(*load), "rescaled_friction": areas(*friction)}


def random_target(kind, rng):
    """Return a target that is near the law of a random surface, or some way from it."""
    template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    height = np.maximum(0.27 - rng.exponential(rng.uniform(0.01, 0.1), 64), 0.0)
    number = rng.integers(3, 6)
    load = np.sort(rng.uniform(0.03, 0.8, number))
    area = mf.Independent().curve(template.replaced(height=height), load).area
    friction = np.maximum.accumulate(area * rng.normal(1.0, rng.choice([0.0, 0.02, 0.2]), number))
    friction += 1e-3 * np.arange(number)
    if kind in ("operating-points", "sampled"):
        return {**points(load, friction), "kind": kind}
    slopes = (np.diff(friction, prepend=0.0) / np.diff(load, prepend=0.0)).round(4).tolist()
    crossovers, ends = areas(*load[:2]), areas(0.5 * load[0], load[2])
    open_ended = rng.random() < 0.5
    ranged = {} if open_ended else {"load_range": ends}
    return {
        "linear": {"slope": slopes[0], **ranged},
        "bilinear": {"slopes": slopes[:2], "crossover_load": crossovers[0], **ranged},
        "power": {"exponent": rng.uniform(0.6, 1.5), "load_range": ends}
        | ({} if open_ended else {"prefactor": slopes[0]}),
        "multilinear": {"slopes": slopes[:3], "crossover_loads": crossovers, "load_range": ends},
    }[kind] | {"kind": kind}


@pytest.mark.parametrize("kind", TRIALS)
def test_what_a_draft_refuses_the_whole_search_refuses(kind):
    rng = np.random.default_rng(0)
    refused = 0
    for trial in range(TRIALS[kind]):
        text = text_of(random_target(kind, rng), int(rng.integers(3, 9)))
        if trial % 3 == 1:
            text = text.replace("height_sd", "height_step = '6 um'\nheight_sd")
        if kind == "operating-points" and trial % 3 == 2:
            text = text.replace('radius = "526 um"', "") + TOOLS
        answer = answered(State(text), 1, draft=True)
        assert not answer.problems
        if answer.refusal and not answer.undecided:
            refused += 1
            with pytest.raises(mf.Infeasible):
                parsed(text).design()
    assert refused > 0
