"""Randomly damaged records, specifications and tables, and how the commands that read them end."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from types import FrameType
from typing import Any
from unittest import mock

from click.testing import CliRunner

import metafem as mf
from metafem import cli
from metafem.errors import NotConverged
from metafem.files import Specification, demo_text

# Limits beyond which a command counts as hanging [s]: of its processor time, which other programs do not
# change, and of the time on the clock, for a command that waits.
LIMIT, WAIT = 5, 60

# Every n-th accepted specification is designed; the others are only read.
DESIGNED = 10

# Every n-th case runs in a separate process.
SEPARATE = 500

# Designs with more sites may need more time than the limit.
FEW_SITES = 100

NESTED: Any = []
for _ in range(300):
    NESTED = [NESTED]

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 3, 1.5, -1.5, 10**25, 10**400, 1e300, -1e300, 1e-300, 5e-324),
    *(float("nan"), float("inf"), "", "text", "two\nlines", "λ\u2028\x85", "1.5 mm", "\ud800", [], {}),
    *([[]], [1, "a"], {"type": "Surface"}, {"type": "Hertz"}, {"float64": [1.0]}, {"int64": [0]}),
    *({"type": "LinearLaw", "slope": 1.0}, NESTED),
)

TOML = (
    *("", '""', '"text"', '"1.5 mm"', '"-1 mm"', '"0 mm"', '"1e300 mm"', '"1e-300 mm"', '"1 parsec"'),
    *('"9e999 mm"', '"1,5 mm"', '"5 µm"', '"1 mm^2"', '"1e60 MPa"', '"5\\n um"', "'''a\nb'''", "nan", "inf"),
    *("-inf", "true", "1979-05-27", "07:32:00", "[]", "{}", "[[8]]", "[8, 8.5]", "[-1, 8]", "[3000, 3000]"),
    *("[1, 1]", "[10000000, 10000000]", "1e308", "-1", "0", "1e-320", "9" * 30, "9" * 5000),
    "0x" + "f" * 5000,
    *('["1 um"]', '["1 um", "2 um"]', '["2 mm^2", "1 mm^2"]', '"automatic"', "a.b.c = 1", "{a = {b = 1}}"),
)

SIGNS = (b"\0", b"\xff\xfe", b'"', b"[[", b"\xce\xbb", b"\r", b"#", b"=")

ENTRIES = (
    *("", "nan", "inf", "1e300", "-1e300", "1e-320", "-5", "0", "1,5", '"', '"1,5"', "é", "#", ";", "\t"),
    *("0x10", "1e999", "9" * 50, "text", "x_mm", "1.2.3", "  ", "\0", "1_000"),
)


# Kinds of faults.
TRACEBACK, HANG = "tracebacks, or warnings of libraries", f"processor time above {LIMIT} s"
CODE, LINES = "exit codes other than 0, 1 and 2", "messages with other than one line per problem"


@dataclass
class Tally:
    """Commands that did not end as they must, by kind of fault, and the number of refused files."""

    faults: dict[str, list[str]] = field(
        default_factory=lambda: {kind: [] for kind in (TRACEBACK, HANG, CODE, LINES)}
    )
    refused: int = 0


class TooLong(BaseException):
    """Raised when a limit is exceeded; no Exception, so that the command cannot catch it."""


@contextmanager
def bounded(seconds: int) -> Iterator[None]:
    """Raise TooLong if the body exceeds a limit of processor time, or WAIT on the clock."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise TooLong

    timers = {signal.SIGPROF: (signal.ITIMER_PROF, seconds), signal.SIGALRM: (signal.ITIMER_REAL, WAIT)}
    before = {number: signal.signal(number, ring) for number in timers}
    for timer, limit in timers.values():
        signal.setitimer(timer, limit)
    try:
        yield
    finally:
        for number, (timer, _) in timers.items():
            signal.setitimer(timer, 0)
            signal.signal(number, before[number])


@contextmanager
def few_designs() -> Iterator[None]:
    """Design only every n-th accepted specification, and none with many sites."""
    original, seen = Specification.design, count(1)

    def design(self: Specification, model: Any = None) -> Any:
        fast = model is None and not self.model.couples and self.tools is None and self.layout is None
        if next(seen) % DESIGNED or self.template.count > FEW_SITES or not fast:
            raise NotConverged("accepted, and not designed")
        return original(self, model)

    with mock.patch.object(Specification, "design", design):
        yield


def damaged_bytes(rng: random.Random, raw: bytes) -> bytes:
    """Flip, cut, repeat or insert bytes."""
    content, start = bytearray(raw), rng.randrange(len(raw))
    match rng.randrange(5):
        case 0:
            content[start] ^= 1 << rng.randrange(8)
        case 1:
            del content[start:]
        case 2:
            del content[start : start + rng.randrange(1, 40)]
        case 3:
            content[start:start] = content[start : start + rng.randrange(1, 200)]
        case _:
            content[start:start] = rng.choice(SIGNS)
    return bytes(content)


def damaged_record(rng: random.Random, raw: bytes) -> bytes:
    """Replace, delete or duplicate a member of a JSON file."""
    record = json.loads(raw)
    members = list(_members(record))
    parent, key = rng.choice(members)
    match rng.randrange(6):
        case 0:
            del parent[key]
        case 1 if isinstance(parent, list):
            parent.append(parent[key])
        case 1:
            parent[f"{key}_"] = parent[key]
        case 2:
            other, name = rng.choice(members)
            parent[key] = json.loads(json.dumps(other[name]))
        case _:
            parent[key] = rng.choice(VALUES)
    return json.dumps(record).encode("utf-8", "surrogatepass")


