"""Elastic unloading of asperities that a load has flattened, and their second loading."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf

MATERIAL = mf.Material(1.36, 0.3)
LAWS = [mf.KogutEtsion(0.02), mf.JacksonGreen(0.04)]
# below yield, at the foot of the published formulas, and far beyond
LARGEST = np.array([-1.0, 0.5, 1.0, 1.001, 1.05, 1.5, 2.5, 6.0, 20.0, 110.0])
RADIUS = np.linspace(0.4, 0.6, LARGEST.size)


def unloaded(law):
    """The law of the material, the largest indentations, the law after them and the losses of height."""
    bound = law.for_material(MATERIAL)
    d = LARGEST * bound.yield_indentation(RADIUS)
    return bound, d, *bound.unloaded(d, RADIUS)


def test_the_law_continues_where_the_first_loading_ended():
    for law in LAWS:
        bound, d, after, loss = unloaded(law)
        a = bound.contact_radius(d, RADIUS)
        assert_allclose(after.contact_radius(d - loss, RADIUS), a, rtol=1e-13)
        assert_allclose(after.load(a, RADIUS), bound.load(a, RADIUS), rtol=1e-13)
        deeper = 1.1 * np.abs(d)
        assert_allclose(
            after.contact_radius(deeper - loss, RADIUS), bound.contact_radius(deeper, RADIUS), rtol=1e-13
        )
        assert (loss[LARGEST > 1.0] > 0.0).all()
        assert not loss[LARGEST <= 1.0].any()


def test_a_cycle_loses_energy():
    """The loading's work exceeds that of the unloading, which the power of its load gives."""
    node, weight = np.polynomial.legendre.leggauss(40)
    for law in LAWS:
        bound, d, after, loss = unloaded(law)
        for i in np.flatnonzero(LARGEST > 0.0):
            ends = bound.indentation(np.append(0.0, bound.breaks(RADIUS[i])), RADIUS[i])
            taken = 0.0
            for low, high in itertools.pairwise(np.append(ends[ends < d[i]], d[i])):
                x = low + 0.5 * (high - low) * (node + 1.0)
                load = bound.load(bound.contact_radius(x, RADIUS[i]), RADIUS[i])
                taken += 0.5 * (high - low) * float(weight @ load)
            power = after.load_exponent[i] if loss[i] else 1.5
            largest = bound.load(bound.contact_radius(d[i], RADIUS[i]), RADIUS[i])
            returned = largest * (d[i] - loss[i]) / (power + 1.0)
            # the quadrature of a power 3/2
            assert taken - returned >= (0.0 if LARGEST[i] > 1.2 else -1e-5) * taken


def test_the_unloading_is_the_published_one():
    for law in LAWS:
        bound, d, after, loss = unloaded(law)
        rows = np.flatnonzero(LARGEST > 1.2)
        w = d[rows] / bound.yield_indentation(RADIUS[rows])
        expected = d[rows] * (1.0 - w**-0.28) * (1.0 - w**-0.69)
        assert_allclose(loss[rows], expected, rtol=1e-13)
        share = 0.3
        before, a = bound.contact_radius(d, RADIUS), after.contact_radius(share * (d - loss), RADIUS)
        area, load = before[rows] ** 2 * share ** (w**-0.12), bound.load(before, RADIUS)[rows]
        assert_allclose(a[rows] ** 2, area, rtol=1e-12)
        assert_allclose(after.load(a, RADIUS)[rows], load * share ** (1.5 * w**-0.0331), rtol=1e-12)


def test_the_law_of_one_asperity_is_its_part_of_all():
    for law in LAWS:
        _, d, after, _ = unloaded(law)
        e = 0.5 * np.abs(d)
        a = after.contact_radius(e, RADIUS)
        for i in range(d.size):
            one = after.one(i)
            assert_allclose(one.contact_radius(e[i], RADIUS[i]), a[i], rtol=1e-15)
            assert_allclose(one.load(a[i], RADIUS[i]), after.load(a, RADIUS)[i], rtol=1e-15)
            breaks = one.breaks(RADIUS[i])
            assert (np.diff(breaks) > 0.0).all()
            for edge in breaks:  # load and area are continuous there
                low, high = one.indentation(edge * (1.0 + 1e-12 * np.array([-1.0, 1.0])), RADIUS[i])
                assert low == pytest.approx(high, rel=1e-10)


def test_a_third_loading_depends_on_the_largest_alone():
    bound, d, after, loss = unloaded(LAWS[0])
    again, further = after.unloaded(0.5 * (d - loss), RADIUS)
    assert again == after
    assert not further.any()
    deeper = 1.3 * np.abs(d)
    expected, total = bound.unloaded(deeper, RADIUS)
    found, further = after.unloaded(deeper - loss, RADIUS)
    assert_allclose(loss + further, total, rtol=1e-13)
    rows = total > 0.0
    for name in ("residual", "depth", "load_before", "area_before", "load_exponent", "area_exponent"):
        assert_allclose(getattr(found, name)[rows], getattr(expected, name)[rows], rtol=1e-12)
