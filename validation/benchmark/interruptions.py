"""Runs stopped at random moments and pairs of runs with one goal: is any file lost, or anything left?

`python -m validation.benchmark.interruptions` takes about ten minutes. Each run is a whole `metafem design`
in a process of its own, half of them with --force into a result folder in which somebody keeps notes. The
processes are forked from one that has read all modules, so that signals meet the work. Afterwards a folder
must hold all files of one design, to the bit, and the notes; and after the next run in its parent nothing
else.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from pathlib import Path

import metafem as mf
from metafem.cli.signals import stopped_by_signals
from metafem.files import demo_text
from validation.benchmark.timing import Row

KILLS, PAIRS = 200, 50
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
CONTEXT = multiprocessing.get_context("forkserver")
# What a command reads first: without these signals would mostly meet imports.
LOADED = (
    "metafem.files.specification.sections",
    "metafem.report.page",
    "metafem.drawing",
    "matplotlib.figure",
    "pint",
)
LOADED += ("meshio", "rich.console", "rich.table", "scipy.optimize", "numba")
NOTES = {"notes.txt": "mine", "photos/first.txt": "mine, too"}
# A quarter of the demo's asperities reaches a quarter of its areas.
CHEAP = {
    "[8, 8]": "[4, 4]",
    '"0.144 mm^2", "0.336 mm^2", "0.649 mm^2"': '"0.036 mm^2", "0.084 mm^2", "0.162 mm^2"',
    '"0.84 mm^2", "1.68 mm^2", "4.12 mm^2"': '"0.21 mm^2", "0.42 mm^2", "1.03 mm^2"',
}
HIDDEN = "metafem-writing"


@dataclass(frozen=True)
class Scene:
    """Three designs, each the content of its folder, and the seconds that one takes."""

    specifications: dict[str, str]
    folder: Path
    seconds: float

    def content(self, name: str) -> dict[str, str]:
        """Hashes of the files of one design by their names."""
        return hashes(self.folder / name)


@dataclass
class Broken:
    """How often each promise was broken, and how often it was put to the test."""

    trials: Counter[str] = field(default_factory=Counter)
    failures: Counter[str] = field(default_factory=Counter)
    first: dict[str, str] = field(default_factory=dict)
    counts: Counter[str] = field(default_factory=Counter)

    def expect(self, promise: str, kept: bool, detail: object = "") -> None:
        """Count one trial of a promise."""
        self.trials[promise] += 1
        if not kept:
            self.failures[promise] += 1
            self.first.setdefault(promise, str(detail))

    def rows(self) -> list[Row]:
        """Wanted, which is never, and measured."""
        return [Row(what, 0.0, float(self.failures[what]), f"of {n}") for what, n in self.trials.items()]


def hashes(folder: Path) -> dict[str, str]:
    """Hashes of all files below a folder by their paths; empty if there is none."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def leftovers(folder: Path) -> list[str]:
    """Working folders below a folder."""
    return [str(path.relative_to(folder)) for path in folder.rglob(f"*{HIDDEN}")]


@contextmanager
def scene() -> Iterator[Scene]:
    """Design three cheap surfaces to compare with."""
    text = demo_text("operating-points")
    for before, after in CHEAP.items():
        text = text.replace(before, after)
    texts = {name: text.replace("seed = 0", f"seed = {seed}") for seed, name in enumerate(("old", "a", "b"))}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "parent"
        folder.mkdir()
        for each, content in texts.items():
            (folder / f"{each}.toml").write_text(content, encoding="utf-8")
            start = time.perf_counter()
            started(design(each, force=False), folder).join()
            seconds = time.perf_counter() - start
            mf.load(folder / each)
        yield Scene(texts, folder, seconds)


def command(arguments: list[str], folder: Path, log: str) -> None:
    """Run the metafem command in a folder; what it prints goes to a file beside."""
    from metafem.cli import main

    os.chdir(folder)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it in the background
    with stopped_by_signals():  # from when the file is there: it tells that the command begins
        handle = os.open(folder.with_name(f"{folder.name}-{log}.log"), os.O_WRONLY | os.O_CREAT)
        os.dup2(handle, 1)
        os.dup2(handle, 2)
        main(arguments, prog_name="metafem")


def started(arguments: list[str], folder: Path, log: str = "") -> BaseProcess:
    """Start the metafem command and wait until it is about to begin."""
    CONTEXT.set_forkserver_preload([__name__, *LOADED])
    run = CONTEXT.Process(target=command, args=(arguments, folder, log))
    run.start()
    assert run.pid is not None
    while run.is_alive() and not folder.with_name(f"{folder.name}-{log}.log").exists():
        time.sleep(0.001)
    return run


def said(folder: Path, log: str = "") -> str:
    """Return what the command printed in a folder."""
    return folder.with_name(f"{folder.name}-{log}.log").read_text(encoding="utf-8")


def design(name: str, folder: str | None = None, *, force: bool) -> list[str]:
    """Arguments of the command that designs NAME.toml."""
    return ["design", f"{name}.toml", "-o", folder or name, *(["--force"] if force else [])]


