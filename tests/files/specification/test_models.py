"""Models by name, with a contact law."""

from dataclasses import dataclass

import pytest

import metafem as mf
from metafem.models.model import with_contact


def test_a_model_that_cannot_use_a_law_is_named():
    @dataclass(frozen=True)
    class Own:
        name = "own"

    with pytest.raises(
        mf.InvalidInput, match=r"own: the contacts of this model are paraboloids, not Spherical"
    ):
        with_contact(Own(), mf.SphericalCap())
    assert with_contact(Own(), mf.Hertz()) == Own()


def test_a_law_without_a_profile_couples_by_order_1():
    law = mf.KogutEtsion(10.0)
    assert with_contact(mf.Interacting(), law) == mf.Interacting(order=1, contact=law)
    assert with_contact(mf.Interacting(order=1), mf.PowerCap(4)).order == 1
    assert with_contact(mf.Interacting(), mf.PowerCap(4)).order == 3
