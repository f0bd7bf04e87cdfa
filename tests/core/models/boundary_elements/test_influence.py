"""Influence of loaded cells: fast products against all pairs."""

import math

import mpmath
import numpy as np
import pytest

import metafem as mf
from metafem.models.boundary_elements import influence
from metafem.models.boundary_elements.cells import Scene, boxes
from metafem.models.boundary_elements.influence import Influence


def point(r):
    return 1.0 / (math.pi * r)


def none(r):
    return np.zeros_like(r)


def soft(r):
    """A smooth regular part, as wide as the patches are apart."""
    return -0.01 * np.exp(-((r / 60.0) ** 2))


def patches_of(place, half_width):
    surface = mf.Surface(place, np.ones(len(place)), 100.0, mf.Material(1.0))
    scene = Scene(surface, 1.0, mf.HalfSpace(), mf.Hertz())
    return [scene.patch(*box) for box in zip(*boxes(scene.position, np.asarray(half_width)), strict=True)]


def operator_of(patches, regular=none):
    corner, shapes = np.array([p[0] for p in patches]), [p[1].shape for p in patches]
    return Influence(corner, shapes, lambda r: point(r) + regular(r), regular)


def exact(x, y):
    """Johnson, equation 3.25, in 60 digits: the second difference of an antiderivative of 1/r."""
    with mpmath.workdps(60):
        half = mpmath.mpf(1) / 2

        def antiderivative(u, v):
            return u * mpmath.asinh(v / abs(u)) + v * mpmath.asinh(u / abs(v))

        total = sum(a * b * antiderivative(x + a * half, y + b * half) for a in (-1, 1) for b in (-1, 1))
        return float(total / mpmath.pi)


def test_influence_of_a_cell_is_loves():
    table = influence.love_table(40, 90)
    for i, j in ((0, 0), (1, 0), (3, 2), (8, 9), (29, 0), (29, 29), (30, 0), (0, 30), (39, 89), (29, 31)):
        assert table[i, j] == pytest.approx(exact(i, j), rel=1e-12)
    # the middle of a square: 4 ln(1 + sqrt 2) / pi per side
    assert table[0, 0] == pytest.approx(4.0 * math.log(1.0 + math.sqrt(2.0)) / math.pi, rel=1e-14)


def dense(patches, regular):
    """All pairs of cells, one by one."""
    cells = np.concatenate(
        [(corner + np.stack(np.indices(gap.shape), axis=-1)).reshape(-1, 2) for corner, gap, _ in patches]
    )
    table = influence.love_table(*(np.ptp(cells, axis=0) + 1).tolist())
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
        operator = operator_of(patches, regular)
        pressure = np.random.default_rng(0).random(operator.size)
        expected = matrix @ pressure
        error = np.abs(operator.product(pressure) - expected).max() / np.abs(expected).max()
        exact = regular is none and len(patches) == 1
        # two Gauss points a side err by h^4/4320 of the fourth derivative, for the image 24/8^5
        assert error <= (1e-13 if exact else max(influence.TOLERANCE, 1e-7 * (regular is image)))


def test_preconditioner_is_positive_and_near_the_inverse():
    operator = operator_of(patches_of([[0.0, 0.0]], [12.0]))
    matrix = dense(patches_of([[0.0, 0.0]], [12.0]), none)
    inverse = np.array([operator.precondition(row) for row in np.eye(operator.size)])
    values = np.linalg.eigvals(inverse @ matrix).real
    # without it the condition is above 100; a dozen iterations follow from this one
    assert values.min() > 0.0
    assert values.max() / values.min() < 12.0


def test_close_boxes_become_one_patch_that_knows_its_owners():
    patches = patches_of([[0.0, 0.0], [12.0, 0.0], [90.0, 0.0]], [5.0, 5.0, 5.0])
    assert len(patches) == 2
    _, _, owner = max(patches, key=lambda patch: patch[1].size)
    assert set(np.unique(owner)) == {0, 1}
