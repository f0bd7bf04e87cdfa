"""Every public name has a numpydoc docstring: what it is, its parameters, what it returns, and an example."""

import inspect
import re
from enum import Enum
from importlib import import_module

import pytest

import metafem as mf

MODULES = (
    "metafem",
    "metafem.calibration",
    "metafem.contact",
    "metafem.fe",
    "metafem.progress",
    "metafem.studies",
    "metafem.substrate",
)

PUBLIC = {
    f"{module}.{name}": value
    for module in MODULES
    for name in import_module(module).__all__
    if not inspect.ismodule(value := getattr(import_module(module), name))
}


def sections(value):
    """Return the section titles of a docstring."""
    return re.findall(r"^(\w+)\n-+$", inspect.getdoc(value), re.MULTILINE)


def needed(value):
    """Return the sections that a docstring must have, each as a set of titles of which one is enough."""
    if inspect.isclass(value) and (
        issubclass(value, (Enum, Exception)) or getattr(value, "_is_protocol", False)
    ):
        return []
    signature = inspect.signature(value)
    titles = [{"Examples"}]
    if signature.parameters:
        titles.append({"Parameters", "Attributes"} if inspect.isclass(value) else {"Parameters"})
    if not inspect.isclass(value) and signature.return_annotation not in ("None", None):
        titles.append({"Returns"})
    return titles


@pytest.mark.parametrize("value", PUBLIC.values(), ids=PUBLIC)
def test_public_names_are_documented(value):
    text = inspect.getdoc(value)
    summary = text.partition("\n\n")[0]
    assert "\n" not in summary
    assert summary.endswith(".")
    found = set(sections(value))
    assert [titles for titles in needed(value) if not titles & found] == []
    assert "Examples" not in found or ">>> " in text


@pytest.mark.parametrize(
    ("owner", "name"),
    [
        (value, name)
        for value in PUBLIC.values()
        if inspect.isclass(value)
        for name, member in vars(value).items()
        if not name.startswith("_") and (callable(member) or isinstance(member, (property, classmethod)))
    ],
)
def test_public_members_are_documented(owner, name):
    assert inspect.getdoc(getattr(owner, name)).partition("\n\n")[0].strip()


def test_the_names_of_the_package_are_among_them():
    assert {"metafem.Design", "metafem.ContactState", "metafem.load", "metafem.fe.press"} <= set(PUBLIC)
    assert mf.design in PUBLIC.values()
