"""Damaged files of every kind end with a message: a short run of what the benchmark counts."""

import random

from validation.scenes import damaged_files


def test_damaged_files_end_with_a_message():
    tally = damaged_files.measure(99, seed=1)
    assert not any(tally.faults.values()), tally.faults
    assert tally.refused > 50


def test_faults_are_counted_by_kind():
    tally = damaged_files.Tally()
    damaged_files.record_faults(tally, "0/0 a.toml", 3, "", "Traceback (most recent call last)")
    damaged_files.record_faults(tally, "0/1 a.toml", 2, "", "Error: a.toml: one\nand more")
    assert [len(found) for found in tally.faults.values()] == [1, 0, 1, 1]


def test_damage_is_the_same_for_a_seed():
    raw = b'{"a": {"b": [1, 2]}, "c": 3}'
    first, second = (
        [damaged_files.damaged_record(random.Random(s), raw) for s in range(9)] for _ in range(2)
    )
    assert first == second
    assert len(set(first)) > 3
