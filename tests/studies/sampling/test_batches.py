"""Runs of batches: where they are computed, what is kept, and what happens when something ends."""

import errno
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import metafem as mf
from metafem.progress import listening
from metafem.studies import Draws, Execution
from metafem.studies.sampling import store
from metafem.studies.sampling.batches import opened
from tests.conftest import MATERIAL, RADIUS

SURFACE = mf.Surface.square_lattice(
    np.linspace(0.1, 0.2, 16), (4, 4), radius=RADIUS, material=MATERIAL, block=mf.Block(20.0, 20.0, 7.2)
)


def study(execution=None, draws=200, rng=0):
    return mf.studies.manufacturing(SURFACE, [0.001, 0.003], draws=draws, rng=rng, execution=execution)


def squares(batch):
    return {"value": np.array([batch**2])}


def computed(execution, task=squares, count=6):
    with opened(execution, "test", "0" * 32) as compute:
        return [result["value"].item() for result in compute(task, range(count))]


@pytest.mark.slow
def test_two_processes_give_the_numbers_of_one():
    assert study(Execution(workers=2)).identical(study())
    assert study(Execution(workers=2), Draws(error=0.02)).identical(study(draws=Draws(error=0.02)))


def test_a_batch_whose_process_ended_is_computed_again(tmp_path):
    def deadly(batch):
        if batch == 2 and not (tmp_path / "died").exists():
            (tmp_path / "died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return {"value": np.array([batch**2])}

    assert computed(Execution(workers=2), deadly) == [0, 1, 4, 9, 16, 25]
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_a_batch_that_always_ends_its_process_is_given_up():
    def deadly(batch):
        os.kill(os.getpid(), signal.SIGKILL)

    with pytest.raises(mf.MetafemError, match="batch 0 or one that ran with it ended its process 3 times"):
        computed(Execution(workers=2), deadly, 1)


def test_errors_of_a_batch_are_those_of_the_run():
    def wrong(batch):
        raise mf.InvalidInput("no such batch")

    for execution in (None, Execution(workers=2)):
        with pytest.raises(mf.InvalidInput, match="no such batch"):
            computed(execution, wrong)


def test_finished_batches_are_read(tmp_path):
    calls = []

    def counted(batch):
        calls.append(batch)
        return squares(batch)

    execution = Execution(folder=tmp_path / "run")
    assert computed(execution, counted, 3) == [0, 1, 4]
    assert computed(execution, counted) == [0, 1, 4, 9, 16, 25]
    assert calls == [0, 1, 2, 3, 4, 5]
    (tmp_path / "run" / "batch-00000001.npz").write_bytes(b"damaged")
    assert computed(execution, counted) == [0, 1, 4, 9, 16, 25]
    assert computed(execution, counted) == [0, 1, 4, 9, 16, 25]
    assert calls == [0, 1, 2, 3, 4, 5, 1]


def test_rounds_that_were_stopped_go_on_at_the_levels_that_want_draws(tmp_path):
    """A run to a wanted error decides after each round which levels get more draws."""
    whole = study(Execution(folder=tmp_path), Draws(error=0.01))
    kept = sorted(tmp_path.glob("batch-*.npz"))
    assert len(kept) > 16
    assert whole.draws[0] != whole.draws[1]
    for path in kept[10:]:
        path.unlink()
    assert study(Execution(folder=tmp_path), Draws(error=0.01)).identical(whole)


def test_the_folder_of_another_run_is_refused(tmp_path):
    folder = tmp_path / "run"
    first = study(Execution(folder=folder))
    assert study(Execution(folder=folder)).identical(first)
    with pytest.raises(mf.InvalidInput, match="run holds another run, with other inputs; choose another"):
        study(Execution(folder=folder), rng=1)
    with pytest.raises(mf.InvalidInput, match="holds another run, of the study manufacturing"):
        computed(Execution(folder=folder))


def test_a_folder_with_other_files_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(mf.InvalidInput, match="holds other files; choose an empty or a new folder"):
        study(Execution(folder=tmp_path))
    with pytest.raises(mf.InvalidInput, match=r"notes.txt cannot be used: "):
        study(Execution(folder=tmp_path / "notes.txt"))


def test_on_a_full_disk_what_is_done_is_kept_and_the_run_goes_on(tmp_path, monkeypatch):
    save, written = np.savez_compressed, []

    def full(file, **arrays):
        if len(written) == 2:
            file.write(b"part")
            raise OSError(errno.ENOSPC, "No space left on device")
        written.append(file.name)
        save(file, **arrays)

    messages = []
    with monkeypatch.context() as patch, listening(lambda step, done: None, messages.append):
        patch.setattr(store.np, "savez_compressed", full)
        assert computed(Execution(folder=tmp_path)) == [0, 1, 4, 9, 16, 25]
    assert messages == [f"batches are no longer kept in {tmp_path}: No space left on device"]
    kept = sorted(path.name for path in tmp_path.iterdir())
    assert kept == ["batch-00000000.npz", "batch-00000001.npz", "run.json"]
    assert computed(Execution(folder=tmp_path)) == [0, 1, 4, 9, 16, 25]
    assert len(list(tmp_path.iterdir())) == 7


def test_a_stopped_run_says_how_to_go_on(tmp_path):
    def stopped(batch):
        if batch == 2:
            raise KeyboardInterrupt
        return squares(batch)

    messages = []
    with (
        listening(lambda step, done: None, messages.append),
        pytest.raises(KeyboardInterrupt) as error,
    ):
        computed(Execution(folder=tmp_path), stopped)
    assert messages == error.value.__notes__
    assert messages == [f"finished batches are kept in {tmp_path}; the same call with this folder goes on"]
    assert computed(Execution(folder=tmp_path)) == [0, 1, 4, 9, 16, 25]


def test_progress_has_a_rate_and_the_time_left():
    steps = []
    with listening(lambda step, done: steps.append(step)):
        assert computed(None) == [0, 1, 4, 9, 16, 25]
    assert steps[0] == "batch 1 of 6"
    assert steps[3].startswith("batch 4 of 6, ")
    assert steps[3].endswith(" per second, 0 s left")


KILLED = """
import sys, time
import metafem as mf
from tests.studies.sampling.test_batches import Execution, study
from metafem.studies.manufacturing import SlopeDraws
slow = SlopeDraws.__call__
def call(self, batch):
    if batch == 5:
        print("five", flush=True)
        time.sleep(60)
    return slow(self, batch)
SlopeDraws.__call__ = call
study(Execution(folder=sys.argv[1]))
"""


@pytest.mark.slow
def test_a_killed_study_goes_on_and_equals_the_uninterrupted_one(tmp_path):
    command = [sys.executable, "-c", KILLED, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "five\n"
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert len(list(tmp_path.glob("batch-*.npz"))) == 5
    assert study(Execution(folder=tmp_path)).identical(study())


def test_the_hash_of_inputs_is_that_of_their_values():
    values = (SURFACE, mf.Interacting(), mf.Tolerances(0.001), 3, "a", None)
    same = (SURFACE.replaced(), mf.Interacting(), mf.Tolerances(0.001), 3, "a", None)
    assert store.inputs_hash(values) == store.inputs_hash(same)
    changed = [
        (SURFACE.replaced(height=SURFACE.height + 1e-9), *values[1:]),
        (SURFACE, mf.Interacting(order=1), *values[2:]),
        (*values[:2], mf.Tolerances(0.002), *values[3:]),
        (*values[:3], 3.0, *values[4:]),
    ]
    assert len({store.inputs_hash(each) for each in (values, *changed)}) == 5


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"workers": 0}, "workers = 0 must be a whole number of at least 1"),
        ({"workers": 2, "scheduler": "tcp://localhost:1"}, "workers = 2 cannot be given with a scheduler"),
    ],
)
def test_executions_that_cannot_be_are_refused(arguments, words):
    with pytest.raises(mf.InvalidInput, match=words):
        Execution(**arguments)


