"""Drawing of the errors that explain a measured law, before and after the measurement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from metafem.drawing import ACHIEVED, QUIET, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def posteriors(ax: Axes, labels: Sequence[str], mean: FloatArray, sd: FloatArray) -> None:
    """Draw means and 68 % intervals of errors, in units of their prior standard deviations (grey band)."""
    rows = range(len(labels))
    ax.axvspan(-1.0, 1.0, color=QUIET, alpha=0.25, lw=0.0, label="expected, 68 %")
    ax.axvline(0.0, color=QUIET, lw=0.8)
    ax.errorbar(mean, list(rows), xerr=sd, fmt="o", ms=4, capsize=3, color=ACHIEVED, label="found, 68 %")
    ax.set_yticks(list(rows), list(labels))
    ax.set_ylim(len(labels) - 0.5, -0.5)
    reach = 1.15 * max(1.5, float((abs(mean) + sd).max()))
    ax.set_xlim(-reach, reach)
    ax.set_xlabel("error over its expected standard deviation")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)


def heights(ax: Axes, mean: FloatArray, sd: FloatArray, prior_sd: float) -> None:
    """Draw the errors of single heights [um] with 68 % intervals against the indices of the asperities."""
    ax.axhspan(-prior_sd, prior_sd, color=QUIET, alpha=0.25, lw=0.0)
    ax.axhline(0.0, color=QUIET, lw=0.8)
    ax.errorbar(range(len(mean)), mean, sd, fmt="o", ms=2.5, lw=1.0, color=ACHIEVED)
    ax.set_xlabel("asperity")
    ax.set_ylabel("error of its height [µm]")
