"""Result folders that are written completely or not at all."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

from metafem.errors import InvalidInput
from metafem.files.atomic.claim import SUFFIX, beside, claimed, reason, sweep
from metafem.files.atomic.manifest import (
    MANIFEST,
    digest,
    is_result_folder,
    manifest_text,
    unchanged,
    written,
)
from metafem.files.atomic.replacement import NEW, refuse_foreign, replace_files

# Most files that an error lists.
MOST_NAMED = 3

NOTHING: Mapping[str, bytes | None] = MappingProxyType({})


@contextmanager
def staged(
    folder: str | Path, force: bool = False, expected: Mapping[str, bytes | None] = NOTHING
) -> Iterator[Path]:
    """Yield a temporary folder whose files become those of `folder` if the body ends without an error.

    It is hidden, locked for other runs of metafem, and removed if the body fails. A new folder appears by one
    rename, which fails if a folder of that name was made in the meantime. An existing folder is refused
    unless it is empty, or with `force` a result folder; then the files in it that metafem wrote, and no
    others, are replaced by `replace_files`. A link to a folder stands for that folder. `expected` are the
    names of the files that the body writes, with their content if it is known: other files of these names
    are refused before the body runs.

    Raise InvalidInput if the folder holds files, holds a changed file, is being written by another run, or
    cannot be written; no unfinished file is left.
    """
    target = check_free(folder, force, expected)
    inside = target.is_dir()
    with claimed(target / SUFFIX if inside else beside(target), target) as work:
        _usable(target, force, expected, held=True)
        yield work / NEW
        try:
            _finish(work, target, inside)
        except OSError as error:
            raise InvalidInput(
                f"{target} cannot be written: {reason(error)}; choose another folder"
            ) from None


def _finish(work: Path, target: Path, inside: bool) -> None:
    """Put the files and their manifest in place."""
    fresh = {path.name: frozenset({digest(path)}) for path in (work / NEW).iterdir()}
    (work / NEW / MANIFEST).write_text(manifest_text(fresh), encoding="utf-8")
    if inside:
        before = written(target)
        manifest = {MANIFEST: frozenset({digest(target / MANIFEST)})} if (target / MANIFEST).exists() else {}
        replace_files(work, target, {**before, **manifest}, before)
        return
    try:
        if os.path.lexists(target):  # a rename would replace an empty folder
            raise FileExistsError
        (work / NEW).rename(target)
    except OSError:
        if not os.path.lexists(target):
            raise
        raise InvalidInput(
            f"{target} was made by another program in the meantime and is unchanged; choose another folder"
        ) from None


def check_free(
    folder: str | Path, force: bool = False, expected: Mapping[str, bytes | None] = NOTHING
) -> Path:
    """Return the folder's path, or raise InvalidInput if `staged` would refuse it, before a long run."""
    try:
        target = Path(folder).absolute()
    except TypeError:
        raise InvalidInput(f"folder = {folder!r:.60} is not a path") from None
    if folder == "":
        raise InvalidInput('folder = "" is an empty name; name a new folder, such as "mine"')
    if "\0" in str(target):
        raise InvalidInput(f"{str(target)!r:.80} is not a path: it holds a null character")
    if not target.name:
        raise InvalidInput(f"{folder} cannot be a result folder; name a new one")
    if os.path.islink(target) and os.path.isdir(target):
        target = target.resolve()
    _usable(target, force, expected, held=False)
    return target


def _usable(target: Path, force: bool, expected: Mapping[str, bytes | None], held: bool) -> None:
    try:
        _check(target, force, expected, held)
    except OSError as error:
        raise InvalidInput(f"{target} cannot be used: {reason(error)}; choose another folder") from None


def _check(target: Path, force: bool, expected: Mapping[str, bytes | None], held: bool) -> None:
    if not target.parent.is_dir():
        raise InvalidInput(f"{target.parent} is not a folder; create it first")
    try:
        os.lstat(target)
    except FileNotFoundError:
        return
    if target.is_symlink() or not target.is_dir():
        raise InvalidInput(f"{target} is in the way and is not a folder; choose another name")
    sweep(target)
    if not held and (target / SUFFIX).exists():
        return  # another run may be replacing files; this is an error when the folder is claimed
    names = sorted(path.name for path in target.iterdir() if not path.name.endswith(SUFFIX))
    if names and MANIFEST not in names and not is_result_folder(target):
        more = "" if len(names) <= MOST_NAMED else f" and {len(names) - MOST_NAMED} more"
        raise InvalidInput(
            f"{target} holds files that metafem did not write ({', '.join(names[:MOST_NAMED])}{more}), so it "
            "is not replaced; choose another folder"
        )
    before = written(target)
    foreign = []
    for name in {*before, *expected} & set(names):
        content = expected.get(name)
        hashes = before.get(name, frozenset())
        if content is not None:
            hashes |= {hashlib.sha256(content).hexdigest()}
        if not unchanged(target / name, hashes):
            foreign.append(name)
    refuse_foreign(target, foreign, before)
    if names and not force:
        raise InvalidInput(f"{target} exists; choose another folder, or replace it with force=True")
