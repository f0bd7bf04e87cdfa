"""Convolutions on grids that are padded with zeros, one block of columns at a time.

The padded grid is stored only along its rows, and transformed along its columns block by block.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fft, ifft, irfft, rfft

Array = NDArray[np.inexact]

# Number of elements of a block; its transforms fit into the caches of usual processors.
BLOCK = 2**18


def convolve(
    sources: Sequence[Array],
    spectra: Callable[[slice], Sequence[Sequence[Array]]],
    padded: tuple[int, int],
    waves: int,
    threads: int,
) -> list[Array]:
    """Return convolutions of grids (rows, columns) with kernels, on the same grid.

    spectra: returns, for a slice of the first `waves` wavenumbers along the rows, the kernels' transforms on
    the padded grid: for each result one for each source. The transforms of larger wavenumbers are zero.
    """
    rows, columns = sources[0].shape
    along = [rfft(source, padded[1], axis=1, workers=threads)[:, :waves] for source in sources]
    results: list[Array] = []
    step = max(1, BLOCK // padded[0])
    for start in range(0, waves, step):
        block = slice(start, min(start + step, waves))
        parts = [fft(part[:, block], padded[0], axis=0, workers=threads) for part in along]
        for k, line in enumerate(spectra(block)):
            total = parts[0] * line[0]
            for part, spectrum in zip(parts[1:], line[1:], strict=True):
                total += part * spectrum
            if len(results) == k:
                results.append(np.empty((rows, waves), dtype=total.dtype))
            results[k][:, block] = ifft(total, axis=0, overwrite_x=True, workers=threads)[:rows]
    return [irfft(part, padded[1], axis=1, workers=threads)[:, :columns] for part in results]
