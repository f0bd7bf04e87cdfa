"""Computations beside the page, in processes that end with it."""

import asyncio
import os
import signal
import subprocess
import sys
import tempfile
import threading

import pytest

from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.certainty.background import Tasks
from metafem.material import Material
from metafem.progress import doing

# Starts a computation that never ends by itself, prints that it has begun, and ends in one of several ways.
PARENT = """
import asyncio, os, signal
from tests.explorer import test_background as scene
async def main():
    begun = asyncio.Event()
    task = scene.Tasks().start("study", scene.endless, (), lambda *step: begun.set())
    await begun.wait()
    print("begun", flush=True)
    {ending}
asyncio.run(main())
"""


def endless():
    with doing(str(os.getpid())):
        signal.pause()


def faulty():
    raise ZeroDivisionError("1/0")


def unsendable():
    return threading.Lock()


def killed():
    signal.raise_signal(signal.SIGKILL)


def stepping(text):
    print(text)  # which is no part of the result
    with doing("a step"):
        return os.getcwd(), text


def exhausting():
    raise MemoryError


def outcome(function, *given, on_step=lambda *step: None):
    """Return the result of a background computation, or raise its error."""

    async def scene():
        tasks = Tasks()
        try:
            return await tasks.start("study", function, given, on_step)
        finally:
            assert not tasks.running("study")

    return asyncio.run(scene())


def gone(process):
    """Whether there is no process of this number, not even one whose exit code nobody has read."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


def test_a_process_returns_its_result_also_where_the_folder_of_the_server_has_gone(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    text, steps = "0.12 mm" * 100_000, []  # longer than a pipe holds, in both directions
    found = outcome(stepping, text, on_step=lambda *step: steps.append(step))
    assert found == (os.path.realpath(tempfile.gettempdir()), text)
    assert steps == [("a step", None)]


def test_an_error_of_the_page_ends_the_computation():
    processes = []

    def show(name, done):
        processes.append(int(name))
        raise KeyError("curve")

    with pytest.raises(KeyError, match="curve"):
        outcome(endless, on_step=show)
    assert gone(*processes)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (killed, "-9"),
        (lambda: 1, "pickle"),
        (unsendable, "TypeError"),
        (faulty, "1/0"),
        (exhausting, "memory"),
    ],
)
def test_other_errors_are_reported(function, words, capfd):
    with pytest.raises(MetafemError, match=words):
        outcome(function)
    assert function is not faulty or "in faulty" in capfd.readouterr().err


def test_errors_of_metafem_arrive_as_they_are():
    with pytest.raises(InvalidInput, match="composite_modulus"):
        outcome(Material, -1.36)


def test_a_stopped_process_ends():
    async def scene():
        tasks, begun = Tasks(), asyncio.get_running_loop().create_future()
        study = tasks.start("study", endless, (), lambda name, done: begun.set_result(name))
        process = int(await begun)
        tasks.stop("study")
        tasks.stop("study")
        assert not tasks.running("study")
        with pytest.raises(asyncio.CancelledError):
            await study
        return process

    assert gone(asyncio.run(scene()))


def test_a_process_that_cannot_begin_is_reported(monkeypatch, tmp_path):
    for program, words in (("/bin/false", "exit code 1"), (str(tmp_path / "python"), "No such file")):
        monkeypatch.setattr(sys, "executable", program)
        with pytest.raises(MetafemError, match=words):
            outcome(stepping, "0.12 mm" * 100_000)


def test_starting_again_stops_the_one_of_that_name_alone():
    async def scene():
        tasks, begun = Tasks(), [asyncio.Event() for _ in range(2)]
        first, other = (
            tasks.start(name, endless, (), lambda *step, k=k: begun[k].set())
            for k, name in enumerate(("block", "draws"))
        )
        for event in begun:
            await event.wait()
        again = tasks.start("block", endless, (), print)
        with pytest.raises(asyncio.CancelledError):
            await first
        running = tasks.running("block"), other.done(), again.done()
        tasks.stop_all()
        await asyncio.gather(other, again, return_exceptions=True)
        return running, tasks.running("block"), tasks.running("draws")

    assert asyncio.run(scene()) == ((True, False, False), False, False)


@pytest.mark.parametrize(
    "ending",
    [
        "pass",
        "raise SystemExit(1)",
        "os.kill(os.getpid(), signal.SIGKILL)",
    ],
    ids=["end", "error", "kill"],
)
def test_no_process_outlives_its_parent(ending):
    parent = subprocess.run(
        [sys.executable, "-c", PARENT.format(ending=ending)], capture_output=True, text=True, timeout=60
    )
    # the child has the parent's stderr, which ends only when both have ended
    assert parent.stdout.startswith("begun")
