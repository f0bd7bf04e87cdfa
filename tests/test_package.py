"""The package as a whole: names, imports, versions."""

import subprocess
import sys
import tomllib
from importlib.machinery import PathFinder
from importlib.metadata import version
from pathlib import Path

import grimp
import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

import metafem as mf

HOME = Path(mf.__file__).parent


@pytest.mark.parametrize("name", mf.__all__)
def test_every_public_name_resolves_and_has_a_docstring(name):
    assert getattr(mf, name).__doc__


def test_only_public_names_are_listed():
    assert dir(mf) == sorted(mf.__all__)
    assert {"files", "report", "studies", "fe", "DesignStatus"} <= set(dir(mf))
    assert not {"annotations", "import_module", "lazy_loader", "Any", "_HOME"} & set(dir(mf))


def test_the_version_is_that_of_the_installation():
    assert mf.__version__ == version("metafem")


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="metafem attribute nothing"):
        _ = mf.nothing


def test_a_folder_left_by_another_installation_does_not_shadow_the_package(tmp_path):
    (tmp_path / "metafem" / "_kernels" / "__pycache__").mkdir(parents=True)
    found = PathFinder.find_spec("metafem", [str(tmp_path), str(HOME.parent)])
    assert found.origin == mf.__file__
    # which holds for an entry of the path, not for the finder of an editable installation
    setup = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["tool"]
    assert setup["setuptools"]["package-dir"] == {"": "."}
    assert "pythonpath" not in setup["pytest"]["ini_options"]


def test_importing_the_package_loads_nothing_heavy():
    heavy = "{'numpy', 'numba', 'scipy', 'matplotlib', 'pydantic', 'pint', 'skfem', 'platformdirs'}"
    code = f"import metafem.cli, sys; print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_no_module_imports_itself_through_others():
    """Imports within functions count, those for type checking alone do not."""
    graph = grimp.build_graph("metafem", exclude_type_checking_imports=True, cache_dir=None)
    modules = sorted(graph.modules)
    imports = np.array([np.isin(modules, list(graph.find_modules_directly_imported_by(m))) for m in modules])
    _, circle = connected_components(imports, connection="strong")
    sizes = np.bincount(circle)
    assert [m for m, i in zip(modules, circle, strict=True) if sizes[i] > 1] == []
    assert len(modules) > 150  # the whole package was read


def test_folders_hold_at_most_14_modules():
    folders = [HOME, *(folder for folder in HOME.rglob("*") if folder.is_dir())]
    counts = {folder.relative_to(HOME).as_posix(): len(list(folder.glob("*.py"))) for folder in folders}
    assert {name: count for name, count in counts.items() if count > 14} == {}
