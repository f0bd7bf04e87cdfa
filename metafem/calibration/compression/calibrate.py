"""Fit of E* and the adhesion energy to the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.compression.adhesive_line import adhesive_line
from metafem.calibration.compression.data import FEWEST, ONE_AREA, Data, checked_data
from metafem.calibration.compression.distance_fit import DistanceFit
from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.compression.scene import AreaCurve, Sample, adhesive_cap
from metafem.calibration.contact_table import listed
from metafem.calibration.magnitude import OFF, unit_hint, within_errors
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.resampling import Bootstrap
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import SingleTest, Verdict, chance, errors_of, heterogeneity, judged_in_order
from metafem.contact import Contact, TabulatedContact
from metafem.material import Material
from metafem.notes import ArgumentNote, Level, Note, information

# Default measurement errors: the error bars of Aymard et al. (2024).
USUAL = MeasurementErrors()

# Default sample.
ONE_CONTACT = Sample()

# Number of fitted parameters.
FITTED = 2

# Largest number of entries in an array of the bootstrap (8 MB).
CHUNK = 1_000_000

# A point is an outlier if its weight in a robust fit is below OUTLYING (a residual beyond 2.5 standard
# deviations). The law is doubtful if the share of outliers exceeds MANY_OUTLIERS.
OUTLYING, MANY_OUTLIERS = 0.5, 0.1

# STIFF is the largest E* of elastomers and gels [MPa]. At the contact radius WIDEST_STIFF (over R), the mean
# Hertzian pressure ``4/(3 pi) E* a/R`` reaches E*/10, about the strength of a perfect solid. No real solid is
# stronger.
STIFF, MEAN_PRESSURE = 300.0, 4.0 / (3.0 * math.pi)
WIDEST_STIFF = 0.1 / MEAN_PRESSURE

# Contact radius over R beyond which large strains change the law. Up to this radius, the load of a soft cap
# (neo-Hookean, incompressible) is 1 to 4 % below the Hertzian load. At 0.76 R the load is between 2 % below
# and 1 % above the Hertzian load, depending on the height of the cap. Source: finite-element results in
# meshes/deep_caps.csv.
KNOWN = 0.5


def fit_compression(
    load: ArrayLike,
    area: ArrayLike,
    radius: float,
    sample: Sample = ONE_CONTACT,
    *,
    errors: MeasurementErrors = USUAL,
    area_sd: ArrayLike | None = None,
    test: ArrayLike | None = None,
    robust: bool = False,
    bootstrap: Bootstrap | None = None,
) -> ContactCalibration:
    """Return E* and the adhesion energy w fitted to loads and contact areas that both have errors.

    The law is ``P = sum_j (E* q(A_j) - b s(A_j))`` with ``b = sqrt(w E*)``, ``s = sqrt(8 pi a^3)`` and
    ``A = pi a^2``. q is the rescaled load P/E* of a contact without adhesion, 4 a^3/(3 R) for
    `metafem.Hertz`. If the sample has a surface, the model of the sample gives q. The law is linear in E* and
    b. The fit minimises the sum of the squared distances from the law, divided by their variances at the
    fitted areas. If the variances are fixed, this is the orthogonal distance regression of ODRPACK. b may be
    negative, so that the intervals of sqrt(w) are correct even if w is nearly 0. The straight line of Aymard
    et al. is computed as well (`AdhesiveLine`).

    The law is valid for elastic contacts with short-range adhesion: Johnson, Kendall and Roberts, Proc. R.
    Soc. A 324, 301 (1971), doi:10.1098/rspa.1971.0141. The effect of neighbours on the adhesive part of the
    load is neglected. The resulting relative error of E* is 1e-5 for caps 7 mm apart and 1e-4 for caps 2 mm
    apart.

    Parameters
    ----------
    load : array_like, (k,)
        Measured total normal loads P [N]. Small loads may be negative because of noise.
    area : array_like, (k,) or (k, contacts)
        Measured total contact areas [mm^2], or the areas of single contacts, 0 for an open contact.
    radius : float
        Radius R of the caps [mm].
    sample : Sample
        Number of contacts, the error of R, and the model of the sample; default: one contact.
    errors : MeasurementErrors
        Standard deviations of the total loads and of the areas of single contacts, whose errors are
        independent; default: ``MeasurementErrors()``, the error bars of Aymard et al.
    area_sd : array_like, of the shape of `area`, optional
        Standard deviations of the areas [mm^2]; default: computed from `errors`.
    test : array_like, (k,), optional
        Labels of the tests to which the points belong; default: one test. The points of a test must be in the
        order of measurement. If successive residuals are correlated, the errors drift; the covariance then
        includes the drift, and a note states its size.
    robust : bool
        Whether to reduce the weights of points far from the law, for data with outliers (Tukey's biweight:
        the weight is 0 beyond 4.7 standard deviations); default: False. For data without outliers, a robust
        fit makes the intervals 2.6 % wider.
    bootstrap : Bootstrap, optional
        If set, also fit resampled points of each test; default: none.

    Returns
    -------
    ContactCalibration

    Raises
    ------
    InvalidInput
        If areas are negative, all 0, all equal or beyond the law, if there are fewer than three points, if
        the load falls as the area grows, if the radii of the surface differ from `radius`, or if a robust fit
        finds fewer than two points near the law.
    NotConverged
        If the fit does not converge, or the model has no solution for the sample.

    Examples
    --------
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> load = 4 / 3 * 1.36 * a**3 / 0.526 - np.sqrt(8 * np.pi * 9e-6 * 1.36 * a**3)
    >>> found = fit_compression(5 * load, 5 * np.pi * a**2, 0.526, Sample(contacts=5, radius_sd=0.005))
    >>> round(found.composite_modulus, 6), round(found.adhesion_energy, 9)
    (1.36, 9e-06)
    >>> [round(end, 3) for end in found.composite_modulus_interval]
    [1.341, 1.379]
    """
    check.instance("sample", sample, Sample, "a metafem.calibration.Sample")
    size = check.number("radius", radius, above=0.0)
    sample.refuse_radius(size)
    data = checked_data(load, area, sample.contacts, errors, area_sd, test, robust)

    def curve(change: float = 0.0) -> AreaCurve:
        return sample.curve(size, 1.0 + change / size, data.area, data.one_by_one)

    nominal = curve()
    data.refuse_beyond(nominal, sample.cap, size)
    found, verdict, drift = _judged(data, data.checked_fit(nominal))
    change = np.zeros(FITTED)
    if sample.radius_sd:
        high, low = (data.checked_fit(curve(sign * sample.radius_sd)) for sign in (1.0, -1.0))
        change = 0.5 * np.array([high.modulus - low.modulus, high.root - low.root])
    labels = list(dict.fromkeys(data.test))
    tests = tuple(_single_test(data, nominal, name) for name in labels if len(labels) > 1)
    fitted = [each for each in tests if np.isfinite(each.value).all()]
    modulus, root = float(found.modulus), float(found.root)
    sd, (law_load, law_area) = data.sd_of(found.area), data.law(nominal, found)
    made = ContactCalibration(
        material=Material(modulus, sample.ratio),
        adhesion_root=root,
        root_covariance=found.root_covariance + np.outer(change, change),
        statistical_covariance=found.root_covariance,
        radius=size,
        radius_sd=sample.radius_sd,
        radius_change=change,
        contact_law=adhesive_cap(sample.cap, max(root, 0.0) ** 2, modulus),
        load=data.load,
        load_sd=data.load_sd,
        load_fitted=data.loads(nominal, found, data.area),
        law_load=law_load,
        law_area=law_area,
        area=data.area if data.one_by_one else data.contacts * data.area[:, 0],
        area_sd=sd if data.one_by_one else data.contacts * sd[:, 0],
        contacts=sample.contacts,
        residual=found.residual,
        weight=found.weight,
        verdict=verdict,
        line=adhesive_line(data.load / sample.contacts, data.area.mean(axis=1), size),
        tests=tests,
        heterogeneity=heterogeneity(fitted) if fitted else None,
        bootstrap=None if bootstrap is None else _resampled(data, nominal, bootstrap),
    )
    return replace(made, notes=(*_notes(made, sample.cap, bootstrap), *drift))


def _single_test(data: Data, curve: AreaCurve, name: str) -> SingleTest:
    """Return the fit to the points of one test; its values are nan if no fit exists."""
    rows = np.flatnonzero(np.array(data.test) == name)
    value, covariance, verdict = np.full(FITTED, np.nan), np.full((FITTED, FITTED), np.nan), None
    area = data.area[rows]
    if len(rows) >= FEWEST and np.ptp(area.sum(axis=1)) > ONE_AREA * area.max():
        fit = data.fit(curve, rows)
        if fit.converged and fit.modulus > 0.0:
            fit, verdict, _ = _judged(data, fit, rows)
            value, covariance = np.array([fit.modulus, fit.root]), fit.root_covariance
    return SingleTest(name, len(rows), value, covariance, verdict)


def _judged(
    data: Data, fit: DistanceFit, rows: Any = slice(None)
) -> tuple[DistanceFit, Verdict, tuple[Note, ...]]:
    """Return the fit with the covariance of its correlated errors, its verdict, and notes on these errors.

    The verdict and the correlation omit the outliers of a robust fit (weight below 1/2), unless there are
    many.
    """
    used = fit.weight >= OUTLYING
    used |= (~used).mean() > MANY_OUTLIERS
    measured = Succession(np.array(data.test)[rows][used], fit.regressor[used])
    verdict = judged_in_order(fit.residual[used], data.load[rows][used], measured)
    rho, notes = errors_of(verdict, measured, "E* and w")
    return replace(fit, covariance=measured.covariance(rho)) if rho else fit, verdict, notes


def _resampled(data: Data, curve: AreaCurve, bootstrap: Bootstrap) -> FloatArray:
    """Return E* and sqrt(w) of fits to resampled points, (draws, 2), without the draws that have no fit."""
    found = []
    for rows in bootstrap.rows(data.test, CHUNK // data.area.size):
        fit = data.fit(curve, rows)
        good = fit.converged & (fit.modulus > 0.0)
        found.append(np.stack([fit.modulus, fit.root], axis=-1)[good])
    return np.concatenate(found)


def _notes(found: ContactCalibration, cap: Contact, bootstrap: Bootstrap | None) -> Iterator[Note]:
    """Return notes on the range of the data, adhesion, the fit and the tests."""
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
    yield from _notes_on_outliers(found)
    yield from _notes_on_tests(found, bootstrap)
    if found.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        yield information(f"the error of the radius changes E* by {percent(share)}")


def _notes_on_tests(found: ContactCalibration, bootstrap: Bootstrap | None) -> Iterator[Note]:
    """Return notes on the single tests and on the draws of the bootstrap."""
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


def _notes_on_outliers(found: ContactCalibration) -> Iterator[Note]:
    """Return notes that name the outliers and those that a robust fit omits."""
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
