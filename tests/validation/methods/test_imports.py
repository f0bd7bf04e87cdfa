"""Second methods share no code with the package that they judge."""

import ast
from pathlib import Path

import pytest

from validation import methods

# Modules that use the package, with the reason.
OF_PACKAGE = {
    "equation_errors": "evaluates the equations of the package's contact laws at a given solution",
    "resolved_areas": "extrapolates boundary elements, another model of the package, to vanishing cells",
}

FILES = [each for each in sorted(Path(methods.__path__[0]).glob("*.py")) if each.stem not in OF_PACKAGE]
STANDARD = {"__future__", "collections", "functools", "itertools", "math", "typing"}

# Of the package: the closed forms, and the names of types.
ALLOWED = ("numpy", "scipy", "validation.methods", "metafem.reference", "metafem._validate")


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
