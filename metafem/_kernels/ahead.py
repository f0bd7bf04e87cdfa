"""Compile Newton's method for interacting asperities in another process, beside other work of this one."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
from numba import typeof

from metafem._kernels import compiled
from metafem._kernels.curve import curves
from metafem._kernels.equations import Coupling, State
from metafem._kernels.law import hertz_law


def start() -> None:
    """Let another process compile what takes longest, unless this version of the kernels has it already."""
    if not compiled.stored(curves.py_func):
        command = [sys.executable, "-m", __name__]
        quiet = subprocess.DEVNULL
        compiled.wait_for(curves.py_func, subprocess.Popen(command, stdout=quiet, stderr=quiet))


def compile_curves() -> None:
    """Compile `curves` and all that it calls."""
    matrix, vector = np.empty((1, 1)), np.empty(1)
    coupling, law = Coupling(matrix, matrix), hertz_law(matrix)
    work, found = State(1), np.empty((7, 1, 1))
    given = coupling, 3, law, matrix, matrix, vector, True, found, work.block, work.closed, matrix, matrix
    curves.compile(tuple(map(typeof, given)))


if __name__ == "__main__":
    compile_curves()
