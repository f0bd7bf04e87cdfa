"""Influence between the sites of a block, stored on disk."""

from __future__ import annotations

import ast
import hashlib
import os
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from metafem._caches import cache_folder
from metafem._validate import FloatArray
from metafem.progress import message

# Modules that compute an influence, and the libraries they rely on.
SOURCES = tuple(
    f"metafem.fe.{name}"
    for name in (
        *(f"block3d.{part}" for part in ("boussinesq", "elasticity", "faces", "grading", "influence")),
        *("block3d.line_elements", "linear_solve"),
    )
)
LIBRARIES = ("numpy", "scipy", "scikit-fem")


@dataclass(frozen=True, eq=False)
class BlockInfluence:
    """Influence between the sites of a block, with its errors."""

    # (n, n), displacement at site i per load P/E* on site j [1/mm], symmetric; regular self terms
    matrix: FloatArray
    gradient_x: FloatArray  # (n, n), its derivatives in the plane at i [1/mm^2]
    gradient_y: FloatArray
    laplacian: FloatArray  # (n, n) [1/mm^3]
    asymmetry: float  # largest difference between mirrored entries before averaging [1/mm]
    error_estimate: float  # largest change of an entry against cells 1.6 times as large [1/mm]: error bound
    residual: float  # largest relative residual of the linear solutions
    notes: tuple[str, ...] = ()  # whether it was computed or read, and disk errors

    def __post_init__(self) -> None:
        for name in _ARRAYS:
            getattr(self, name).flags.writeable = False


_ARRAYS = ("matrix", "gradient_x", "gradient_y", "laplacian")
_NUMBERS = ("asymmetry", "error_estimate", "residual")


def cached(
    shape: tuple[float, ...], position: FloatArray, compute: Callable[[], BlockInfluence]
) -> BlockInfluence:
    """Read the influence of a block and its sites, or compute and store it.

    The file name is a hash of the numbers `shape`, the positions and the code. If the file cannot be read,
    the influence is computed again; if it cannot be written, a note says so.
    """
    try:
        path = _path(shape, position)
    except OSError as error:  # no home folder
        return _noted(compute(), f"not stored on disk: {error}")
    try:
        return _read(path, len(position))
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
    """Return whether there is a file for a block and its sites."""
    try:
        return _path(shape, position).is_file()
    except OSError:  # no home folder, or one that cannot be read
        return False


def _path(shape: tuple[float, ...], position: FloatArray) -> Path:
    key = hashlib.sha256(code_version())
    key.update(np.array(shape).tobytes())
    key.update(position.tobytes())
    return cache_folder() / f"block-{key.hexdigest()}.npz"


@lru_cache
def code_version() -> bytes:
    """Return a hash of the code and of the versions of the libraries that the numbers depend on."""
    total = hashlib.sha256()
    for name in SOURCES:
        spec = find_spec(name)
        if spec is None or spec.origin is None:
            raise ImportError(f"{name} has moved; correct its name in {__name__}.SOURCES")
        total.update(statements(Path(spec.origin).read_text(encoding="utf-8")).encode())
    for library in LIBRARIES:
        total.update(f"{library} {version(library)}".encode())
    return total.digest()


def statements(source: str) -> str:
    """Return the syntax tree of a source without comments, docstrings and line numbers."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if (
            isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
            and ast.get_docstring(node) is not None
        ):
            del node.body[0]
    return ast.dump(tree)


def _noted(result: BlockInfluence, note: str) -> BlockInfluence:
    return replace(result, notes=(*result.notes, note))


def _read(path: Path, n: int) -> BlockInfluence:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        influence, number, notes = (stored[each] for each in ("influence", "number", "notes"))
    if influence.shape != (len(_ARRAYS), n, n) or number.shape != (len(_NUMBERS),):
        raise ValueError(f"{path} holds arrays of shape {influence.shape} and {number.shape}")
    values = dict(zip((*_ARRAYS, *_NUMBERS), (*influence, *number.tolist()), strict=True))
    return BlockInfluence(**values, notes=(*notes.tolist(), f"read from {path}"))


def _write(path: Path, result: BlockInfluence) -> None:
    """Write a temporary file and rename it, so that no process reads an incomplete file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".block-", suffix=".npz")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(
                file,
                influence=np.stack([getattr(result, each) for each in _ARRAYS]),
                number=np.array([getattr(result, each) for each in _NUMBERS]),
                notes=np.array(result.notes, dtype=np.str_),
            )
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
