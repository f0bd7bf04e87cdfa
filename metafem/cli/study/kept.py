"""Finished batches of a stopped study; the same command continues from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from metafem import _caches
from metafem._caches import remove
from metafem.cli.signals import report_stop
from metafem.progress import message

# Options without effect on the results.
PLACES = ("workers", "scheduler")


@contextmanager
def kept_batches(name: str, folder: Path, options: Mapping[str, Any]) -> Iterator[Path | None]:
    """Yield the folder for the batches of a study, None without a cache; remove it at the end.

    The folder is the same for every run with the same design and options. It stays if the body is stopped or
    fails after the first batch.
    """
    kept = _folder(name, folder, options)
    left = "nothing was written" if kept is None else "the same command continues from the finished batches"
    done = False
    with report_stop(left):
        try:
            yield kept
            done = True
        finally:
            if kept is not None and (done or not any(kept.glob("batch-*"))):
                remove([kept])


def _folder(name: str, folder: Path, options: Mapping[str, Any]) -> Path | None:
    """Return the folder for the batches of a study of a design with these options."""
    from metafem.files.atomic import digest
    from metafem.studies.sampling.store import inputs_hash, own_version

    numbers = {
        option: digest(value) if isinstance(value, Path) and value.is_file() else value
        for option, value in options.items()
        if option not in PLACES
    }
    inputs = inputs_hash((name, own_version(), digest(folder / "design.json"), numbers))
    try:
        found = _caches.study_folder() / inputs
        found.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message(f"a stopped study will begin again: its batches cannot be kept ({error})")
        return None
    return found
