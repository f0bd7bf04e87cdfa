"""pytest plugin: write which functions of metafem each test enters, and its processor time.

`pytest -p validation.entered` writes a file for each process into the folder `$ENTERED`. Compiled functions
cannot be followed.
"""

from __future__ import annotations

import ast
import builtins
import json
import os
import sys
from collections import defaultdict
from collections.abc import Iterable
from importlib.abc import MetaPathFinder
from importlib.machinery import PathFinder, SourceFileLoader
from pathlib import Path

import pytest

# Environment variable that names the folder, and the function that each function of metafem calls first.
FOLDER, CALL = "ENTERED", "__entered__"

# The tests that enter each function, by their node IDs, with their processor times [s].
Entered = dict[str, list[tuple[float, str]]]

now: set[str] = set()
by_fixture: dict[str, set[str]] = defaultdict(set)
numbers: dict[str, int] = {}


class _Marker(ast.NodeTransformer):
    """Let each function state its qualified name when it is entered."""

    def __init__(self, module: str) -> None:
        self.path = [module]

    def visit_ClassDef(self, node):
        self.path.append(node.name)
        self.generic_visit(node)
        self.path.pop()
        return node

    def visit_FunctionDef(self, node):
        self.visit_ClassDef(node)
        first = int(ast.get_docstring(node) is not None)
        call = ast.parse(f"{CALL}({'.'.join([*self.path, node.name])!r})").body[0]
        for each in ast.walk(call):
            ast.copy_location(each, node.body[min(first, len(node.body) - 1)])
        node.body.insert(first, call)
        return node

    visit_AsyncFunctionDef = visit_FunctionDef  # noqa: N815


class _Loader(SourceFileLoader):
    """Compile a module with marked functions."""

    def get_code(self, fullname):
        """Return the code, never from a cache."""
        path = self.get_filename(fullname)
        tree = _Marker(fullname).visit(ast.parse(self.get_data(path)))
        return compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)


class _Finder(MetaPathFinder):
    """Find the modules of metafem, except compiled ones."""

    def find_spec(self, fullname, path=None, target=None):
        """Return the specification of a module with another loader."""
        if fullname.partition(".")[0] != "metafem" or fullname.startswith("metafem._kernels"):
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


def read(folder: Path) -> Entered:
    """Return the tests that enter each function, those that take least time first."""
    found: Entered = defaultdict(list)
    for file in sorted(folder.glob("entered-*.jsonl")):
        names = {}
        for row in map(json.loads, file.read_text("utf-8").splitlines()):
            if "name" in row:
                names[row["number"]] = row["name"]
            else:
                for number in row["entered"]:
                    found[names[number]].append((row["seconds"], row["test"]))
    return {name: sorted(tests) for name, tests in found.items()}


if FOLDER in os.environ:
    setattr(builtins, CALL, now.add)
    sys.meta_path.insert(0, _Finder())
    output = Path(os.environ[FOLDER], f"entered-{os.getpid()}.jsonl")

    def _write(row: dict) -> None:
        with output.open("a", encoding="utf-8") as file:
            print(json.dumps(row), file=file)

    def _number(name: str) -> int:
        if name not in numbers:
            numbers[name] = len(numbers)
            _write({"number": numbers[name], "name": name})
        return numbers[name]

    def _numbers(names: Iterable[str]) -> list[int]:
        return sorted(map(_number, names))

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(fixturedef, request):
        """Give what a shared fixture enters to every test that uses it."""
        if fixturedef.scope == "function":
            return (yield)
        before = set(now)
        now.clear()
        try:
            return (yield)
        finally:
            by_fixture[fixturedef.argname].update(now)
            now.update(before)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(item, nextitem):
        """Write a line for each test."""
        now.clear()
        start = sum(os.times()[:4])
        try:
            return (yield)
        finally:
            shared = (by_fixture[name] for name in getattr(item, "fixturenames", ()))
            entered = _numbers(now.union(*shared))
            _write({"test": item.nodeid, "seconds": sum(os.times()[:4]) - start, "entered": entered})
