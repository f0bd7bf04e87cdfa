"""Areas of resolved contacts, extrapolated to vanishing cells."""

from __future__ import annotations

import numpy as np
from scipy.stats import linregress
from scipy.stats import t as student

import metafem as mf
from metafem.contact import Contact
from metafem.models.model import PARABOLOID
from metafem.substrate import Radial

# Cells of the reference: the largest contact radius over the first number, then smaller by the fourth root of
# 2 each, at least and at most so many sizes; and the probability that the area is within its uncertainty.
CELLS_PER_RADIUS, FEWEST, MOST = 24, 7, 13
CONFIDENCE = 0.95


def extrapolated_area(
    surface: mf.Surface,
    load: float,
    uncertainty: float,
    law: Contact = PARABOLOID,
    substrate: Radial | None = None,
    first: int = CELLS_PER_RADIUS,
    sizes: tuple[int, int] = (FEWEST, MOST),
) -> tuple[float, float]:
    """Return A0 [mm²] under a load [N] and its relative uncertainty, with cells until that is small enough.

    The mean error of the areas is proportional to the square of the cell. About it they scatter by some
    cells, as each cell at the edge of a contact is either open or closed. So A0 is fitted over the square of
    the cell by least squares, with errors proportional to that square. The cells become smaller until the
    confidence interval of the fit is within the wanted uncertainty.
    """
    largest = mf.equilibrium(surface, mf.Independent(law), load=load).asperity_area.max()
    cells = np.sqrt(largest / np.pi) / first * 2.0 ** (-0.25 * np.arange(sizes[1]))
    areas: list[float] = []
    for cell in cells:
        model = mf.BoundaryElements(cell, mf.HalfSpace() if substrate is None else substrate, law)
        areas.append(mf.equilibrium(surface, model, load=load).area)
        used = len(areas)
        if used >= sizes[0]:
            # A0/cell² = slope/cell² + constant, with errors of one size
            fit = linregress(cells[:used] ** -2.0, areas * cells[:used] ** -2.0)
            half_width = student.ppf(0.5 + 0.5 * CONFIDENCE, used - 2) * fit.stderr
            if half_width <= uncertainty * fit.slope:
                break
    return float(fit.slope), float(half_width / fit.slope)
