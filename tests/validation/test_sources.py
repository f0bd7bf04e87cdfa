"""Sources name what computed an expected number, and refuse what is none."""

import pytest

import metafem as mf
from metafem.reference import single_contacts
from validation.methods import independent
from validation.sources import Kind, closed_form, printed, publication, second_method


@pytest.mark.parametrize(
    ("method", "name"),
    [
        (mf.BoundaryElements, "metafem.BoundaryElements"),
        (mf.fe.Block3D, "metafem.fe.Block3D"),
        (independent.areas, "validation.methods.independent.areas"),
    ],
)
def test_a_second_method_has_its_public_name(method, name):
    assert second_method(method, "cells").text == f"cells, {name}"


def test_a_method_of_metafem_is_self_consistency():
    assert second_method(mf.BoundaryElements, "cells").kind is Kind.SELF_CONSISTENCY
    assert second_method(independent.areas, "sums").kind is Kind.SECOND_METHOD


def test_a_printed_number_is_counted_under_its_quantity():
    assert (printed("Table S2", "heights, red", 64).numbers, printed("Table S2").numbers) == (64, 0)


def test_a_closed_form_is_a_function_of_the_reference():
    assert (
        closed_form(single_contacts.hertz, "Hertz").text == "Hertz, metafem.reference.single_contacts.hertz"
    )
    with pytest.raises(ValueError, match=r"independent\.areas must be a function of metafem\.reference"):
        closed_form(independent.areas, "sums")


def test_places_and_addresses_are_those_of_a_publication():
    assert printed("Fig. 3 caption").link.endswith("science.adk4234")
    with pytest.raises(ValueError, match="must begin with"):
        printed("somewhere")
    with pytest.raises(ValueError, match="must be a DOI"):
        publication("arXiv:2604.08195", "abstract")
