"""The cache on disk: compiled kernels, the influence of blocks and the batches of stopped studies."""

from __future__ import annotations

import os
import re
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

# Environment variable with the folder of all caches; default: the user's cache folder.
VARIABLE = "METAFEM_CACHE_DIR"

# Names of the files that metafem writes there; other files are never removed.
_KERNELS = _STUDY = re.compile(r"[0-9a-f]{32}")
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
    """Return the folder with one folder of compiled kernels for each version of their sources."""
    return cache_folder() / "kernels"


def kept_kernels() -> list[Path]:
    """Return the folders of compiled kernels, the most recently used first."""
    return sorted(_children(kernel_folder(), _KERNELS), key=_time, reverse=True)


def kept_blocks() -> list[Path]:
    """Return the files with the influence of a block."""
    return sorted(_children(cache_folder(), _BLOCK))


def study_folder() -> Path:
    """Return the folder with one folder of finished batches for each stopped study."""
    return cache_folder() / "studies"


def kept_studies() -> list[Path]:
    """Return the folders with the finished batches of stopped studies."""
    return sorted(_children(study_folder(), _STUDY))


def size(paths: list[Path]) -> int:
    """Return the size of files and of all files in folders [bytes]."""
    return sum(_size(path) for path in paths) + sum(
        _size(Path(folder, file)) for path in paths for folder, _, files in os.walk(path) for file in files
    )


def remove(paths: list[Path]) -> int:
    """Remove files and folders, and return the freed size [bytes].

    Other processes may use the same files at any time: each file is complete or absent, and the content of
    absent files is computed again.
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
    """Write a file under a hidden name and rename it, so that it is complete or absent."""
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


def _size(path: Path) -> int:
    try:
        return path.stat().st_size if path.is_file() else 0
    except OSError:
        return 0
