"""The package as a whole: names, docstrings, imports, versions."""

import inspect
import re
import subprocess
import sys
from enum import Enum
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import grimp
import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

import metafem as mf

HOME = Path(mf.__file__).parent
FOLDERS = ("", ".calibration", ".contact", ".fe", ".progress", ".studies", ".substrate")


def public():
    """Yield the name and the value of every public class and function."""
    for folder in FOLDERS:
        module = import_module(f"metafem{folder}")
        for name in module.__all__:
            if not inspect.ismodule(value := getattr(module, name)):
                yield f"metafem{folder}.{name}", value


def lacking(value):
    """Return what the docstring of a public name lacks."""
    text = inspect.getdoc(value)
    summary = text.partition("\n\n")[0]
    found = set(re.findall(r"^(\w+)\n-+$", text, re.MULTILINE))
    wanted = []
    plain = inspect.isclass(value)
    if not plain or not (issubclass(value, Enum | Exception) or getattr(value, "_is_protocol", False)):
        signature = inspect.signature(value)
        wanted.append({"Examples"})
        if signature.parameters:
            wanted.append({"Parameters", "Attributes"} if plain else {"Parameters"})
        if not plain and signature.return_annotation not in ("None", None):
            wanted.append({"Returns"})
    lacks = [titles for titles in wanted if not titles & found]
    lacks += ["a summary of one line"] * ("\n" in summary or not summary.endswith("."))
    return lacks + ["code in the example"] * ("Examples" in found and ">>> " not in text)


def test_public_names_and_their_members_are_documented():
    names = dict(public())
    assert {"metafem.Design", "metafem.ContactState", "metafem.load", "metafem.fe.press"} <= set(names)
    assert {name: lacks for name, value in names.items() if (lacks := lacking(value))} == {}
    members = [
        (name, member)
        for name, value in names.items()
        if inspect.isclass(value)
        for member, given in vars(value).items()
        if not member.startswith("_") and (callable(given) or isinstance(given, property | classmethod))
    ]
    assert [pair for pair in members if not inspect.getdoc(getattr(names[pair[0]], pair[1]))] == []


def test_names_are_listed_and_resolve():
    assert dir(mf) == sorted(mf.__all__)
    assert all(getattr(mf, name).__doc__ for name in mf.__all__)
    assert mf.__version__ == version("metafem")
    with pytest.raises(AttributeError, match="nothing"):
        _ = mf.nothing


def test_importing_the_package_loads_nothing_heavy():
    heavy = "{'numpy', 'numba', 'scipy', 'matplotlib', 'pydantic', 'pint', 'skfem', 'platformdirs'}"
    code = f"import metafem.cli, sys; print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_no_module_imports_itself_through_others_and_folders_are_small():
    """Imports within functions count, those for type checking alone do not."""
    graph = grimp.build_graph("metafem", exclude_type_checking_imports=True, cache_dir=None)
    modules = sorted(graph.modules)
    imports = np.array([np.isin(modules, list(graph.find_modules_directly_imported_by(m))) for m in modules])
    _, circle = connected_components(imports, connection="strong")
    sizes = np.bincount(circle)
    assert [m for m, i in zip(modules, circle, strict=True) if sizes[i] > 1] == []
    assert len(modules) > 150  # the whole package was read
    folders = [HOME, *(folder for folder in HOME.rglob("*") if folder.is_dir())]
    counts = {folder.relative_to(HOME).as_posix(): len(list(folder.glob("*.py"))) for folder in folders}
    assert {name: count for name, count in counts.items() if count > 14} == {}
