"""Influence of loaded cells: fast products against all pairs."""

import math

import numpy as np
import pytest

from metafem._kernels import love
from metafem.models.boundary_elements import far_field
from metafem.models.boundary_elements.influence import Influence
from metafem.models.boundary_elements.patches import Patch, boxes, patch
from metafem.models.boundary_elements.summits import Summits


def point(r):
    return 1.0 / (math.pi * r)


def none(r):
    return np.zeros_like(r)


def soft(r):
    """A smooth regular part, as wide as the patches are apart."""
    return -0.01 * np.exp(-((r / 60.0) ** 2))


def patches_of(place, half_width):
    place = np.asarray(place, dtype=float)
    summits = Summits(place, np.zeros(len(place)), np.full(len(place), 100.0))
    return [patch(summits, *box) for box in zip(*boxes(summits, np.asarray(half_width)), strict=True)]


def dense(patches, regular):
    """All pairs of cells, one by one."""
    cells = np.concatenate(
        [(p.corner + np.stack(np.indices(p.shape), axis=-1)).reshape(-1, 2) for p in patches]
    )
    table = love.table(*(np.ptp(cells, axis=0) + 1))
    i, j = np.abs(cells[:, None, :] - cells[None, :, :]).transpose(2, 0, 1)
    node, weight = np.polynomial.legendre.leggauss(4)
    mean = sum(
        0.25 * a * b * regular(np.hypot(i + 0.5 * x, j + 0.5 * y))
        for x, a in zip(node, weight, strict=True)
        for y, b in zip(node, weight, strict=True)
    )
    return table[i, j] + mean


def image(r):
    """The first image of a layer half as thick as the patches are wide."""
    return -1.0 / (math.pi * np.hypot(r, 8.0))


SCENES = {
    "one": ([[0.3, 0.2]], [9.0]),
    "apart": ([[0.0, 0.0], [40.3, 5.0], [11.0, 52.6]], [7.0, 5.0, 8.4]),
    "nearly merged": ([[0.0, 0.0], [30.0, 0.0], [0.0, 31.0], [29.0, 30.0]], [7.0, 7.0, 7.0, 7.0]),
}


@pytest.mark.parametrize("regular", [none, soft, image])
def test_product_is_the_sum_over_all_pairs_of_cells(regular):
    for scene in SCENES.values():
        patches = patches_of(*scene)
        matrix = dense(patches, regular)
        operator = Influence(patches, lambda r: point(r) + regular(r), regular)
        pressure = np.random.default_rng(0).random(operator.size)
        expected = matrix @ pressure
        error = np.abs(operator.product(pressure) - expected).max() / np.abs(expected).max()
        exact = regular is none and len(patches) == 1
        # two Gauss points a side err by h^4/4320 of the fourth derivative, for the image 24/8^5
        assert error <= (1e-13 if exact else max(far_field.TOLERANCE, 1e-7 * (regular is image)))


def test_preconditioner_is_positive_and_near_the_inverse():
    operator = Influence(patches_of([[0.0, 0.0]], [12.0]), point, none)
    matrix = dense(patches_of([[0.0, 0.0]], [12.0]), none)
    inverse = np.array([operator.precondition(row) for row in np.eye(operator.size)])
    values = np.linalg.eigvals(inverse @ matrix).real
    # without it the condition is above 100; a dozen iterations follow from this one
    assert values.min() > 0.0
    assert values.max() / values.min() < 12.0


def test_memory_of_the_expansions_is_foretold():
    patches = patches_of(*SCENES["apart"])
    half = np.array([p.shape for p in patches]) / 2.0
    rate = far_field.convergence_rate(np.array([p.centre for p in patches]), half)
    foretold = far_field.table_bytes(rate[np.triu_indices(3, 1)])
    assert foretold == Influence(patches, point, none).far.table[2].nbytes


def test_close_boxes_become_one_patch_that_knows_its_owners():
    patches = patches_of([[0.0, 0.0], [12.0, 0.0], [90.0, 0.0]], [5.0, 5.0, 5.0])
    assert len(patches) == 2
    together = max(patches, key=lambda p: p.gap.size)
    assert isinstance(together, Patch)
    assert set(np.unique(together.owner)) == {0, 1}
