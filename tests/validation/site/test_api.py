"""Names are linked in the forms in which texts mention them, and signatures are those of the source."""

from importlib.util import find_spec

import pytest

import metafem as mf
from metafem import _extras
from validation.site import write_api
from validation.site.api import address_on, call
from validation.site.interface import addresses, pages


def test_names_are_found_in_the_forms_in_which_texts_mention_them():
    for name in ("Surface", "mf.Surface", "metafem.Surface", "mf.fe.press", "metafem.studies.manufacturing"):
        assert addresses()[name].endswith(f"#{name.rpartition('.')[2]}")
    assert addresses()["Surface.tilted"] == "metafem.html#Surface.tilted"
    assert addresses()["mf.studies"] == "metafem.studies.html"
    # an argument of the same name is no link
    address = address_on(pages()["metafem"])
    assert address("design") is address("contact") is address("load") is None
    assert address("arrange") == "metafem.html#arrange"
    assert address("mf.design") == "metafem.html#design"
    assert address_on(pages()["metafem.studies"])("Check") == "metafem.studies.html#Check"


def test_calls_are_those_of_the_source():
    assert call(mf.Material, lambda name: None) == "(composite_modulus: float, poisson_ratio: float = 0.5)"
    text = call(mf.equilibrium, lambda name: f"#{name}")
    assert 'surface: <a href="#Surface">Surface</a>' in text
    assert "\n    *,\n" in text
    assert text.endswith('→ <a href="#ContactState">ContactState</a>')
    assert "Interacting" in addresses()
    assert call(mf.BoundaryElements, lambda name: None).endswith(
        "substrate: Radial = HalfSpace(), contact: Contact = Hertz())"
    )


def test_the_extra_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setattr(_extras, "find_spec", lambda name: None if name == "pdoc" else find_spec(name))
    with pytest.raises(mf.InvalidInput, match=r"needs the extra docs: pip install 'metafem\[docs\]'"):
        write_api(tmp_path)