def _members(record: Any) -> Iterator[tuple[Any, Any]]:
    members = record.items() if isinstance(record, dict) else enumerate(record)
    for key, member in list(members):
        yield record, key
        # members of long lists would be most of the choices
        if isinstance(member, (dict, list)) and len(member) < 50:
            yield from _members(member)


def damaged_lines(rng: random.Random, raw: bytes) -> bytes:
    """Delete, duplicate, exchange or fill lines of a specification."""
    lines = raw.decode().splitlines()
    i = rng.randrange(len(lines))
    match rng.randrange(6):
        case 0:
            del lines[i]
        case 1:
            lines.insert(rng.randrange(len(lines)), lines[i])
        case 2:
            j = rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i]
        case _:
            keyed = [k for k, line in enumerate(lines) if "=" in line and not line.startswith("#")]
            i = rng.choice(keyed)
            lines[i] = f"{lines[i].partition('=')[0]}= {rng.choice(TOML)}"
    return "\n".join(lines).encode()


def damaged_table(rng: random.Random, raw: bytes) -> bytes:
    """Replace entries, rows or the separators of a table."""
    rows = [line.split(",") for line in raw.decode().splitlines()]
    i = rng.randrange(len(rows))
    match rng.randrange(6):
        case 0:
            del rows[i]
        case 1:
            rows.insert(i, rows[rng.randrange(len(rows))])
        case 2:
            del rows[i][rng.randrange(len(rows[i]))]
        case 3:
            sign = rng.choice(";\t|:")
            return "\n".join(sign.join(row) for row in rows).replace(".", rng.choice(".,")).encode()
        case _:
            rows[i][rng.randrange(len(rows[i]))] = rng.choice(ENTRIES)
    return "\n".join(",".join(row) for row in rows).encode()


def cases(folder: Path, number: int, seed: int = 0) -> Iterator[list[str]]:
    """Write one damaged file after another and yield the command that reads it."""
    rng = random.Random(seed)
    template = mf.Surface.square_lattice(0.12, (3, 3), radius=0.526, material=mf.Material(1.36))
    mf.save(mf.design(mf.LinearLaw(7.0), template, limits=mf.Limits(0.12, offset=0.08)), folder / "whole")
    record = (folder / "whole" / "design.json").read_bytes()
    table = (folder / "whole" / "heights.csv").read_bytes()
    specs = [demo_text(name).replace("[8, 8]", "[4, 4]").encode() for name in ("linear", "bilinear")]
    (folder / "damaged").mkdir()
    kinds: tuple[tuple[Callable[[random.Random, bytes], bytes], list[bytes], str, list[str]], ...] = (
        (damaged_record, [record], "damaged/design.json", ["predict", "damaged", "--load", "0.1 N"]),
        (damaged_lines, specs, "spec.toml", ["design", "spec.toml", "-o", "out", "--force"]),
        (damaged_table, [table], "table.csv", ["predict", "table.csv", "--composite-modulus", "1 MPa"]),
    )
    for i in range(number):
        damage, originals, name, command = kinds[i % len(kinds)]
        damage = damaged_bytes if rng.random() < 0.2 else damage
        (folder / name).write_bytes(damage(rng, rng.choice(originals)))
        yield command


def record_faults(tally: Tally, label: str, code: int, output: str, errors: str) -> None:
    """Record the faults in how a command ended."""
    if "Traceback" in errors or "Traceback" in output:
        tally.faults[TRACEBACK].append(f"{label}: {errors[-300:]}")
    if code not in (0, 1, 2):
        tally.faults[CODE].append(f"{label}: {code}")
    if code == 2:
        tally.refused += 1
        name = label.rpartition(" ")[2]
        first, *rest = errors.splitlines() or [""]
        if not first.startswith("Error: ") or any(name not in line for line in rest):
            tally.faults[LINES].append(f"{label}: {errors[:300]}")


def measure(number: int, seed: int = 0) -> Tally:
    """Run the command on a number of damaged files."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as parent, few_designs(), warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning of a library counts like a traceback
        folder, runner = Path(parent), CliRunner()
        for i, command in enumerate(cases(folder, number, seed)):
            arguments = [str(folder / part) if (folder / part).exists() else part for part in command]
            if "-o" in arguments:
                arguments[arguments.index("-o") + 1] = str(folder / "out")
            label = f"{seed}/{i} {Path(arguments[1]).name}"
            if i % SEPARATE == SEPARATE - 1:
                program = [sys.executable, "-m", "metafem", *arguments]
                done = subprocess.run(program, capture_output=True, text=True, check=False)
                record_faults(tally, label, done.returncode, done.stdout, done.stderr)
                continue
            try:
                with bounded(LIMIT):
                    result = runner.invoke(cli.main, arguments)
            except TooLong:
                tally.faults[HANG].append(label)
                continue
            if not isinstance(result.exception, (SystemExit, type(None))):
                tally.faults[TRACEBACK].append(f"{label}: {result.exception!r}")
            record_faults(tally, label, result.exit_code, result.stdout, result.stderr)
    return tally
