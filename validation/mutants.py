"""Changes of metafem that tests must notice: listed ones, and ones drawn at random."""

from __future__ import annotations

import ast
import random
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

LIST = Path(__file__).with_name("mutants.toml")

# The opposite of each comparison, and the name of each kind of a random mutant.
OPPOSITE = {
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
KINDS = ("constant", "sign", "comparison", "index", "returned")


@dataclass(frozen=True)
class Mutant:
    """A file with one change in a function, or outside of all: `function` is then the module's name."""

    name: str
    function: str
    file: str
    text: str
    claims: Sequence[str] = ()


def listed(root: Path) -> dict[str, Mutant]:
    """Return the mutants of the list by name; the text of each must occur once in its function."""
    found = {}
    for name, row in tomllib.loads(LIST.read_text("utf-8")).items():
        file = _file(root, row["function"])
        text = (root / file).read_text("utf-8")
        lines = text.splitlines(keepends=True)
        changed = [
            "".join([*lines[:begin], part.replace(row["old"], row["new"]), *lines[end:]])
            for begin, end in _spans(text, file, row["function"])
            if (part := "".join(lines[begin:end])).count(row["old"]) == 1
        ]
        if len(changed) != 1:
            raise ValueError(f"{name}: {row['function']} does not hold {row['old']!r} once")
        found[name] = Mutant(name, row["function"], file, *changed, row.get("claims", ()))
    return found


def _file(root: Path, function: str) -> str:
    """Return the file of a function, class or module, or a script itself."""
    if function.endswith(".js"):
        return function
    parts = function.split(".")
    for count in range(len(parts), 0, -1):
        for path in (Path(*parts[:count]).with_suffix(".py"), Path(*parts[:count], "__init__.py")):
            if (root / path).is_file():
                return str(path)
    raise ValueError(f"{function!r} is no function of metafem")


def module_of(file: str) -> str:
    """Return the name of the module in a file."""
    return file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def _spans(text: str, file: str, function: str) -> Iterator[tuple[int, int]]:
    """Yield first and last line of what has a qualified name, such as a property and its setter."""
    if function == file or function == module_of(file):
        yield 0, len(text.splitlines())
        return
    names = function.removeprefix(module_of(file) + ".").split(".")
    nodes: list[ast.AST] = [ast.parse(text)]
    for name in names:
        nodes = [
            child
            for node in nodes
            for child in ast.iter_child_nodes(node)
            if getattr(child, "name", "") == name
        ]
    yield from ((node.lineno - 1, node.end_lineno) for node in nodes)


def drawn(root: Path, count: int, seed: int) -> list[Mutant]:
    """Return random mutants of functions of metafem, as many of each kind."""
    rng = random.Random(seed)
    places: dict[str, list[tuple[Path, str, ast.expr, ast.expr]]] = {kind: [] for kind in KINDS}
    for path in sorted((root / "metafem").rglob("*.py")):
        module = module_of(str(path.relative_to(root)))
        for function, node in _functions(ast.parse(path.read_text("utf-8")), module):
            for kind, old, new in _changes(node, rng):
                places[kind].append((path, function, old, new))
    found = []
    for k in range(count):
        path, function, old, new = rng.choice(places[KINDS[k % len(KINDS)]])
        text = path.read_text("utf-8")
        segment = ast.get_source_segment(text, old) or ""
        name = f"{function}, line {old.lineno}: {segment} -> {ast.unparse(new)}"
        found.append(Mutant(name, function, str(path.relative_to(root)), _replaced(text, old, new)))
    return found


def _functions(node: ast.AST, path: str) -> Iterator[tuple[str, ast.AST]]:
    """Yield the functions of a module, not those inside of functions, with their qualified names."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            yield f"{path}.{child.name}", child
        elif isinstance(child, ast.ClassDef):
            yield from _functions(child, f"{path}.{child.name}")


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what a function evaluates, without decorators, types, messages and texts."""
    for name, value in ast.iter_fields(node):
        if name in ("decorator_list", "annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, ast.Raise | ast.JoinedStr):
                yield child
                yield from _statements(child)


def _changes(function: ast.AST, rng: random.Random) -> Iterator[tuple[str, ast.expr, ast.expr]]:
    """Yield the kind, the old and the new expression of each change of a function."""
    inside = list(_statements(function))
    local = sorted({n.id for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)})
    indices = {
        id(n)
        for each in inside
        if isinstance(each, ast.Subscript)
        for n in ast.walk(each.slice)
        if isinstance(n, ast.Constant)
    }
    for node in inside:
        match node:
            case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
                further = node.value + 1 if isinstance(node.value, int) else 1.1 * node.value or 0.1
                yield "index" if id(node) in indices else "constant", node, ast.Constant(further)
            case ast.BinOp(left, ast.Add(), right):
                yield "sign", node, ast.BinOp(left, ast.Sub(), right)
            case ast.BinOp(left, ast.Sub(), right):
                yield "sign", node, ast.BinOp(left, ast.Add(), right)
            case ast.UnaryOp(ast.USub(), operand) if id(operand) not in indices:
                yield "sign", node, operand
            case ast.Compare(left, [comparison], right):
                yield "comparison", node, ast.Compare(left, [OPPOSITE[type(comparison)]()], right)
            case ast.Return(ast.Name(name)) if others := [each for each in local if each != name]:
                yield "returned", node.value, ast.Name(rng.choice(others))
            case ast.Return(ast.Tuple([first, second, *rest])):
                yield "returned", node.value, ast.Tuple([second, first, *rest], ast.Load())


def _replaced(text: str, old: ast.expr, new: ast.expr) -> str:
    """Return a text with another expression in the place of one; columns count bytes."""
    data = text.encode()
    starts = [0]
    for line in data.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    begin = starts[old.lineno - 1] + old.col_offset
    end = starts[(old.end_lineno or old.lineno) - 1] + (old.end_col_offset or 0)
    return (data[:begin] + f"({ast.unparse(new)})".encode() + data[end:]).decode()