@contextmanager
def place(known: Scene, force: bool) -> Iterator[Path]:
    """Yield a folder with the specifications and, to be replaced, a result with somebody's notes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "parent"
        folder.mkdir()
        for each, text in known.specifications.items():
            (folder / f"{each}.toml").write_text(text, encoding="utf-8")
        if force:
            shutil.copytree(known.folder / "old", folder / "out")
            (folder / "out" / "photos").mkdir()
            for each, text in NOTES.items():
                (folder / "out" / each).write_text(text, encoding="utf-8")
        yield folder


def whole(known: Scene, folder: Path, names: tuple[str, ...], force: bool) -> bool:
    """Whether the folder holds all files of one of these designs, and the notes."""
    found = hashes(folder / "out")
    notes = {each: hashlib.sha256(text.encode()).hexdigest() for each, text in NOTES.items()} if force else {}
    return any(found == {**known.content(name), **notes} for name in names)


def next_run(folder: Path) -> None:
    """Write a small design beside, and load what is there: either tidies up."""
    template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    mf.save(mf.design(mf.OperatingPoints([0.01], [0.1]), template), folder / "next")
    if (folder / "out").exists():
        mf.load(folder / "out")


def kills(known: Scene, count: int, seed: int = 0) -> Broken:
    """Stop runs at random moments: anywhere, or shortly after they begin to write."""
    broken, rng = Broken(), random.Random(seed)
    for i in range(count):
        force, number, late = bool(i % 2), SIGNALS[i % 3], bool(i // 6 % 2)
        with place(known, force) as folder:
            run = started(design("a", "out", force=force), folder)
            wait(run, folder, rng, known.seconds, late)
            with suppress(ProcessLookupError):  # it has ended
                os.kill(run.pid, number)
            run.join()
            code, told = run.exitcode, said(folder)
            stopped = -number if number is signal.SIGKILL else 128 + number
            broken.expect(f"{number.name}: exit code {stopped}, or 0", code in (stopped, 0), (code, told))
            broken.counts[f"{number.name}: exit code {code}"] += 1
            broken.expect("no traceback", "Traceback" not in told, told)
            if number is not signal.SIGKILL:
                broken.expect(
                    f"{number.name}: nothing left at once", not leftovers(folder), leftovers(folder)
                )
            next_run(folder)
            broken.expect("nothing left after the next run", not leftovers(folder), leftovers(folder))
            kept = whole(known, folder, ("old", "a") if force else ("a",), force)
            kept |= not force and not (folder / "out").exists()
            broken.expect("no file lost, none of another design", kept, hashes(folder / "out"))
            if code == 0:
                done = whole(known, folder, ("a",), force)
                broken.expect("a run that ended well wrote its design", done)
    return broken


def wait(run: BaseProcess, folder: Path, rng: random.Random, seconds: float, late: bool) -> None:
    """Wait for a random moment of a run: in all of its time, or in that of writing."""
    if not late:
        time.sleep(rng.uniform(0.0, seconds))
        return
    while run.is_alive():
        if any(path.name == "design.json" for path in folder.rglob(f"*{HIDDEN}/new/*")):
            time.sleep(rng.uniform(0.0, 0.2 * seconds))
            return
        time.sleep(0.001)


def pairs(known: Scene, count: int) -> Broken:
    """Start two runs with one goal at once."""
    broken = Broken()
    for i in range(count):
        force = bool(i % 2)
        with place(known, force) as folder:
            runs = [started(design(name, "out", force=force), folder, name) for name in ("a", "b")]
            for run in runs:
                run.join()
            told, codes = [said(folder, name) for name in ("a", "b")], [run.exitcode for run in runs]
            winners = [name for name, code in zip(("a", "b"), codes, strict=True) if code == 0]
            # with --force the second may begin when the first has ended, and replace its result
            broken.expect("one winner", sorted(codes) == [0, 2] or (force and codes == [0, 0]), (codes, told))
            broken.expect("the folder is the winner's", whole(known, folder, tuple(winners), force), codes)
            lost = [text for text, code in zip(told, codes, strict=True) if code == 2]
            reasons = ("being written by another run", "made by somebody else", "exists")
            broken.expect("the other is told", all(any(r in text for r in reasons) for text in lost), lost)
            broken.expect("nothing left", not leftovers(folder), leftovers(folder))
    return broken


def long_rows(count: int = KILLS, twice: int = PAIRS) -> list[Row]:
    """Broken promises of stopped runs and of pairs."""
    rows = []
    with scene() as known:
        for title, broken in (("stopped", kills(known, count)), ("pair", pairs(known, twice))):
            rows += [Row(f"{title}: {row.what}", row.wanted, row.measured, row.unit) for row in broken.rows()]
            print(dict(broken.counts), file=sys.stderr)
            for promise, detail in broken.first.items():
                print(f"{title}: {promise}: {detail}", file=sys.stderr)
    return rows


if __name__ == "__main__":
    for row in long_rows():
        print(f"{row.what:60} wanted {row.wanted:g}, measured {row.measured:g} {row.unit}")
