"""Figures of laws and surfaces, drawn by matplotlib into axes or into self-contained SVG."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from metafem.law import FrictionLaw


def plot_law(law: FrictionLaw, ax: Axes | None = None, label: str | None = None) -> Axes:
    """Draw rescaled friction over rescaled load and return the axes."""
    if ax is None:
        from matplotlib import pyplot as plt

        ax = plt.figure().add_subplot()
    ax.plot(law.rescaled_load, law.rescaled_friction, label=label)
    ax.set_xlabel("rescaled load P/E* [mm²]")
    ax.set_ylabel("rescaled friction F/(σB) [mm²]")
    return ax
