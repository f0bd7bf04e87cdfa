"""Disk cache: compiled kernels and influence matrices of blocks."""

from __future__ import annotations

import os
import re
import shutil
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

# Environment variable that sets the folder of all caches; default: metafem's folder in the user's cache
# folder.
VARIABLE = "METAFEM_CACHE_DIR"

# Name of a folder of compiled kernels; others are never removed.
_KERNELS = re.compile(r"[0-9a-f]{32}")


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
    with suppress(FileNotFoundError, NotADirectoryError):
        found = [path for path in kernel_folder().iterdir() if _KERNELS.fullmatch(path.name)]
        return sorted(found, key=_time, reverse=True)
    return []


def remove_old_kernels(kept: int) -> None:
    """Remove compiled kernels but the newest; other processes that use them compile them again."""
    for path in kept_kernels()[kept:]:
        shutil.rmtree(path, ignore_errors=True)


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


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:  # another process has removed it
        return 0.0
