"""Compile Newton's method for interacting asperities in another process, beside other work of this one."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
from numba import typeof

from metafem._kernels import compiled
from metafem._kernels.contact.tabulated import Law
from metafem._kernels.continuation import empty_workspace
from metafem._kernels.coupling import Coupling
from metafem._kernels.interacting import newton


def start() -> None:
    """Let another process compile what takes longest, unless this version of the kernels has it already."""
    if not compiled.stored(newton.py_func):
        command = [sys.executable, "-m", __name__]
        quiet = subprocess.DEVNULL
        compiled.wait_for(newton.py_func, subprocess.Popen(command, stdout=quiet, stderr=quiet))


def compile_newton() -> None:
    """Compile `newton` and all that it calls."""
    matrix, vector = np.empty((1, 1)), np.empty(1)
    coupling, law = Coupling(*[matrix] * 7), Law(vector, np.empty(1, np.int64), vector, matrix)
    state, _, scratch = empty_workspace(1, 3)
    newton.compile(tuple(map(typeof, (coupling, 3, law, vector, vector, 0.0, 0.0, state, scratch))))


if __name__ == "__main__":
    compile_newton()
