"""How the seconds of one load grow with the number of asperities, on lattices and at scattered sites."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
import metafem.substrate
from metafem.drawing import ACHIEVED, TARGET, new_figure
from metafem.models.interacting.model import DENSE_LIMIT
from validation.check import Claim, Picture, Row, reported
from validation.cost.times import exponent, floor, machine, renewed, repeated, rounded
from validation.scenes.costs import MATERIAL, heights, scattered
from validation.timing import took

# Rows of the lattices; scattered sites are as many. The last lattice is solved once.
SIDES, LARGEST = (8, 16, 32, 64, 100, 178, 316), 1000

SUBSTRATES = {"half-space": mf.HalfSpace(), "layer": mf.BondedLayer(7.2)}

# Rescaled load per asperity at which two thirds of them touch [mm²].
LOAD_PER_ASPERITY = 0.003

# Of the scattered sites, colour and marker.
STYLES = {"lattice": (ACHIEVED, "s"), "scattered": (TARGET, "o")}

METHOD = "one load by order 1, median of three or more runs, rounded to 1, 2 or 5"
FIT = f"fitted to the times of all runs above {DENSE_LIMIT} asperities"


@dataclass(frozen=True)
class Series:
    """Numbers of asperities and the seconds of each run of one load."""

    counts: tuple[int, ...]
    seconds: tuple[tuple[float, ...], ...]

    def fit(self) -> tuple[float, float, float]:
        """Exponent, its standard error and the factor, above the size that is solved with dense matrices."""
        pairs = [
            (count, each)
            for count, times in zip(self.counts, self.seconds, strict=True)
            for each in times
            if count > DENSE_LIMIT
        ]
        return exponent(*zip(*pairs, strict=True))

    def median(self, count: int) -> float:
        """Median seconds at a number of asperities."""
        return statistics.median(self.seconds[self.counts.index(count)])


def lattice(side: int) -> mf.Surface:
    """Return a square lattice of `side` rows with random heights."""
    return mf.Surface.square_lattice(heights(side**2), (side, side), radius=0.526, material=MATERIAL)


def surface(sites: str, side: int) -> mf.Surface:
    """Return as many asperities on a lattice, or at scattered sites."""
    return lattice(side) if sites == "lattice" else scattered(side**2)


@cache
def series(sites: str, substrate: str) -> Series:
    """Measure one load for each number of asperities."""
    model = mf.Interacting(order=1, substrate=SUBSTRATES[substrate])
    for side in (SIDES[0], 50):  # so that both ways of solving are compiled
        _load(surface(sites, side), model)
    found = []
    for side in SIDES:
        known = surface(sites, side)
        # however long: never one run alone
        times, _ = repeated(lambda run, known=known: _load(renewed(known, run), model), math.inf)
        found.append(tuple(times))
    return Series(tuple(side**2 for side in SIDES), tuple(found))


@cache
def largest() -> float:
    """Seconds of one load of the largest lattice on a half-space."""
    return _load(lattice(LARGEST), mf.Interacting(order=1))


def measure() -> Claim:
    """One load of a new surface by order 1, two thirds of whose asperities touch. Up to {dense:,} asperities
    all pairs are in dense matrices. Above, the sums are made by fast Fourier transforms, on lattices directly
    and at scattered sites by Ewald's method. {machine}
    """
    rows: list[Row] = []
    for substrate in SUBSTRATES:
        for sites in STYLES:
            measured = series(sites, substrate)
            growth, error, _ = measured.fit()
            name = f"{sites}, {substrate}"
            rows += [
                reported(f"{name}: exponent of the time", round(growth, 2), FIT),
                reported(f"{name}: standard error of the exponent", round(error, 2), FIT),
            ]
            for count in (SIDES[0] ** 2, SIDES[-1] ** 2):
                seconds = rounded(measured.median(count))
                rows.append(reported(f"{name}, {count:,} asperities, one load [s]", seconds, METHOD))
    name = f"lattice, half-space, {LARGEST**2:,} asperities [s]"
    rows.append(reported(name, rounded(largest()), "Interacting(order=1), one run, rounded to 1, 2 or 5"))
    values = {"dense": DENSE_LIMIT, "machine": machine()}
    return Claim("Seconds against the number of asperities", rows, {"growth": Picture(_growth)}, values)


def _load(surface: mf.Surface, model: mf.Interacting) -> float:
    """Seconds of one load."""
    load = LOAD_PER_ASPERITY * surface.count * MATERIAL.composite_modulus
    return took(lambda: mf.equilibrium(surface, model, load=load))[0]


def _growth():
    """Medians of three or more runs, with bars from the fastest to the slowest, and fitted powers. Left of
    the dotted line all pairs are in dense matrices. Dashed line: numpy reads a dense matrix of all pairs once
    and sums its rows (time to read all pairs once). Open symbol: the lattice of 1,000,000 asperities, one
    run.
    """
    # one column: readable on a narrow screen
    figure = new_figure(6.0, 8.0)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for ax, substrate in zip(panels, SUBSTRATES, strict=True):
        for sites, (colour, marker) in STYLES.items():
            measured = series(sites, substrate)
            counts = np.array(measured.counts)
            growth, error, factor = measured.fit()
            large = counts[counts > DENSE_LIMIT]
            median = [measured.median(count) for count in measured.counts]
            low, high = (
                [abs(end(times) - middle) for times, middle in zip(measured.seconds, median, strict=True)]
                for end in (min, max)
            )
            ax.errorbar(counts, median, [low, high], fmt=marker, ms=6, color=colour, capsize=2,
                        label=f"{sites}: N to the power {growth:.2f} ± {error:.2f}")  # fmt: skip
            ax.plot(large, factor * large**growth, lw=1, color=colour)
        if substrate == "half-space":
            colour, marker = STYLES["lattice"]
            ax.plot(LARGEST**2, largest(), marker, lw=0, ms=6, mfc="none", color=colour,
                    label=f"lattice of {LARGEST**2:,}, one run")  # fmt: skip
        pairs = [floor(count) for count in series("lattice", substrate).counts]
        ax.plot(counts, pairs, "--", lw=0.8, color="grey", label="time to read all pairs once")
        ax.axvline(DENSE_LIMIT, lw=0.8, ls=":", color="grey")
        ax.set_title(substrate, fontsize=10)
        ax.set_xlabel("number of asperities N")
        ax.set_ylabel("seconds for one load, order 1")
        ax.loglog()
        ax.legend(frameon=False, fontsize=8, loc="upper left")
    return figure
