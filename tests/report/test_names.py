"""Texts for models."""

import metafem as mf
from metafem.report.names import in_python


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
