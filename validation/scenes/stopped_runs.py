"""Runs of `metafem design` that are stopped at random moments, and pairs of runs with one result folder.

Each run is a whole `metafem design` in a separate process. Half of the runs replace a result folder, with
--force. The processes are forked from one that has imported all modules, so that signals arrive during the
computation. Afterwards all files of one design must be there, to the bit: in the folder, or in the one to
which it was renamed while it is replaced. After the next run in its parent there is no other file.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import random
import shutil
import signal
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
from validation.timing import took

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
CONTEXT = multiprocessing.get_context("forkserver")
# Modules that a command imports first. Without them, most signals would arrive during imports.
LOADED = (
    *("metafem.files.specification.contents", "metafem.report.page", "metafem.drawing", "matplotlib.figure"),
    *("meshio", "rich.console", "rich.table", "scipy.optimize", "numba"),
)
# A quarter of the asperities of the demo, for a quarter of its areas.
SMALL = {
    "[8, 8]": "[4, 4]",
    '"0.144 mm^2", "0.336 mm^2", "0.649 mm^2"': '"0.036 mm^2", "0.084 mm^2", "0.162 mm^2"',
    '"0.84 mm^2", "1.68 mm^2", "4.12 mm^2"': '"0.21 mm^2", "0.42 mm^2", "1.03 mm^2"',
}
# Reasons for which a run does not write.
REASONS = ("being written by another run", "made by another program", "exists")
HIDDEN = ("*.metafem-writing", "*.metafem-lock")


@dataclass(frozen=True)
class Scene:
    """A folder with three specifications and their designs, and the seconds that one design takes."""

    folder: Path
    seconds: float


@dataclass
class Tally:
    """How often each requirement was tested and how often it failed, with the first failure."""

    trials: Counter[str] = field(default_factory=Counter)
    failures: Counter[str] = field(default_factory=Counter)
    first: dict[str, str] = field(default_factory=dict)
    counts: Counter[str] = field(default_factory=Counter)

    def expect(self, requirement: str, met: bool, detail: object = "") -> None:
        """Count one trial of a requirement."""
        self.trials[requirement] += 1
        if not met:
            self.failures[requirement] += 1
            self.first.setdefault(requirement, str(detail))

    def none(self, requirement: str, found: list[str]) -> None:
        """Count one trial of the requirement that nothing is found."""
        self.expect(requirement, not found, found)


def hashes(folder: Path) -> dict[str, str]:
    """Hashes of all files below a folder by their paths; empty if there is none."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def leftovers(folder: Path) -> list[str]:
    """Working folders and locks below a folder."""
    return [str(path.relative_to(folder)) for hidden in HIDDEN for path in folder.rglob(hidden)]


@contextmanager
def scene() -> Iterator[Scene]:
    """Design three small surfaces to compare with."""
    text = demo_text("operating-points")
    for before, after in SMALL.items():
        text = text.replace(before, after)
    texts = {name: text.replace("seed = 0", f"seed = {seed}") for seed, name in enumerate(("old", "a", "b"))}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "parent"
        folder.mkdir()
        for each, content in texts.items():
            (folder / f"{each}.toml").write_text(content, encoding="utf-8")
            seconds, _ = took(lambda each=each: started(design(each, force=False), folder).join())
            mf.load(folder / each)
        yield Scene(folder, seconds)


def command(arguments: list[str], folder: Path, log: str) -> None:
    """Run the metafem command in a folder; its output goes to a file beside the folder."""
    from metafem.cli import main

    os.chdir(folder)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it in the background
    with stopped_by_signals(last=True):  # before the file exists, which shows that the command begins
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


def output(folder: Path, log: str = "") -> str:
    """Return the output of the command in a folder."""
    return folder.with_name(f"{folder.name}-{log}.log").read_text(encoding="utf-8")


def design(name: str, folder: str | None = None, *, force: bool) -> list[str]:
    """Arguments of the command that designs NAME.toml."""
    return ["design", f"{name}.toml", "-o", folder or name, *(["--force"] if force else [])]


