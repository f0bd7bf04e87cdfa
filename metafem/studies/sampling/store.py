"""Finished batches of a run, stored in a folder with the hash of everything they depend on."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from metafem._caches import write_whole
from metafem.errors import InvalidInput, refuse_if
from metafem.progress import message

Result = dict[str, np.ndarray]

# Name of the file that identifies the run in a folder.
RECORD = "run.json"


def own_version() -> str:
    """Return the version of metafem."""
    try:
        return version("metafem")
    except PackageNotFoundError:  # metafem runs from its sources
        return "not installed"


def inputs_hash(value: Any) -> str:
    """Return a hash of values, arrays and dataclasses that is the same in every process.

    Examples
    --------
    >>> inputs_hash((1, "a", np.zeros(2))) == inputs_hash((1, "a", np.zeros(2)))
    True
    """
    total = hashlib.sha256()
    _add(total, value)
    return total.hexdigest()[:32]


def _add(total: Any, value: Any) -> None:
    """Add a value to a hash."""
    total.update(f"<{type(value).__module__}.{type(value).__qualname__}>".encode())
    if isinstance(value, np.ndarray):
        total.update(f"{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif is_dataclass(value):
        for field in fields(value):
            _add(total, (field.name, getattr(value, field.name)))
    elif isinstance(value, Mapping):
        _add(total, sorted(value.items()))
    elif isinstance(value, (tuple, list)):
        total.update(str(len(value)).encode())
        for member in value:
            _add(total, member)
    else:  # the repr of numbers, texts and a user's models states their values
        total.update(repr(value).encode())


@dataclass(eq=False)
class Store:
    """The folder of a run, which holds its finished batches."""

    folder: Path
    full: bool = False

    @staticmethod
    def opened(folder: Path, study: str, inputs: str) -> Store:
        """Return the store of a run in a new folder, an empty folder or its own folder; refuse others."""
        record = {"study": study, "metafem": own_version(), "inputs": inputs}
        path = folder / RECORD
        try:
            folder.mkdir(parents=True, exist_ok=True)
            found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
            others = [other for other in folder.iterdir() if not other.name.startswith(f".{RECORD}")]
            if found is None and not others:
                write_whole(path, lambda file: file.write(json.dumps(record, indent=1).encode()))
        except (OSError, ValueError) as error:
            raise InvalidInput(f"folder = {folder} cannot be used: {error}") from None
        other = found is None and others
        refuse_if(other, f"folder = {folder} holds other files; choose an empty or a new folder")
        if found is not None and found != record:
            raise InvalidInput(
                f"folder = {folder} holds another run, {_apart(found, record)}; choose another folder"
            )
        return Store(folder)

    def read(self, batch: int) -> Result | None:
        """Return a finished batch, or None if it is missing or cannot be read."""
        try:
            with np.load(self._path(batch), allow_pickle=False) as kept:
                return dict(kept)
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            return None

    def write(self, batch: int, result: Result) -> None:
        """Store a batch. If writing fails, as on a full disk, later batches are not stored."""
        if self.full:
            return
        arrays: dict[str, Any] = dict(result)
        try:
            write_whole(self._path(batch), lambda file: np.savez_compressed(file, **arrays))
        except OSError as error:
            self.full = True
            message(f"batches are no longer kept in {self.folder}: {error.strerror or error}")

    def _path(self, batch: int) -> Path:
        return self.folder / f"batch-{batch:08d}.npz"


def _apart(found: Any, record: Mapping[str, str]) -> str:
    """Return a text on how the run in a folder differs from this run."""
    kept = found if isinstance(found, dict) else {}
    words = ("of the study {}", "of metafem {}", "with other inputs")
    pairs = zip(record, words, strict=True)
    return next(text.format(kept.get(name)) for name, text in pairs if kept.get(name) != record[name])
