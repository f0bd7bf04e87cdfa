"""Second methods share no code with the package that they judge."""

import ast
from pathlib import Path

import pytest

from validation import methods

FILES = sorted(Path(methods.__path__[0]).glob("*.py"))
ALLOWED = {"__future__", "collections", "functools", "itertools", "math", "numpy", "scipy"}


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_second_methods_import_numpy_and_scipy_alone(file):
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = [each.name for each in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module]
        else:
            continue
        for name in names:
            assert name.split(".")[0] in ALLOWED or name.startswith("validation.methods."), name
