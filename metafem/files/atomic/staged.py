"""A result folder is there whole or not at all."""

from __future__ import annotations

import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from metafem.errors import InvalidInput
from metafem.files.reading import read_record

# First member of a design.json, by which a folder is known as one of ours.
FORMAT = "metafem design 1"


@contextmanager
def staged(folder: str | Path, force: bool = False) -> Iterator[Path]:
    """Yield a temporary folder that becomes `folder` when the body ends without an error.

    It stands beside `folder` and is removed if the body fails. An existing folder is refused, unless
    `force` is true and it is empty or a result folder; it is then replaced once the new one is whole.

    Raises
    ------
    InvalidInput
        If the folder exists, or cannot be written; nothing is left behind.
    """
    target = check_free(folder, force)
    token = secrets.token_hex(4)
    fresh = target.with_name(f".{target.name}.{token}.new")
    try:
        fresh.mkdir()
    except OSError as error:
        raise InvalidInput(f"{target} cannot be written: {error.strerror}; choose another folder") from None
    try:
        yield fresh
        _swap(fresh, target, target.with_name(f".{target.name}.{token}.old"))
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def check_free(folder: str | Path, force: bool = False) -> Path:
    """Raise InvalidInput if `staged` would refuse the folder: worth knowing before a long run."""
    try:
        target = Path(folder).absolute()
    except TypeError:
        raise InvalidInput(f"folder = {folder!r:.60} is not a path") from None
    if "\0" in str(target):
        raise InvalidInput(f"{str(target)!r:.80} is not a path: it holds a null character")
    if not target.name:
        raise InvalidInput(f"{folder} cannot be a result folder; name a new one")
    try:
        _check(target, force)
    except OSError as error:
        raise InvalidInput(f"{target} cannot be used: {error.strerror}; choose another folder") from None
    return target


def _check(target: Path, force: bool) -> None:
    if not target.parent.is_dir():
        raise InvalidInput(f"{target.parent} is not a folder; create it first")
    if not target.exists() and not target.is_symlink():
        return
    if target.is_symlink() or not target.is_dir():
        raise InvalidInput(f"{target} is in the way and is not a folder; choose another name")
    if not force:
        raise InvalidInput(f"{target} exists; choose another folder, or replace it with force=True")
    if not (is_result_folder(target) or not any(target.iterdir())):
        raise InvalidInput(
            f"{target} holds no design.json of metafem, so it is not replaced; choose another folder"
        )


def is_result_folder(folder: Path) -> bool:
    """Whether the folder holds a design.json of ours."""
    try:
        record = read_record(folder / "design.json")
    except InvalidInput:
        return False
    return isinstance(record, dict) and record.get("format") == FORMAT


def _swap(fresh: Path, target: Path, old: Path) -> None:
    """Put the fresh folder in the target's place; where that fails, the old one stays."""
    try:
        if target.exists():
            target.rename(old)
        try:
            fresh.rename(target)
        except OSError:
            if old.exists():
                old.rename(target)
            raise
    except OSError as error:
        raise InvalidInput(f"{target} cannot be written: {error.strerror}; choose another folder") from None
    shutil.rmtree(old, ignore_errors=True)
