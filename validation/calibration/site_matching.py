"""Contacts of a lattice matched to its sites with open contacts, rotation, scale and spurious regions."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.calibration import match_sites
from metafem.drawing import ACHIEVED, QUIET, TARGET
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.scenes.lattice_views import lattice, seen, trial
from validation.sources import known_input

# The tests of this claim carry the mark "slow".
SLOW = True

TRIALS, ROW_TRIALS = 250, 40

# Standard deviation of the centres in the trials [mm].
NOISE = 5e-3

# Lattices of another pitch [mm], and the number of their sites along a side.
OTHERS = ((0.75, 8), (1.0, 8), (1.2, 8), (1.3, 8), (2.0, 8), (3.0, 8), (1.5, 12))


SITES = known_input("sites from which the synthetic views were made: no view may have a wrong one")
TWO_PLACES = known_input(
    "views that match equally well after a shift by one pitch: all must be named ambiguous"
)
ANOTHER = known_input("views of other lattices: all must be refused")
ERROR = known_input("normal error of the centres of 5 µm along x and y, of which 4 of 90 numbers are fitted")


def claim() -> Claim:
    """Before each area of real contact can be compared with that of the design, each contact in the image
    must be given its site. In these views 30 % of the contacts are open, the camera is turned by up to 5°,
    the scale is wrong by up to 10 %, the centres have errors of 5 µm, and four regions are no contacts. Every
    contact was given its right site. Where two places match equally well the result says so.
    """
    sites = lattice()
    wrong, residual = {}, []
    for mirrored, count in ((False, TRIALS), (True, TRIALS // 5)):
        wrong[mirrored] = 0
        for seed in range(count):
            centre, site = trial(seed, noise=NOISE, mirrored=mirrored)
            found = match_sites(centre, sites, viewed_from="block" if mirrored else "glass")
            wrong[mirrored] += not np.array_equal(found.site, site)
            residual.append(found.residual)
    expected, found = NOISE * np.sqrt(2.0 * (1.0 - 4.0 / 90.0)), float(np.sqrt(np.mean(np.square(residual))))
    rows = [
        below(f"{TRIALS} views through the glass: views with a wrong site", wrong[False], 0, SITES),
        below(f"{TRIALS // 5} views through the block: views with a wrong site", wrong[True], 0, SITES),
        near("root mean square distance from the sites [mm]", found, expected, 0.02 * expected, ERROR),
        *_open_rows(sites),
        *_other_lattices(sites),
    ]
    return Claim("Matching of contacts to sites", rows, {"a view matched to the sites": Picture(_figure)})


def _open_rows(sites: np.ndarray) -> list[Row]:
    """An outer row is open: two places match equally well."""
    unsaid = 0
    for seed in range(ROW_TRIALS):
        centre, _ = trial(seed, contacts=39, rows=7, noise=NOISE, spurious=0)
        unsaid += not match_sites(centre, sites).ambiguous
    return [below(f"{ROW_TRIALS} views with an outer row open: ambiguity not said", unsaid, 0, TWO_PLACES)]


def _other_lattices(sites: np.ndarray) -> list[Row]:
    accepted = 0
    for pitch, side in OTHERS:
        try:
            match_sites(seen(lattice((side, side), pitch), turn=0.03), sites)
            accepted += 1
        except mf.InvalidInput:
            pass
    # what cannot be told apart: five by five sites of the same pitch are a part of the lattice
    part = match_sites(seen(lattice((5, 5)), turn=0.03), sites)
    name, words = (
        "part of the lattice, 5 × 5 sites: ambiguous (1) or not (0)",
        "25 neighbouring sites of the 64",
    )
    return [
        below(f"{len(OTHERS)} other lattices: accepted", accepted, 0, ANOTHER),
        reported(name, part.ambiguous, f"match_sites on {words}"),
    ]


@panels(5.6, 4.6, subplot_kw={"aspect": "equal"})
def _figure(ax) -> None:
    """The first synthetic view, turned, scaled and shifted onto the lattice by the match. Each circle must
    lie in a square; squares without a circle are open contacts; crosses are regions that are no contacts.
    """
    sites = lattice()
    centre, true = trial(0, noise=NOISE)
    found = match_sites(centre, sites).site
    matched = found >= 0
    # the similarity between the views and the sites, as a complex factor and shift
    image, plane = (each[:, 0] + 1j * each[:, 1] for each in (centre, sites))
    columns = np.stack([image[matched], np.ones(matched.sum())], axis=1)
    (factor, shift), *_ = np.linalg.lstsq(columns, plane[found[matched]], rcond=None)
    moved = factor * image + shift
    ax.plot(*sites.T, "s", mfc="none", ms=11, color=QUIET, label="sites of the lattice")
    ax.plot(moved[matched].real, moved[matched].imag, "o", ms=4, color=ACHIEVED, label="contacts with a site")
    ax.plot(moved[~matched].real, moved[~matched].imag, "x", color=TARGET, label="regions without a site")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")
    ax.set_title(f"{np.count_nonzero(found != true)} of {len(true)} regions with a wrong site", fontsize=10)
    ax.figure.legend(frameon=False, loc="outside lower center", ncols=3, fontsize=8)
