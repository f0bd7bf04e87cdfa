"""Atomic writing: a file or a result folder is written completely or not at all.

It is first written into a hidden folder next to its destination, under a lock, and then renamed. Before a
result folder is replaced, it is renamed to ``NAME.old``. At worst, a killed run leaves this complete folder
and hidden folders, which the next run removes.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import stat
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

from filelock import FileLock, Timeout

from metafem._given import Given
from metafem.errors import InvalidInput, refuse_if
from metafem.progress import message

# Hidden file of a result folder. It has a line "sha256  name" for every file that metafem wrote there.
MANIFEST = ".metafem-files"

# Suffixes of a hidden lock file, of a hidden working folder, and of an earlier result while it is replaced.
LOCK, WORK, OLD = ".metafem-lock", ".metafem-writing", ".old"

# Time to wait for a lock [s]; another run needs less to write one file or to remove leftovers.
PATIENCE = 0.5

# A file outside a result folder is identified by one of these texts among its first bytes.
FIRST_BYTES = 200
MARKS: Mapping[str, bytes] = {
    "law": b"load_N,area_mm2,separation_mm,rescaled_load_mm2,rescaled_friction_mm2",
    "nearest law": b"# The nearest law that was found, by metafem.",
    "heights": b"site,x_mm,y_mm,height_mm,radius_mm",
    "contacts": b"image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2",
    "sections": b"# Calibration by metafem: sections of a specification",
    "calibration": b'{"kind": "metafem calibration"',
    "schema": b'"title": "Specification of metafem"',
    "figure": b"figure by metafem",
}

NOTHING: Mapping[str, bytes] = MappingProxyType({})


@contextmanager
def staged(
    folder: str | Path, force: bool = False, contents: Mapping[str, bytes] = NOTHING
) -> Iterator[Path]:
    """Yield a hidden folder that becomes `folder` if the body ends without an error.

    Other runs of metafem cannot write to the same destination in the meantime. If the body fails, the hidden
    folder is removed. An existing folder is refused unless it is empty or, with `force`, contains only files
    that metafem wrote and files with these `contents`. A link to a folder is followed.

    Raise InvalidInput if the folder is refused, if another run is writing it, or if it cannot be written.
    """
    target = _target(folder)
    with _claimed(target) as fresh:
        existed = _refuse_folder(target, force, contents)
        if earlier := earlier_result(target):
            message(f"{earlier} is an earlier result: a run was stopped while it replaced {target.name}")
        yield fresh
        with _reported(target):
            lines = [_manifest_line(path) for path in sorted(fresh.iterdir())]
            (fresh / MANIFEST).write_text("".join(lines), encoding="utf-8")
            if existed:
                _replace(target, fresh, contents)
                return
            # without this check, the rename would replace an empty folder that was made in the meantime
            words = "was made by another program in the meantime and is unchanged; choose another folder"
            refuse_if(os.path.lexists(target), f"{target} {words}")
            fresh.rename(target)


def check_free(folder: str | Path, force: bool = False) -> None:
    """Raise InvalidInput if `staged` would refuse the folder; call this function before a long run."""
    _refuse_folder(_target(folder), force, NOTHING)


def earlier_result(folder: Path) -> Path | None:
    """Return the result folder ``NAME.old`` that a killed run left if `folder` is missing, otherwise None."""
    old = folder.with_name(folder.name + OLD)
    return old if (old / MANIFEST).is_file() and not os.path.lexists(folder) else None


def _target(folder: str | Path) -> Path:
    """Return the absolute path of a result folder; its parent must exist, and links are resolved."""
    target = Path(folder).absolute()
    empty = 'folder = "" is an empty name; name a new folder, such as "mine"'
    refuse_if(folder == "", empty)
    refuse_if(not target.parent.is_dir(), f"{target.parent} is not a folder; create it first")
    return target.resolve() if os.path.islink(target) and os.path.isdir(target) else target


def _refuse_folder(target: Path, force: bool, contents: Mapping[str, bytes]) -> bool:
    """Return whether a folder exists; raise InvalidInput if it must not be replaced."""
    with _reported(target):
        try:
            kind = os.lstat(target).st_mode
        except FileNotFoundError:
            return False
        words = f"{target} is in the way and is not a folder; choose another name"
        refuse_if(not stat.S_ISDIR(kind), words)
        _refuse_changed(target, target, contents)
        words = "{.number} exists; choose another folder, or replace it with {.name}"
        about = Given("folder", str(target)), Given("force=True")
        refuse_if(not force and any(target.iterdir()), words, *about)
        old = target.with_name(target.name + OLD)
        words = f"because {target.name} has this name while it is replaced"
        words = f"a run that was stopped, or you, kept an earlier result there; remove or rename it, {words}"
        refuse_if(os.path.lexists(old), f"{old} exists: {words}")
    return True


def _refuse_changed(folder: Path, target: Path, contents: Mapping[str, bytes]) -> None:
    """Raise InvalidInput if a folder contains changed files, or files that metafem did not write.

    Errors call the folder `target`, because it may have a hidden name.
    """
    known = written(folder)
    same = {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}
    foreign = [
        path.name
        for path in sorted(folder.iterdir())
        if path.name != MANIFEST and not unchanged(path, {*known.get(path.name, ()), same.get(path.name, "")})
    ]
    if foreign:
        raise _foreign(target, foreign, known)


def _foreign(folder: Path, names: Sequence[str], known: Collection[str]) -> InvalidInput:
    """Return the error for files that metafem did not write or that were changed."""
    fact = "was changed since metafem wrote it" if names[0] in known else "was not written by metafem"
    more = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
    return InvalidInput(
        f"{folder / names[0]}{more} {fact}, so it is not replaced; move it elsewhere, or choose another name"
    )


def _replace(target: Path, fresh: Path, contents: Mapping[str, bytes]) -> None:
    """Replace the folder `target` by `fresh`; the earlier folder gets the hidden name of `fresh`."""
    for path in fresh.iterdir():  # the new files are on the disk before the old ones are removed
        with path.open("rb+") as file:
            os.fsync(file.fileno())
    old = target.rename(target.with_name(target.name + OLD))
    try:
        _refuse_changed(old, target, contents)
        fresh.rename(target)
    finally:
        old.rename(fresh if target.exists() else target)


def write_text(path: str | Path, text: str, **options: Any) -> None:
    """Write a text in UTF-8; the options are those of `write_file`."""
    write_file(path, lambda fresh: fresh.write_bytes(text.encode("utf-8")), **options)


def write_file(
    path: str | Path,
    write: Callable[[Path], object],
    *,
    force: bool = False,
    kind: str = "",
    still: Callable[[], None] = lambda: None,
    fixed: bool = False,
) -> None:
    """Call `write` with a hidden path, and rename the file that it writes to `path`.

    With `force` an existing file is replaced. In a result folder, metafem must have written this file, and it
    must be unchanged. Elsewhere, it must be of the same `kind`, a key of `MARKS`; any file is replaced if
    `kind` is empty. `still` is called before the rename and raises an error if the content is no longer
    valid. If `fixed` is true, errors do not propose another name. Raise InvalidInput if the file exists or
    cannot be written. No unfinished file is left.
    """
    target = Path(path).absolute()
    refuse_existing(target, force, kind, fixed)
    manifest = target.with_name(MANIFEST)
    in_result = manifest.is_file()
    with _reported(target), _claimed(target.parent if in_result else target) as work:
        fresh = work / target.name
        write(fresh)
        still()
        refuse_existing(target, force, kind, fixed)
        if in_result:  # first the manifest: if the run is killed here, the old file still counts as unchanged
            with manifest.open("a", encoding="utf-8") as file:
                file.write(_manifest_line(fresh))
        fresh.replace(target)


def refuse_existing(path: str | Path, force: bool, kind: str = "", fixed: bool = False) -> None:
    """Raise InvalidInput if `write_file` would refuse the file; call this function before a long run."""
    target = Path(path).absolute()
    if not os.path.lexists(target):
        return
    other = "" if fixed else "choose another name, or "
    words = f"{{.number}} exists; {other}replace it with {{.name}}"
    refuse_if(not force, words, Given("path", str(target)), Given("force=True"))
    what = "a link" if target.is_symlink() else "a folder" if target.is_dir() else "no regular file"
    words = f"{target} cannot be written: it is {what}; choose another name"
    refuse_if(target.is_symlink() or not target.is_file(), words)
    known = written(target.parent)
    in_result = target.with_name(MANIFEST).is_file()
    if not (unchanged(target, known.get(target.name, ())) if in_result else is_of_kind(target, kind)):
        raise _foreign(target.parent, [target.name], known)


@contextmanager
def _claimed(goal: Path) -> Iterator[Path]:
    """Lock a file or folder to be written, and yield an empty hidden folder next to it.

    Hidden folders of killed runs are removed first, and the yielded folder at the end. Raise InvalidInput,
    which names the destination, if another run has the lock or if the folder cannot be created.
    """
    lock = goal.with_name(f".{goal.name}{LOCK}")
    with _reported(goal):
        others = [path for path in goal.parent.iterdir() if path.name.endswith(LOCK) and path != lock]
        lock.touch()  # if this fails, the error of the operating system states the reason
        held = FileLock(lock)
        try:
            held.acquire(timeout=PATIENCE)
        except Timeout:
            raise InvalidInput(
                f"{goal} is being written by another run of metafem; wait for its end, or choose another name"
            ) from None
    try:
        for other in others:
            with suppress(Timeout, OSError), FileLock(other).acquire(timeout=0.0):
                _remove(other)
        with _reported(goal):
            shutil.rmtree(_work(lock), ignore_errors=True)
            _work(lock).mkdir()
        yield _work(lock)
    finally:
        try:
            _remove(lock)
        except BaseException:  # a signal stopped the removal: repeat it
            _remove(lock)
            raise
        finally:
            held.release()


def _work(lock: Path) -> Path:
    return lock.with_name(lock.name.removesuffix(LOCK) + WORK)


def _remove(lock: Path) -> None:
    """Remove the working folder of a lock that this process holds, and the lock file.

    Another run that waits for the lock creates the lock file again.
    """
    shutil.rmtree(_work(lock), ignore_errors=True)
    lock.unlink(missing_ok=True)


@contextmanager
def _reported(target: Path) -> Iterator[None]:
    """Raise errors of the operating system as InvalidInput, which names the file or folder `target`."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        raise InvalidInput(f"{target} cannot be written: {reason}; choose another folder") from None


def is_of_kind(path: Path, kind: str) -> bool:
    """Return whether the first bytes of a file are those of a kind of `MARKS`; any file is of kind ""."""
    with path.open("rb") as file:
        return MARKS.get(kind, b"") in file.read(FIRST_BYTES)


def digest(path: Path) -> str:
    """Return the SHA-256 hash of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def unchanged(path: Path, hashes: Collection[str]) -> bool:
    """Return whether a path is a regular file, not a link, and its hash is one of `hashes`."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode) and bool(hashes) and digest(path) in hashes
    except FileNotFoundError:
        return False


def written(folder: Path) -> dict[str, set[str]]:
    """Return the hashes that a folder's manifest lists for each file; a file written twice has two."""
    try:
        text = (folder / MANIFEST).read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return {}
    found: dict[str, set[str]] = {}
    for each, name in re.findall(r"([0-9a-f]{64})  (.+)", text):
        found.setdefault(name, set()).add(each)
    return found


def _manifest_line(path: Path) -> str:
    return f"{digest(path)}  {path.name}\n"
