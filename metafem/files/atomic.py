"""Writing of files and folders: completely or not at all, and over nothing without `force`."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from metafem.errors import InvalidInput, refuse_if


@contextmanager
def staged(goal: str | Path, force: bool = False, *, folder: bool = False) -> Iterator[Path]:
    """Yield a path in a hidden folder beside `goal`; what the body writes there becomes `goal` at its end.

    With `folder`, the path is a new folder, otherwise a file that the body creates. If the body fails,
    nothing is left. Raise InvalidInput if `refuse_existing` refuses `goal`, or if it cannot be written.
    """
    refuse_existing(goal, force, folder=folder)
    target = Path(goal).resolve()
    with _reported(target), TemporaryDirectory(prefix=".metafem-", dir=target.parent) as work:
        fresh, earlier = Path(work, "new"), Path(work, "old")
        if folder:
            fresh.mkdir()
        yield fresh
        refuse_existing(goal, force, folder=folder)  # another program may have written there
        if not folder or not target.exists():
            fresh.replace(target)
            return
        target.rename(earlier)
        try:
            fresh.rename(target)
        except BaseException:
            earlier.rename(target)
            raise


def refuse_existing(goal: str | Path, force: bool = False, *, folder: bool = False) -> None:
    """Raise InvalidInput if `staged` would refuse a file or folder; call this function before a long run.

    Without `force`, everything that exists is refused but an empty folder. With `force`, a regular file is
    replaced by a file, and a result folder by a folder.
    """
    target = Path(goal).resolve()
    with _reported(target):
        refuse_if(not target.parent.is_dir(), f"{target.parent} is not a folder; create it first")
        try:
            kind = os.lstat(target).st_mode
        except FileNotFoundError:
            return
        found = folder and stat.S_ISDIR(kind)
        if found and not any(target.iterdir()):
            return
        words = "is in the way; choose another name"
        usable = (target / "design.json").is_file() if found else stat.S_ISREG(kind) and not folder
        refuse_if(not usable, f"{target} is no {'result folder' if folder else 'regular file'} and {words}")
        words = f"{target} exists; choose another name, or replace it with force=True (--force)"
        refuse_if(not force, words)


def write_file(path: str | Path, write: Callable[[Path], object], *, force: bool = False) -> None:
    """Call `write` with the path of a hidden file, which then becomes `path`; see `staged`."""
    with staged(path, force) as fresh:
        write(fresh)


def write_text(path: str | Path, text: str, *, force: bool = False) -> None:
    """Write a text in UTF-8; see `staged`."""
    write_file(path, lambda fresh: fresh.write_bytes(text.encode("utf-8")), force=force)


@contextmanager
def _reported(target: Path) -> Iterator[None]:
    """Raise errors of the operating system as InvalidInput, which names the file or folder `target`."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        raise InvalidInput(f"{target} cannot be written: {reason}; choose another folder") from None
