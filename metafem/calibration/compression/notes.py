"""Notes on a calibration of contacts."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from metafem._given import Given
from metafem._values import percent
from metafem.calibration.compression.data import FEWEST
from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.contact_table import listed
from metafem.calibration.magnitude import OFF, unit_hint, within_errors
from metafem.calibration.resampling import Bootstrap
from metafem.calibration.verdict import chance
from metafem.contact import Contact, TabulatedContact
from metafem.notes import ArgumentNote, Level, Note, information

# Weight in a robust fit below which a point is an outlier (beyond 2.5 standard deviations), and the share of
# outliers above which the law is in doubt.
OUTLYING, MANY_OUTLIERS = 0.5, 0.1

# Largest E* of elastomers and gels [MPa]; the contact radius over R at which the mean pressure of Hertz,
# ``4/(3 pi) E* a/R``, is a tenth of E*: about the strength of a perfect solid, the largest of all.
STIFF, MEAN_PRESSURE = 300.0, 4.0 / (3.0 * math.pi)
WIDEST_STIFF = 0.1 / MEAN_PRESSURE

# Contact radius over R beyond which large strain changes the law. Up to there the load of a soft cap
# (neo-Hookean, incompressible) is 1 to 4 % below Hertz's, and at 0.76 R from 2 % below to 1 % above it,
# depending on the height of the cap: tables of finite elements, meshes/deep_caps.csv.
KNOWN = 0.5


def notes_of(found: ContactCalibration, cap: Contact, bootstrap: Bootstrap | None) -> Iterator[Note]:
    """Return notes on range, adhesion, fit and tests."""
    contacts = 1 if found.area.ndim == 2 else found.contacts
    widest = math.sqrt(float(found.area.max()) / contacts / math.pi) / found.radius
    table = isinstance(cap, TabulatedContact)
    if widest > KNOWN and not table:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads, or use the table of "
            "metafem.fe.tabulated_contact as the contact law"
        )
    yield from within_errors("load", found.load, found.load_sd)
    yield from within_errors("area", found.total_area, found.total_area_sd)
    modulus = found.composite_modulus
    if modulus > STIFF and widest > WIDEST_STIFF:
        yield Note(
            f"E* = {modulus:.4g} MPa, but contact radii reach {widest:.2f} R, where the mean pressure is "
            f"{MEAN_PRESSURE * widest:.2g} E*: only elastomers and gels, of less than {STIFF:g} MPa, "
            f"remain elastic there; {unit_hint('load', OFF)}"
        )
    if found.adhesion_energy_interval[0] == 0.0:
        modulus, sd = found.modulus_without_adhesion
        yield information(
            f"the data do not show adhesion: the 68 % interval of w begins at 0; with w = 0, "
            f"E* = {modulus:.4g} ± {sd:.2g} MPa"
        )
    elif table:
        yield Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
    if not found.verdict.law_fits:
        yield Note(f"{found.verdict}; the stated uncertainties hold only for a law that fits")
    yield from _outliers(found)
    yield from _tests(found, bootstrap)
    if found.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        yield information(f"the error of the radius changes E* by {percent(share)}")


def _tests(found: ContactCalibration, bootstrap: Bootstrap | None) -> Iterator[Note]:
    """Return notes on single tests and on draws of the bootstrap."""
    if found.heterogeneity is not None and not found.heterogeneity.agree:
        yield found.heterogeneity.note()
    unfitted = [test for test in found.tests if np.isnan(test.value[0])]
    few = [test.name for test in unfitted if test.points < FEWEST]
    if few:
        yield information(f"the tests {listed(few)} have too few points for a fit of their own")
    if len(few) < len(unfitted):
        other = listed([test.name for test in unfitted if test.points >= FEWEST])
        yield Note(
            f"the tests {other} have no fit of their own: their areas are alike, or their loads do not grow "
            "with them; they are part of the common fit only"
        )
    if bootstrap is not None and found.bootstrap is not None and len(found.bootstrap) < bootstrap.draws:
        lost = bootstrap.draws - len(found.bootstrap)
        yield Note(f"{lost} of the {bootstrap.draws} draws of the bootstrap have no fit and are left out")


def _outliers(found: ContactCalibration) -> Iterator[Note]:
    """Return which points are outliers, and which of them a robust fit leaves out."""
    points = [Given(f"load[{i}]") for i in np.flatnonzero(found.weight < OUTLYING).tolist()]
    if points:
        many = len(points) > MANY_OUTLIERS * len(found.load)
        yield ArgumentNote.of(
            f"the robust fit gives less than half of their weight to {listed(['{.name}'] * len(points))}"
            + f": {len(points)} of {len(found.load)} points; the law may not fit" * many,
            *points,
            level=Level.WARNING if many else Level.INFORMATION,
        )
    elif found.verdict.one_outlier:
        farthest = found.verdict["largest"]
        yield ArgumentNote.of(
            f"{{.name}} lies {farthest.statistic:.2g} standard deviations from the law (p "
            f"{chance(farthest.probability, 1)} for the farthest of normal errors): check the point, leave "
            "it out, or calibrate with robust=True (--robust on the command line)",
            Given(f"load[{found.verdict.outlier}]"),
        )
