"""Disk cache of the influence between the sites of a block."""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from metafem._caches import cache_folder, write_whole
from metafem._validate import FloatArray
from metafem.progress import message

# Source files that compute an influence, and the libraries that they use.
SOURCES = (*sorted(Path(__file__).parent.glob("*.py")), Path(__file__).parents[1] / "linear_solve.py")
LIBRARIES = ("numpy", "scipy")


@dataclass(frozen=True, eq=False)
class BlockInfluence:
    """Influence between the sites of a block, with error estimates."""

    # (n, n), displacement at site i per load P/E* on site j [1/mm]: symmetric, with the regular self terms
    matrix: FloatArray
    gradient_x: FloatArray  # (n, n), derivative of `matrix` by x of site i [1/mm^2]
    gradient_y: FloatArray
    laplacian: FloatArray  # (n, n) [1/mm^3]
    asymmetry: float  # largest difference between mirrored entries before averaging [1/mm]
    error_estimate: float  # largest change of an entry with cells 1.6 times as large [1/mm]: error bound
    residual: float  # largest relative residual of the linear solutions
    notes: tuple[str, ...] = ()  # whether the influence was computed or read, and disk errors

    def __post_init__(self) -> None:
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False


def cached(
    shape: tuple[float, ...], position: FloatArray, compute: Callable[[], BlockInfluence]
) -> BlockInfluence:
    """Return the influence between the sites of a block, read from disk or computed and stored.

    The file name is a hash of `shape`, the positions and the code. If the file cannot be read, the influence
    is computed again. If the file cannot be written, a note reports this.
    """
    try:
        path = _path(shape, position)
    except OSError as error:  # no home folder
        return _noted(compute(), f"not stored on disk: {error}")
    try:
        return _read(path)
    except FileNotFoundError:
        result = compute()
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        result = _noted(compute(), f"computed again: the stored file could not be read: {error}")
    try:
        _write(path, result)
    except OSError as error:
        message(f"the solution of the true block is not stored on disk: {error}")
        return _noted(result, f"not stored on disk: {error}")
    message(f"the solution of the true block is stored in {path}")
    return _noted(result, f"stored in {path}")


def is_cached(shape: tuple[float, ...], position: FloatArray) -> bool:
    """Return whether the influence of a block and its sites is stored on disk."""
    try:
        return _path(shape, position).is_file()
    except OSError:  # no home folder, or an unreadable folder
        return False


def _path(shape: tuple[float, ...], position: FloatArray) -> Path:
    key = hashlib.sha256(code_version() + np.array(shape).tobytes() + position.tobytes())
    return cache_folder() / f"block-{key.hexdigest()}.npz"


@lru_cache
def code_version() -> bytes:
    """Return a hash of the source files and library versions on which the influence depends."""
    parts = [path.read_bytes() for path in SOURCES]
    parts += [f"{library} {version(library)}".encode() for library in LIBRARIES]
    return hashlib.sha256(b"".join(parts)).digest()


def _noted(result: BlockInfluence, note: str) -> BlockInfluence:
    return replace(result, notes=(*result.notes, note))


def _read(path: Path) -> BlockInfluence:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        values: dict[str, Any] = {name: each if each.ndim else float(each) for name, each in stored.items()}
    return BlockInfluence(**{**values, "notes": (*values["notes"].tolist(), f"read from {path}")})


def _write(path: Path, result: BlockInfluence) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    values = {**vars(result), "notes": np.array(result.notes, dtype=np.str_)}
    write_whole(path, lambda file: np.savez(file, **values))
