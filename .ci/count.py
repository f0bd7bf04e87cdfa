"""Print what a reader has to read, and exit 1 if it is above `.ci/bounds`.

Lines and tokens of Python are those of code, without blanks, comments and docstrings. Others count whole.
With `--write` the bounds become what is measured and 2 % more.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
import tomllib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
BOUNDS = ROOT / ".ci" / "bounds"
MARGIN = 1.02

NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}

# What a file counts as: the first pattern that its path holds.
PARTS = {
    "metafem": r"^metafem/.*\.py$",
    "javascript": r"^metafem/.*\.js$",
    "text": r"^metafem/.*\.(pyi|css|html|toml|json|svg|md|txt)$",
    "tests": r"^tests/.*\.py$",
    "validation": r"^validation/(?!results/).*\.(py|js|html|css)$",
    "others": r"^(meshes|\.ci)/.*\.py$",
}


def python(text: str) -> tuple[int, int]:
    """Return the lines and the tokens of code."""
    strings = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    tokens = [
        each for each in tokenize.generate_tokens(io.StringIO(text).readline) if each.type not in NO_CODE
    ]
    lines = {line for each in tokens for line in range(each.start[0], each.end[0] + 1)}
    return len(lines - strings), sum(each.start[0] not in strings for each in tokens)


def measured() -> dict[str, dict[str, int]]:
    """Return lines, tokens, files and classes of each part."""
    counts = {kind: Counter() for kind in ("lines", "tokens", "files", "classes")}
    for path in sorted(path for path in ROOT.rglob("*") if path.is_file()):
        name = str(path.relative_to(ROOT))
        part = next((part for part, pattern in PARTS.items() if re.search(pattern, name)), None)
        if part is None:
            continue
        text = path.read_text("utf-8")
        if path.suffix == ".py":
            lines, tokens = python(text)
        else:
            lines, tokens = len(text.splitlines()), len(re.findall(r"\w+|[^\w\s]", text))
        counts["lines"][part] += lines
        counts["tokens"][part] += tokens
        if part == "metafem":
            counts["files"][part] += 1
            counts["classes"][part] += sum(
                isinstance(node, ast.ClassDef) for node in ast.walk(ast.parse(text))
            )
    return {kind: dict(count) for kind, count in counts.items()}


def main() -> int:
    """Compare what is measured with the bounds."""
    bounds, found = tomllib.loads(BOUNDS.read_text("utf-8")), measured()
    if "--write" in sys.argv:
        text = BOUNDS.read_text("utf-8")
        text = text[: text.index("[lines]")]
        for kind, parts in found.items():
            text += (
                f"[{kind}]\n" + "".join(f"{part} = {int(MARGIN * n)}\n" for part, n in parts.items()) + "\n"
            )
        BOUNDS.write_text(text.rstrip() + "\n", "utf-8")
        return 0
    above = 0
    for kind, parts in found.items():
        for part, number in parts.items():
            bound = bounds[kind][part]
            above += number > bound
            print(f"{kind} of {part}: {number} of {bound}{' ABOVE ITS BOUND' if number > bound else ''}")
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
