"""Texts for models."""

import metafem as mf
from metafem.report.names import in_python, model_words


def test_a_model_is_written_as_python_without_defaults():
    assert in_python(mf.Interacting(order=1)) == "Interacting(order=1)"
    assert in_python(mf.Independent(contact=mf.SphericalCap())) == "Independent(contact=SphericalCap())"


def test_a_profile_is_written_by_its_size_or_its_name():
    table = mf.AxisymmetricCap([[0.0, 0.1, 0.2], [0.0, 0.01, 0.04]])
    assert in_python(mf.Independent(contact=table)) == (
        "Independent(contact=AxisymmetricCap(<3 points>, extent=0.2))"
    )

    def bowl(rho):
        return rho**2

    function = mf.AxisymmetricCap(bowl, extent=0.2)
    assert (
        in_python(mf.Independent(contact=function))
        == "Independent(contact=AxisymmetricCap(bowl, extent=0.2))"
    )


def test_a_contact_law_is_named_in_words():
    adhesive = mf.JKR(1.604e-5, mf.SphericalCap())
    assert model_words(mf.Independent(adhesive)) == "independent, JKR, w = 16 mJ/m², spherical caps"
    assert model_words(mf.Interacting(contact=mf.JKR(9e-6))) == "half-space, JKR, w = 9 mJ/m²"
    assert model_words(mf.Independent()) == "independent"