@pytest.mark.parametrize(
    "address", [pytest.param("tcp://127.0.0.1:1", marks=pytest.mark.slow), "", "foo://x", "no such address"]
)
def test_a_scheduler_that_does_not_answer_is_named_within_ten_seconds(address):
    start = time.monotonic()
    with pytest.raises(mf.InvalidInput, match=r"does not answer .* use workers=2 on this machine"):
        study(Execution(scheduler=address))
    assert time.monotonic() - start < 10.0


CLUSTER = """
import os, signal, sys, threading, time
from pathlib import Path
import numpy as np
from distributed import LocalCluster
import metafem as mf
from metafem.studies.sampling import batches
from tests.studies.sampling.test_batches import Execution, computed, study

died = Path(sys.argv[1]) / "died"

def deadly(batch):
    if batch == 10 and not died.exists():
        died.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": np.array([batch**2])}

def slow(batch):
    time.sleep(0.1)
    return {"value": np.array([batch])}

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        execution = Execution(scheduler=cluster.scheduler_address)
        print(computed(execution, deadly, 20) == [batch**2 for batch in range(20)], died.exists())
        print(study(execution).identical(study()))
        here, own_version = os.getpid(), batches.own_version
        batches.own_version = lambda: "another" if os.getpid() == here else "theirs"
        try:
            study(execution)
        except mf.InvalidInput as error:
            print(error)
        cluster.scale(0)
        while cluster.scheduler.workers:
            time.sleep(0.1)
        try:
            study(execution)
        except mf.InvalidInput as error:
            print(error)
        batches.own_version = own_version
        cluster.scale(1)
        cluster.wait_for_workers(1)
        threading.Timer(1.0, cluster.close).start()
        try:
            computed(execution, slow, 200)
        except mf.MetafemError as error:
            print(error)
"""


@pytest.mark.slow
def test_a_cluster_gives_the_same_numbers_when_a_worker_is_killed(tmp_path):
    command = [sys.executable, "-c", CLUSTER, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    killed, same, other, none, lost = done.stdout.splitlines()
    assert other.endswith(" have metafem theirs, and this machine another")
    assert killed == "True True"
    assert same == "True"
    assert re.match(
        "scheduler = 'tcp://.*' has no workers: start `dask worker`, or leave scheduler out", none
    )
    assert re.match("the connection with the scheduler tcp://.* was lost: start it again", lost)
