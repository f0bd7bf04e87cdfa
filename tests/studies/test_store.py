"""Batches kept on a full disk."""

import errno

import numpy as np

from metafem.progress import listening
from metafem.studies import Execution
from metafem.studies.sampling import store
from tests.core.studies.test_batches import SQUARES, computed


def test_on_a_full_disk_what_is_done_is_kept_and_the_run_goes_on(tmp_path, monkeypatch):
    save, written, messages = np.savez_compressed, [], []

    def full(file, **arrays):
        if len(written) == 2:
            raise OSError(errno.ENOSPC, "No space left on device")
        written.append(file.name)
        save(file, **arrays)

    monkeypatch.setattr(store.np, "savez_compressed", full)
    with listening(lambda step, done: None, messages.append):
        assert computed(Execution(folder=tmp_path)) == SQUARES
    assert [str(tmp_path) in text for text in messages] == [True]
    kept = sorted(path.name for path in tmp_path.iterdir())
    assert kept == ["batch-00000000.npz", "batch-00000001.npz", "run.json"]
