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


def printing(text):
    print(text)
    return text


def faulty():
    raise ZeroDivisionError("1/0")


def unsendable():
    return threading.Lock()


def killed():
    signal.raise_signal(signal.SIGKILL)


def stepping():
    for name in ("first", "second"):
        with doing(name):
            pass


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


def test_a_process_begins_also_where_the_folder_of_the_server_has_gone(tmp_path, monkeypatch):
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    assert outcome(os.getcwd) == os.path.realpath(tempfile.gettempdir())


def test_the_result_is_that_of_the_function_whatever_it_prints():
    # longer than a pipe holds, in both directions
    text = "0.12 mm" * 100_000
    assert outcome(printing, text) == text


def test_errors_of_metafem_arrive_as_they_are():
    with pytest.raises(InvalidInput) as error:
        outcome(Material, -1.36)
    with pytest.raises(InvalidInput) as direct:
        Material(-1.36)
    assert str(error.value) == str(direct.value)


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
        (killed, r"exit code -9.*lack of memory; start it again"),
        (lambda: 1, r"no process could be started: .*pickle"),
        (unsendable, r"an error within metafem, TypeError: cannot pickle .*; the terminal shows where"),
        (faulty, r"^an error within metafem, ZeroDivisionError: 1/0; the terminal shows where$"),
        (exhausting, r"^there is not enough memory for this computation$"),
    ],
)
def test_other_errors_are_reported_in_words(function, words):
    with pytest.raises(MetafemError, match=words):
        outcome(function)


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


def test_a_process_that_ends_before_it_has_read_its_request_is_reported(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(MetafemError, match=r"exit code 1"):
        outcome(printing, "0.12 mm" * 100_000)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    with pytest.raises(MetafemError, match=r"no process could be started: .*No such file"):
        outcome(printing, "0.12 mm")


def test_a_computation_that_is_stopped_at_once_never_begins(monkeypatch):
    async def scene():
        tasks = Tasks()
        study = tasks.start("study", printing, ("no",), print)
        monkeypatch.setattr(asyncio, "create_subprocess_exec", None)
        tasks.stop("study")
        with pytest.raises(asyncio.CancelledError):
            await study

    asyncio.run(scene())


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
