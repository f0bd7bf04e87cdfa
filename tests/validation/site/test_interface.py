"""Every public name has a place, and a class shows what its users need."""

import importlib
import inspect

import metafem as mf
from tests.test_docstrings import MODULES
from validation.site.interface import Entry, inherited, members, pages


def test_every_public_name_has_a_place():
    shown = {id(entry.value) for page in pages().values() for entry in page.entries}
    for module in map(importlib.import_module, MODULES):
        for name in module.__all__:
            value = getattr(module, name)
            assert inspect.ismodule(value) or id(value) in shown, f"{module.__name__}.{name}"


def test_members_are_those_for_users():
    names = [member.name for member in members(mf.LinearLaw)]
    assert "from_friction_coefficient" in names
    assert not {"candidate", "refuse", "guesses"} & set(names)  # they take internal types
    assert {"fit", "plot", "to_dataframe"} <= {member.name for member in members(mf.FrictionLaw)}
    assert "indentation" in inherited(mf.Hertz)["Contact"]
    assert members(mf.DesignStatus) == []
    assert Entry("Status", mf.Status).constants
