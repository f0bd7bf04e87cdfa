"""A law drawn by hand: whatever was added, dragged, refused and undone, the next drag leads to a surface."""

import numpy as np
import pytest

from metafem.explorer.answer import answered
from metafem.explorer.handles import added, moved, removed, scene_of
from metafem.explorer.history import State
from metafem.explorer.kinds import reachable, with_point
from metafem.files import demo_text

SEQUENCES, STEPS = 200, 5

# Vertical distance within which a new point is on the achieved law [mm^2]: 8 of 250 pixels of 5 mm^2.
NEAR = 0.16


class Drawing:
    """The states and answers of a page on which a law is drawn, as its plot and its panel make them."""

    def __init__(self, text, seed):
        self.rng = np.random.default_rng(seed)
        self.states = [State(text)]
        self.shown = answered(self.states[0], 0)

    @property
    def base(self):
        return self.states[-1], self.shown.specification, self.shown.design

    def show(self, state):
        self.shown = answered(state, self.shown.number + 1, self.shown)
        assert not self.shown.problems, self.shown.problems

    def commit(self, table):
        self.states.append(self.states[-1].edited(table))
        self.show(self.states[-1])

    def place(self):
        return float(self.rng.uniform(0.01, 0.9)), float(self.rng.uniform(0.05, 6.0))

    def add(self):
        design = self.shown.design
        load, friction = self.place()
        if self.rng.random() < 0.6:
            law = design.law
            friction = float(np.interp(load, law.rescaled_load, law.rescaled_friction))
            friction *= 1.0 + self.rng.normal(0.0, 0.01)
        self.commit(with_point(self.shown, load, friction, NEAR))

    def drag(self, reach):
        """Drag a handle to a place at a relative distance, as the pointer and the plot do."""
        base, stuck, design = self.base, bool(self.shown.refusal), self.shown.design
        marks = scene_of(*base).handles()
        mark = marks[self.rng.integers(len(marks))]
        good, last = None, self.shown
        for share in (0.5, 1.0):
            by = 1.0 + share * reach * self.rng.uniform(-1.0, 1.0, 2)
            table = moved(scene_of(*base), mark.id, mark.load * by[0], mark.friction * by[1])
            last = answered(base[0].edited(table), last.number + 1, last, draft=True)
            good = table if last.current else good
        if last.current:
            self.commit(table)
        elif good is not None:
            self.commit(good)
        else:
            self.commit(reachable(last) if stuck and last.refusal else base[0].table)
        return design

    def remove(self):
        state, specification, _ = self.base
        marks = scene_of(*self.base).handles()
        if len(marks) > 1:
            self.commit(
                removed(scene_of(state, specification, None), marks[self.rng.integers(len(marks))].id)
            )

    def undo(self):
        if len(self.states) > 1:
            self.states.pop()
            self.show(self.states[-1])

    def step(self):
        steps = (self.add, lambda: self.drag(0.1), lambda: self.drag(0.9), self.remove, self.undo)
        steps[self.rng.choice(5, p=(0.4, 0.2, 0.15, 0.1, 0.15))]()


@pytest.mark.nightly
def test_every_state_is_left_by_the_next_drag():
    refused = 0
    for seed in range(SEQUENCES):
        drawing = Drawing(demo_text("operating-points"), seed)
        for _ in range(STEPS):
            drawing.step()
        if drawing.shown.refusal:
            refused += 1
            drawing.drag(0.3)
            assert drawing.shown.current, (seed, drawing.shown.refusal)
    assert refused > SEQUENCES / 10


@pytest.mark.parametrize("seed", range(4))
def test_a_refused_law_is_left_by_a_drag(seed):
    drawing = Drawing(demo_text("operating-points"), seed)
    state, specification, _ = drawing.base
    drawing.commit(added(scene_of(state, specification, None), 0.5, 0.5))
    assert drawing.shown.refusal
    drawing.drag(0.2)
    assert drawing.shown.current
