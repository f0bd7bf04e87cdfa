"""A working folder that one process holds at a time.

Its name is hidden, and the same for all runs with the same goal. A lock, which the system releases at the end
of a process, distinguishes a running process from what a killed one left.
"""

from __future__ import annotations

import os
import shutil
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from metafem.errors import InvalidInput
from metafem.files.atomic.replacement import NEW, OLD, UNFINISHED, undo

SUFFIX, LOCK = ".metafem-writing", "lock"

# Seconds to wait for a lock: the writing of a single file and the removal of leftovers take less.
PATIENCE = 0.5


def beside(goal: Path) -> Path:
    """Return the working folder of a folder that does not exist yet."""
    return goal.with_name(f".{goal.name}{SUFFIX}")


@contextmanager
def claimed(work: Path, goal: Path) -> Iterator[Path]:
    """Make and yield the folder `work`, with an empty folder ``new`` in it; it is removed at the end.

    It is beside the goal or in it, and so on the same disk. What killed runs left in its parent is removed
    first, and their unfinished replacements are undone. Raise InvalidInput, which names the goal, if another
    process holds it or it cannot be made.
    """
    held: int | None = None
    try:
        try:
            held = _acquired(work, goal)
            _clear(work)
            sweep(work.parent)
            (work / NEW).mkdir()
        except InvalidInput:
            raise
        except (OSError, ValueError, KeyError) as error:
            raise InvalidInput(f"{goal} cannot be written: {reason(error)}; choose another folder") from None
        yield work
    finally:
        if held is not None:
            try:
                _released(work, held)
            except BaseException:  # a signal during the removal, which is then repeated
                _released(work, held)
                raise


def sweep(folder: Path) -> None:
    """Remove what killed runs left in a folder, and undo the replacements that they did not finish."""
    with suppress(OSError):
        for entry in list(os.scandir(folder)):
            work = Path(entry.path)
            if not entry.name.endswith(SUFFIX) or not entry.is_dir(follow_symlinks=False):
                continue
            with suppress(OSError):
                work.rmdir()  # succeeds if the process was killed before it made the lock
            with suppress(OSError):
                held = locked(work / LOCK, os.O_RDWR)
                if held is not None:
                    _released(work, held)


def restore(folder: Path) -> None:
    """Undo a replacement that a killed run left unfinished in this folder."""
    if (folder / SUFFIX).is_dir():
        sweep(folder)


def reason(error: Exception) -> str:
    """Return the message of the system for an error."""
    return str(getattr(error, "strerror", None) or error)


def _acquired(work: Path, goal: Path) -> int:
    """Return the open lock of a working folder, which is made if needed."""
    end = time.monotonic() + PATIENCE
    while True:
        with suppress(FileExistsError):
            work.mkdir()
        if work.is_symlink():
            raise InvalidInput(f"{work} is a link; remove it, or choose another name")
        with suppress(FileNotFoundError):  # another process has just removed the folder
            held = locked(work / LOCK, os.O_RDWR | os.O_CREAT)
            if held is not None:
                os.ftruncate(held, 0)
                text = f"process {os.getpid()} on {socket.gethostname()}, since {time.strftime('%H:%M:%S')}"
                os.write(held, text.encode("utf-8"))
                return held
        if time.monotonic() > end:
            raise InvalidInput(
                f"{goal} is being written by another run of metafem{_owner(work)}; wait for its end, or "
                "choose another name"
            )
        time.sleep(PATIENCE / 50)


def _owner(work: Path) -> str:
    try:
        owner = (work / LOCK).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    return f" ({owner})" if owner else ""


def locked(path: Path, flags: int) -> int | None:
    """Return a file opened and locked, None if another process holds it or has just removed it."""
    handle = os.open(path, flags, 0o666)
    try:
        # a file that another process removed before it was locked is not a lock
        if _lock(handle) and os.fstat(handle).st_nlink:
            return handle
    except BaseException:
        os.close(handle)
        raise
    os.close(handle)
    return None


def _lock(handle: int) -> bool:
    """Lock a file for this process, until it closes it or ends; false if another holds it."""
    if sys.platform == "win32":
        import msvcrt

        os.lseek(handle, 1 << 20, os.SEEK_SET)  # behind the text: a locked byte cannot be read
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        finally:
            os.lseek(handle, 0, os.SEEK_SET)
        return True
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _clear(work: Path) -> None:
    undo(work, work.parent)
    for name in (NEW, OLD):
        if (work / name).exists():
            shutil.rmtree(work / name)


def _released(work: Path, held: int) -> None:
    """Remove a working folder; if its replacement cannot be undone, it is left for the next run."""
    try:
        os.fstat(held)  # fails if it was closed before a signal: another process may have the lock
        _clear(work)
        (work / UNFINISHED).unlink(missing_ok=True)
        with suppress(PermissionError):  # Windows does not remove open files
            (work / LOCK).unlink(missing_ok=True)
    except (OSError, ValueError, KeyError):
        with suppress(OSError):
            os.close(held)
            return
    else:
        os.close(held)
    with suppress(OSError):
        if sys.platform == "win32":
            (work / LOCK).unlink()
        work.rmdir()  # another process may have begun to use it
