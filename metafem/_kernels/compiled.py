"""Compilation of kernels, stored on disk outside the package.

Numba's own cache has an index for all signatures of a function and identifies a function only by its source.
If two processes store two signatures at once, the index may name the code of the other signature, whose
results are wrong. Here each compiled signature is stored in one file, which is either complete or absent. The
names of the folder and of the file contain hashes of everything on which the machine code depends.
"""

from __future__ import annotations

import hashlib
import pickle
import platform
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from numba import njit
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.core.types import unliteral

from metafem import _caches

# Largest number of stored versions of the kernels. Each takes about 3 MB; every version of Python or of the
# sources has one.
MOST_VERSIONS = 8


def compiled(function, *, any_order=False):
    """Return a function that is compiled for each signature of its arguments, once per installation.

    any_order: whether sums may be evaluated in any order, which vector instructions need. The last bits of
    the results then depend on the processor.
    """
    # a product and a sum may be one instruction, which rounds once
    fast = {"contract", "reassoc"} if any_order else {"contract"}
    options: Any = {"nogil": True, "no_cfunc_wrapper": True, "fastmath": fast, "error_model": "numpy"}
    dispatcher: Any = njit(**options)(function)
    dispatcher._cache = _Kept(function)
    template = dispatcher.get_call_template
    # a call by another kernel with a constant then needs no version of its own
    dispatcher.get_call_template = lambda args, kws: template(tuple(map(unliteral, args)), kws)
    return dispatcher


# Decorator of kernels with one caller. Inlining takes less time than compiling and linking both functions.
inlined = njit(inline="always")


def version(package: Path) -> str:
    """Return a hash of all sources of a package, whose kernels call each other, and of library versions."""
    total = hashlib.sha256()
    for used in (platform.python_version(), numba.__version__, llvmlite.__version__, np.__version__):
        total.update(f"{used}\n".encode())
    for source in sorted(package.rglob("*.py")):
        total.update(f"{source.name} {source.stat().st_size}\n".encode())
        total.update(source.read_bytes())
    return total.hexdigest()[:32]


@lru_cache
def _version() -> str:
    return version(Path(__file__).parent)


def folder() -> Path:
    """Return the folder that stores this version of the kernels."""
    return _caches.kernel_folder() / _version()


# What is called once, when the first kernel is compiled because it was not stored.
_first: list[Callable[[], None]] = []


def on_first_compilation(callback: Callable[[], None]) -> None:
    """Call `callback` once, when the first kernel is compiled because it was not stored."""
    _first.append(callback)


class _Kept(NullCache):
    """Cache of one function's compiled signatures on disk; a signature without a file is compiled."""

    def __init__(self, function):
        self._name = f"{function.__module__}.{function.__qualname__}"

    def load_overload(self, signature, target_context):
        """Return the stored code of a signature, or None if no file exists."""
        target_context.refresh()
        with suppress(OSError):
            data = self._path(signature, target_context.codegen()).read_bytes()
            return CompileResult._rebuild(target_context, *pickle.loads(data))
        while _first:
            _first.pop()()
        return None

    def save_overload(self, signature, result):
        """Store the code of a signature, and remove the oldest versions of the kernels."""
        if result.library.has_dynamic_globals:  # contains addresses of this process
            return
        data = dumps(result._reduce())
        with suppress(OSError):
            path = self._path(signature, result.library.codegen)
            if not path.parent.is_dir():
                path.parent.mkdir(parents=True, exist_ok=True)
                _caches.remove_old_kernels(MOST_VERSIONS)
            _caches.write_whole(path, lambda file: file.write(data))

    def _path(self, signature, codegen):
        depends = f"{signature} {codegen.magic_tuple()}"  # includes the processor and its features
        return folder() / f"{self._name}-{hashlib.sha256(depends.encode()).hexdigest()[:32]}"
