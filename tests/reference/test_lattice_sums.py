"""Sums of the influence of a bonded layer over all sites of a square lattice."""

import pytest

from metafem import reference as exact


def test_lattice_sum_does_not_depend_on_where_it_ends(monkeypatch):
    total, laplacian = exact.layer_lattice_sums(1.5, 7.2, 0.5)
    monkeypatch.setattr(exact, "LATTICE_EXTENT", 20.0)
    shorter = exact.layer_lattice_sums(1.5, 7.2, 0.5)
    # What lies beyond 20 thicknesses, exp(-14.8), times the number of sites there.
    assert shorter == pytest.approx((total, laplacian), rel=1e-5)
