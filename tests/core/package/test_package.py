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
    """Return what the docstring of a public class or function lacks."""
    text = inspect.getdoc(value)
    summary = text.partition("\n\n")[0]
    lacks = ["a summary of one line"] * ("\n" in summary or not summary.endswith("."))
    plain = inspect.isclass(value) and issubclass(value, Enum | Exception)
    if plain or getattr(value, "_is_protocol", False):
        return lacks
    titles = set(re.findall(r"^(\w+)\n-+$", text, re.MULTILINE))
    lacks += ["an example"] * ("Examples" not in titles or ">>> " not in text)
    signature = inspect.signature(value)
    lacks += ["parameters"] * bool(signature.parameters and not titles & {"Parameters", "Attributes"})
    returns = not inspect.isclass(value) and signature.return_annotation not in ("None", None)
    return lacks + ["what it returns"] * (returns and "Returns" not in titles)


def test_public_names_and_their_members_are_documented():
    names = dict(public())
    assert {"metafem.Design", "metafem.ContactState", "metafem.load", "metafem.fe.press"} <= set(names)
    assert {name: lacks for name, value in names.items() if (lacks := lacking(value))} == {}
    classes = [value for value in names.values() if inspect.isclass(value)]
    members = [getattr(value, name) for value in classes for name in vars(value) if not name.startswith("_")]
    documented = [member for member in members if callable(member) or isinstance(member, property)]
    assert [member for member in documented if not inspect.getdoc(member)] == []


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
    assert {name: count for name, count in counts.items() if count > 25} == {}


# Prints the files of metafem whose functions run in a statement, after all imports that the statement needs.
RUNNING = """
import sys
files = set()
def profile(frame, event, _):
    code, above = frame.f_code, frame
    while above is not None and above.f_code.co_name != "<module>":
        above = above.f_back
    own = above is not None and above.f_globals.get("__name__") == "__main__"
    if event == "call" and own and code.co_filename.startswith(HOME):
        files.add(code.co_filename)
HOME, statement = sys.argv[1:]
import metafem, metafem.cli
sys.setprofile(profile)
try:
    exec(statement)
except SystemExit as ended:
    assert not ended.code, ended.code
sys.setprofile(None)
print(len(files), *sorted(files))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statement", "most"),
    [
        ("metafem.read_spec('linear.toml')", 12),
        ("metafem.cli.main(['calibrate', 'data.csv', '--radius', '526 um'])", 15),
    ],
)
def test_a_command_runs_code_in_few_files(tmp_path, statement, most):
    load = np.linspace(0.02, 0.2, 20)
    area = np.pi * (0.75 * 0.526 * load / 1.36) ** (2 / 3)
    rows = "\n".join(f"{one},{two}" for one, two in zip(load, area, strict=True))
    (tmp_path / "data.csv").write_text(f"load_N,area_mm2\n{rows}\n")
    (tmp_path / "linear.toml").write_text(mf.files.demo_text("linear"))
    command = [sys.executable, "-c", RUNNING, str(HOME), statement]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    count, *files = done.stdout.splitlines()[-1].split()
    assert int(count) <= most, files
    assert int(count) > 5
