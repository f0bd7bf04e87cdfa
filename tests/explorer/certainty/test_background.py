"""Computations beside the page, in processes that end with it."""

import asyncio
import os
import signal
import subprocess
import sys
import tempfile

import pytest

from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.certainty.background import Background, Tasks
from metafem.explorer.certainty.worker import DONE, FAILED, computed
from metafem.material import Material
from metafem.progress import doing

# Starts a computation that never ends by itself, prints that it has begun, and ends in one of several ways.
PARENT = """
import asyncio, os, signal
from tests.explorer.certainty import test_background as scene
async def main():
    begun = asyncio.Event()
    task = scene.Background(scene.endless, (), on_step=lambda *step: begun.set())
    await begun.wait()
    print("begun", task.process_id, flush=True)
    {ending}
asyncio.run(main())
"""


def endless():
    with doing("waiting"):
        signal.pause()


def printing(text):
    print(text)
    return text


def faulty():
    raise ZeroDivisionError("1/0")


def unsendable():
    return lambda: None


def killed():
    signal.raise_signal(signal.SIGKILL)


async def outcome(function, *given):
    """Return the result of a background computation, or raise its error."""
    future = asyncio.get_running_loop().create_future()
    Background(function, given, on_done=future.set_result, on_error=future.set_exception)
    return await future


def test_a_process_begins_also_where_the_folder_of_the_server_has_gone(tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert asyncio.run(outcome(os.getcwd)) == os.path.realpath(tempfile.gettempdir())


def test_the_result_is_that_of_the_function_whatever_it_prints():
    found = asyncio.run(outcome(printing, "0.12 mm"))
    assert found == "0.12 mm"


def test_errors_of_metafem_arrive_as_they_are():
    with pytest.raises(InvalidInput) as error:
        asyncio.run(outcome(Material, -1.36))
    with pytest.raises(InvalidInput) as direct:
        Material(-1.36)
    assert str(error.value) == str(direct.value)


def test_an_error_of_the_page_ends_the_computation_in_words(caplog):
    def show(*_):
        raise KeyError("curve")

    async def scene(**shown):
        future = asyncio.get_running_loop().create_future()
        task = Background(*shown.pop("call"), on_error=future.set_result, **shown)
        error = await future
        assert not task.running
        return str(error)

    done = asyncio.run(scene(call=(printing, ("a",)), on_done=show))
    stepped = asyncio.run(scene(call=(endless, ()), on_step=show))
    assert done == stepped
    assert done.startswith("This is an error of the program, not of your input: KeyError: 'curve'.")
    assert len(caplog.records) == 2


def test_a_killed_process_is_reported_in_words():
    with pytest.raises(MetafemError, match=r"exit code -9.*lack of memory; start it again"):
        asyncio.run(outcome(killed))


def test_a_function_that_cannot_be_sent_is_reported_in_words():
    with pytest.raises(MetafemError, match=r"no process could be started: .*pickle"):
        asyncio.run(outcome(lambda: 1))


def test_a_result_that_cannot_be_sent_is_reported_in_words():
    with pytest.raises(MetafemError, match="the result cannot be sent to the page"):
        asyncio.run(outcome(unsendable))


def test_other_errors_name_the_error(capsys):
    kind, error = computed(faulty, (), print)
    assert kind == FAILED
    assert str(error) == "an error within metafem, ZeroDivisionError: 1/0; the terminal shows where"
    assert "faulty" in capsys.readouterr().err


def test_the_first_step_is_reported_at_once():
    steps = []
    assert computed(stepping, (), lambda *step: steps.append(step)) == (DONE, None)
    assert steps == [("first", None)]


def stepping():
    for name in ("first", "second"):
        with doing(name):
            pass


def test_a_stopped_process_ends_and_reports_nothing_more():
    async def scene():
        begun, reports = asyncio.Event(), []
        task = Background(
            endless, (), lambda *step: begun.set(), on_done=reports.append, on_error=reports.append
        )
        await begun.wait()
        task.stop()
        task.stop()
        return task, await asyncio.to_thread(task._process.wait), reports

    task, code, reports = asyncio.run(scene())
    assert (task.running, code, reports) == (False, -signal.SIGKILL, [])


def test_a_process_that_ends_before_it_has_read_its_request_is_reported(monkeypatch):
    monkeypatch.setattr("metafem.explorer.certainty.background._program", lambda: "raise SystemExit(3)")
    with pytest.raises(MetafemError, match=r"exit code 3"):
        asyncio.run(outcome(printing, "0.12 mm" * 100_000))


def test_a_computation_that_is_stopped_at_once_never_begins():
    async def scene():
        reports = []
        task = Background(printing, ("no",), on_done=reports.append, on_error=reports.append)
        task.stop()
        task._thread.join()
        await asyncio.sleep(0)
        return reports

    assert asyncio.run(scene()) == []


@pytest.mark.slow
def test_starting_again_stops_the_one_of_that_name_alone():
    async def scene():
        tasks, begun = Tasks(), [asyncio.Event() for _ in range(2)]
        first, other = (
            tasks.start(name, endless, (), lambda *step, k=k: begun[k].set())
            for k, name in enumerate(("block", "draws"))
        )
        for event in begun:
            await event.wait()
        again = tasks.start("block", endless, ())
        running = first.running, other.running, again.running
        tasks.stop_all()
        return running, tasks.running("block"), tasks.running("draws")

    assert asyncio.run(scene()) == ((False, True, True), False, False)


@pytest.mark.slow
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