@contextmanager
def parent_folder(known: Scene, force: bool) -> Iterator[Path]:
    """Yield a folder with the specifications and, to be replaced, a result."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "parent"
        folder.mkdir()
        for specification in known.folder.glob("*.toml"):
            shutil.copy(specification, folder)
        if force:
            shutil.copytree(known.folder / "old", folder / "out")
        yield folder


def whole(known: Scene, folder: Path, *names: str) -> bool:
    """Whether the folder holds all files of one of these designs and no others."""
    return hashes(folder) in [hashes(known.folder / name) for name in names]


def nothing_lost(known: Scene, parent: Path, force: bool) -> bool:
    """Whether the folder of a stopped run is whole: missing, or if it is replaced, at worst renamed."""
    out, old = parent / "out", parent / "out.old"
    if old.exists() and not whole(known, old, "old"):
        return False
    if not out.exists():
        return old.exists() or not force
    return whole(known, out, "a", *(["old"] if force else []))


def next_run(folder: Path) -> None:
    """Write a small design beside the result and load the result: each removes leftovers."""
    template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    mf.save(mf.design(mf.OperatingPoints([0.01], [0.1]), template), folder / "next")
    if (folder / "out").exists():
        mf.load(folder / "out")


def kills(known: Scene, count: int, seed: int = 0) -> Tally:
    """Stop runs at random moments of their whole time, or shortly after they begin to write."""
    tally, rng = Tally(), random.Random(seed)
    for i in range(count):
        force, number, late = bool(i % 2), SIGNALS[i % 3], bool(i // 2 % 2)
        with parent_folder(known, force) as folder:
            run = started(design("a", "out", force=force), folder)
            wait(run, folder, rng, known.seconds, late)
            with suppress(ProcessLookupError):  # the run has ended
                os.kill(run.pid, number)
            run.join()
            code, printed = run.exitcode, output(folder)
            stopped = -number if number is signal.SIGKILL else 128 + number
            tally.expect(f"{number.name}: exit code {stopped}, or 0", code in (stopped, 0), (code, printed))
            tally.counts[f"{number.name}: exit code {code}"] += 1
            tally.expect("no traceback", "Traceback" not in printed, printed)
            if number is not signal.SIGKILL:
                tally.none(f"{number.name}: no working folder left by the run itself", leftovers(folder))
            next_run(folder)
            tally.none("no working folder left after the next run", leftovers(folder))
            tally.expect("all files of one design", nothing_lost(known, folder, force), hashes(folder))
            if code == 0:
                done = whole(known, folder / "out", "a") and not (folder / "out.old").exists()
                tally.expect("a run with exit code 0 wrote its design", done)
    return tally


def wait(run: BaseProcess, folder: Path, rng: random.Random, seconds: float, late: bool) -> None:
    """Wait for a random moment of a run: of its whole time, or of the time in which it writes."""
    if not late:
        time.sleep(rng.uniform(0.0, seconds))
        return
    while run.is_alive():
        if any(path.name == "design.json" for path in folder.rglob(f"{HIDDEN[0]}/*")):
            time.sleep(rng.uniform(0.0, 0.2 * seconds))
            return
        time.sleep(0.001)


def pairs(known: Scene, count: int) -> Tally:
    """Start two runs with the same result folder at the same time."""
    tally = Tally()
    for i in range(count):
        force = bool(i % 2)
        with parent_folder(known, force) as folder:
            runs = [started(design(name, "out", force=force), folder, name) for name in ("a", "b")]
            for run in runs:
                run.join()
            codes = {name: run.exitcode for name, run in zip(("a", "b"), runs, strict=True)}
            written = [name for name, code in codes.items() if code == 0]
            refused = [output(folder, name) for name, code in codes.items() if code == 2]
            # with --force the second run may begin after the first has ended, and replace its result
            one = sorted(codes.values()) == [0, 2] or (force and len(written) == 2)
            tally.expect("one run writes the folder", one, (codes, refused))
            kept = whole(known, folder / "out", *written)
            tally.expect("the folder holds the design of that run", kept, codes)
            silent = [text for text in refused if not any(reason in text for reason in REASONS)]
            tally.none("the other run reports the reason", silent)
            tally.none("no working folder left", leftovers(folder))
    return tally
