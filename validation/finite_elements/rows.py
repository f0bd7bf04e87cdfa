"""Checks of `metafem.studies` as rows, with the kinds of their sources."""

from __future__ import annotations

from collections.abc import Sequence

from metafem import fe, studies
from metafem.reference import bonded_layer, single_contacts
from metafem.studies import element_checks as elements
from validation.check import Check
from validation.sources import closed_form, known_input, second_method

SOURCES = {
    elements.HERTZ: closed_form(single_contacts.hertz, elements.HERTZ),
    elements.SNEDDON: closed_form(single_contacts.power_law, elements.SNEDDON),
    elements.SPHERE: closed_form(single_contacts.sneddon_sphere, elements.SPHERE),
    elements.HANKEL: closed_form(bonded_layer.influence, elements.HANKEL),
    elements.CURVATURE: closed_form(bonded_layer.lattice_sums, elements.CURVATURE),
    elements.LATTICE: closed_form(bonded_layer.lattice_sums, elements.LATTICE),
    elements.DINI: closed_form(bonded_layer.cell_influence, "Dini series of a cylinder on a rigid base"),
    elements.SEARCHED: second_method(fe.search_contact, "active set of quadratic elements on its own mesh"),
    elements.DEGREES: second_method(fe.press, "the same with elements of a lower degree"),
    elements.BRACKET: second_method(fe.press, "bracket between two criteria for the edge of the contact"),
    elements.EXPONENTIAL: known_input("theory: the error falls by a constant factor with each degree"),
    elements.FIRST_ORDER: known_input("theory: order 1, as the edge of the contact is known to one cell"),
    elements.BRACKET_ORDER: known_input("theory: order 1, as the bracket spans one element at the edge"),
}


def as_rows(checks: Sequence[studies.Check]) -> list[Check]:
    """Return checks of the finite elements as rows of a claim."""
    return [
        Check(each.name, each.computed, each.expected, each.passed, SOURCES[each.source]) for each in checks
    ]
