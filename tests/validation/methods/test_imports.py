"""Second methods share no code with the package that they judge, or are named self-consistency."""

import ast
from pathlib import Path

import pytest

import validation
from validation import methods

# Modules that use the package, with the reason; checks name them as sources of self-consistency.
OF_PACKAGE = {
    "equation_errors": "evaluates the equations of the package's contact laws at a given solution",
    "resolved_areas": "extrapolates boundary elements, another model of the package, to vanishing cells",
}

FILES = [each for each in sorted(Path(methods.__path__[0]).glob("*.py")) if each.stem not in OF_PACKAGE]
STANDARD = {"__future__", "collections", "functools", "itertools", "math", "typing"}

# Of the package: the closed forms alone, which no solver imports.
ALLOWED = ("numpy", "scipy", "validation.methods", "metafem.reference")


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_second_methods_import_numpy_scipy_and_closed_forms_alone(file):
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = [each.name for each in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module]
        else:
            continue
        for name in names:
            inside = any(name == each or name.startswith(f"{each}.") for each in ALLOWED)
            assert inside or name.split(".")[0] in STANDARD, name


def test_methods_that_use_the_package_are_no_second_methods():
    used = 0
    for file in Path(validation.__path__[0]).rglob("*.py"):
        tree = ast.parse(file.read_text("utf-8"))
        names = {
            alias.asname or alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").rpartition(".")[2] in OF_PACKAGE
            for alias in node.names
        }
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args:
                first = node.args[0]
                if isinstance(first, ast.Name) and first.id in names:
                    assert node.func.id != "second_method", file
                    used += node.func.id == "self_consistency"
    assert used == 3
