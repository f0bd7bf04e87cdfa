"""Each example runs, prints, asserts a number, draws a figure, and uses public names alone."""

import ast
import re
from functools import reduce

import pytest
from matplotlib.figure import Figure

import metafem as mf
from validation.site.scripts import run, scripts

SCRIPTS = scripts()

# Those that take longer than about half a second with compiled kernels.
SLOW = ("e07_interaction", "e08_finite_elements", "e09_tolerances", "e10_robust_design")

# Lines of a script, and words of its docstring.
SHORTEST, LONGEST, MOST_WORDS = 20, 45, 80


MARKED = [
    pytest.param(script, id=script.name, marks=[pytest.mark.slow] if script.name in SLOW else [])
    for script in SCRIPTS
]


def public_names(code):
    """Return the dotted names that begin with ``mf.``, each as a list of the names behind it."""
    found = []
    for node in ast.walk(ast.parse(code)):
        names = []
        while isinstance(node, ast.Attribute):
            names.append(node.attr)
            node = node.value
        if names and isinstance(node, ast.Name) and node.id == "mf":
            found.append(names[::-1])
    return found


@pytest.mark.parametrize("script", MARKED)
def test_scripts_run(script):
    found = run(script)
    assert found.output.count("\n") >= 2
    assert isinstance(found.figure, Figure)
    assert found.figure.axes[0].get_xlabel()


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_scripts_are_short_and_say_what_one_learns(script):
    lines = script.source.splitlines()
    assert SHORTEST <= len(lines) <= LONGEST
    assert script.docstring.partition("\n")[0].endswith(".")
    assert "\n\n" not in script.text
    assert len(script.text.split()) <= MOST_WORDS
    assert script.lesson.endswith(".")
    assert re.search(r"^ *assert ", script.code, re.MULTILINE)
    assert script.caption.endswith(".")


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_scripts_use_public_names_alone(script):
    imports = [
        node for node in ast.walk(ast.parse(script.source)) if isinstance(node, (ast.Import, ast.ImportFrom))
    ]
    modules = {node.module if isinstance(node, ast.ImportFrom) else node.names[0].name for node in imports}
    assert {module for module in modules if module.startswith("metafem")} == {"metafem"}
    assert not any(isinstance(node, ast.ImportFrom) and node.module.startswith("metafem") for node in imports)
    names = public_names(script.source)
    assert names
    for path in names:
        assert not any(name.startswith("_") for name in path)
        assert path[0] in mf.__all__
        reduce(getattr, path, mf)


def test_numbers_are_in_order():
    assert [script.name[:4] for script in SCRIPTS] == [f"e{i:02}_" for i in range(1, len(SCRIPTS) + 1)]
