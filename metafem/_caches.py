"""Disk cache: compiled kernels and influence matrices of blocks."""

from __future__ import annotations

import os
import re
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

# Environment variable that sets the folder of all caches; default: metafem's folder in the user's cache
# folder.
VARIABLE = "METAFEM_CACHE_DIR"

# Names of the files and folders that metafem writes to the cache; others are never removed.
_KERNELS = re.compile(r"[0-9a-f]{32}")
_BLOCK = re.compile(r"\.?block-.*\.npz.*")


def cache_folder() -> Path:
    """Return ``$METAFEM_CACHE_DIR``, or metafem's folder in the user's cache folder.

    Raise OSError if the user has no home folder and the variable is not set.
    """
    stated = os.environ.get(VARIABLE)
    if stated:
        return Path(stated).absolute()
    from platformdirs import user_cache_path

    folder = user_cache_path("metafem")
    if not folder.is_absolute():
        raise OSError(f"there is no home folder for a cache; set {VARIABLE} to a folder")
    return folder


def kernel_folder() -> Path:
    """Return the folder of compiled kernels; it has a subfolder for each version of their sources."""
    return cache_folder() / "kernels"


def kept_kernels() -> list[Path]:
    """Return the subfolders of compiled kernels, newest first."""
    return sorted(_children(kernel_folder(), _KERNELS), key=_time, reverse=True)


def kept_blocks() -> list[Path]:
    """Return the files that store the influence matrices of blocks."""
    return sorted(_children(cache_folder(), _BLOCK))


def size(paths: list[Path]) -> int:
    """Return the total size of files, and of all files in folders [bytes]."""
    total = 0
    for file in (file for path in paths for file in (path, *path.rglob("*"))):
        with suppress(OSError):  # another process has removed it
            total += file.stat().st_size if file.is_file() else 0
    return total


def remove(paths: list[Path]) -> int:
    """Remove files and folders, and return the freed size [bytes].

    This is safe while other processes use the cache: each file is either complete or absent, and a process
    that finds no file computes its content again.
    """
    before = size(paths)
    for path in paths:
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            with suppress(OSError):
                path.unlink()
    return before - size(paths)


def write_whole(path: Path, write: Callable[[BinaryIO], Any]) -> None:
    """Write a file under a temporary hidden name, then rename it, so that it is complete or absent."""
    fresh = path.with_name(f".{path.name}-{os.getpid()}-{threading.get_ident()}")
    try:
        with fresh.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)


def _children(folder: Path, name: re.Pattern[str]) -> Iterator[Path]:
    with suppress(FileNotFoundError, NotADirectoryError):
        yield from (path for path in folder.iterdir() if name.fullmatch(path.name))


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:  # another process has removed it
        return 0.0
