"""Fit of E* and the adhesion energy to the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._values import percent
from metafem.calibration.compression.adhesive_line import adhesive_line
from metafem.calibration.compression.data import FEWEST, ONE_AREA, Data, checked_data
from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.compression.scene import AreaCurve, Sample, adhesive_cap
from metafem.calibration.contact_table import listed
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.verdict import SingleTest, heterogeneity, judged
from metafem.contact import Contact, TabulatedContact
from metafem.material import Material
from metafem.notes import Note, information

# Default measurement errors: the error bars of Aymard et al. (2024).
USUAL = MeasurementErrors()

# Default sample.
ONE_CONTACT = Sample()

# Number of fitted parameters.
FITTED = 2

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
) -> ContactCalibration:
    """Return E* and the adhesion energy w fitted to loads and contact areas that both have errors.

    The law is ``P = sum_j (E* q(A_j) - b s(A_j))`` with ``b = sqrt(w E*)``, ``s = sqrt(8 pi a^3)`` and
    ``A = pi a^2``. q is the rescaled load P/E* of a contact without adhesion, 4 a^3/(3 R) for
    `metafem.Hertz`. The law is linear in E* and b. The fit minimises the sum of the squared distances from
    the law, divided by their variances at the fitted areas. If the variances are fixed, this is the
    orthogonal distance regression of ODRPACK. b may be negative, so that the intervals of sqrt(w) are correct
    even if w is nearly 0. The straight line of Aymard et al. is computed as well (`AdhesiveLine`).

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
        Number of contacts, the error of R, and the contact law of the caps; default: one contact.
    errors : MeasurementErrors
        Standard deviations of the total loads and of the areas of single contacts, whose errors are
        independent; default: ``MeasurementErrors()``, the error bars of Aymard et al.
    area_sd : array_like, of the shape of `area`, optional
        Standard deviations of the areas [mm^2]; default: computed from `errors`.
    test : array_like, (k,), optional
        Labels of the tests to which the points belong; default: one test.

    Returns
    -------
    ContactCalibration

    Raises
    ------
    InvalidInput
        If areas are negative, all 0, all equal or beyond the law, if there are fewer than three points, or if
        the load falls as the area grows.
    NotConverged
        If the fit does not converge.

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
    data = checked_data(load, area, sample.contacts, errors, area_sd, test)

    def curve(change: float = 0.0) -> AreaCurve:
        return sample.curve(size, 1.0 + change / size)

    nominal = curve()
    data.refuse_beyond(nominal, sample.contact, size)
    found = data.checked_fit(nominal)
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
        material=Material(modulus, sample.poisson_ratio),
        adhesion_root=root,
        root_covariance=found.root_covariance + np.outer(change, change),
        statistical_covariance=found.root_covariance,
        radius=size,
        radius_sd=sample.radius_sd,
        radius_change=change,
        contact_law=adhesive_cap(sample.contact, max(root, 0.0) ** 2, modulus),
        load=data.load,
        load_sd=data.load_sd,
        load_fitted=data.loads(nominal, found, data.area),
        law_load=law_load,
        law_area=law_area,
        area=data.area if data.one_by_one else data.contacts * data.area[:, 0],
        area_sd=sd if data.one_by_one else data.contacts * sd[:, 0],
        contacts=sample.contacts,
        residual=found.residual,
        verdict=judged(found.residual, FITTED),
        line=adhesive_line(data.load / sample.contacts, data.area.mean(axis=1), size),
        tests=tests,
        heterogeneity=heterogeneity(fitted) if fitted else None,
    )
    return replace(made, notes=tuple(_notes(made, sample.contact)))


def _single_test(data: Data, curve: AreaCurve, name: str) -> SingleTest:
    """Return the fit to the points of one test; its values are nan if no fit exists."""
    rows = np.flatnonzero(np.array(data.test) == name)
    value, covariance = np.full(FITTED, np.nan), np.full((FITTED, FITTED), np.nan)
    area = data.area[rows]
    if len(rows) >= FEWEST and np.ptp(area.sum(axis=1)) > ONE_AREA * area.max():
        fit = data.fit(curve, rows)
        if fit.converged and fit.modulus > 0.0:
            value, covariance = np.array([fit.modulus, fit.root]), fit.root_covariance
    return SingleTest(name, len(rows), value, covariance)


def _notes(found: ContactCalibration, cap: Contact) -> Iterator[Note]:
    """Return notes on the range of the data, adhesion, the fit and the tests."""
    contacts = 1 if found.area.ndim == 2 else found.contacts
    widest = math.sqrt(float(found.area.max()) / contacts / math.pi) / found.radius
    table = isinstance(cap, TabulatedContact)
    if widest > KNOWN and not table:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads, or use a table of "
            "finite elements as the contact law, metafem.TabulatedContact"
        )
    if found.adhesion_energy_interval[0] == 0.0:
        modulus, sd = found.modulus_without_adhesion
        yield information(
            f"the data do not show adhesion: the 68 % interval of w begins at 0; with w = 0, "
            f"E* = {modulus:.4g} ± {sd:.2g} MPa"
        )
    elif table:
        yield Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
    if not found.verdict.fits:
        yield found.verdict.note("the law does not fit")
    yield from _notes_on_tests(found)
    if found.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        yield information(f"the error of the radius changes E* by {percent(share)}")


def _notes_on_tests(found: ContactCalibration) -> Iterator[Note]:
    """Return notes on the single tests."""
    if found.heterogeneity is not None and not found.heterogeneity.fits:
        yield found.heterogeneity.note("the tests differ")
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
