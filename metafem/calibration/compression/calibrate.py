"""E* and adhesion energy from loads and contact areas of compression tests."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._given import formatted
from metafem._validate import FloatArray
from metafem.calibration.compression.adhesive_line import adhesive_line
from metafem.calibration.compression.data import FEWEST, ONE_AREA, Data, checked_data
from metafem.calibration.compression.distance_fit import DistanceFit
from metafem.calibration.compression.notes import MANY_OUTLIERS, OUTLYING, notes_of
from metafem.calibration.compression.result import ContactCalibration, ContactTest
from metafem.calibration.compression.scene import (
    AreaCurve,
    adhesive_cap,
    cap_curve,
    checked_cap,
    checked_sample,
    sample_curve,
    scaled_cap,
)
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import Heterogeneity, Verdict, errors_of, heterogeneity, judged_in_order
from metafem.contact import Contact, Hertz
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.models import Model
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.surface import Surface

# Error bars of Aymard et al. (2024).
USUAL = MeasurementErrors()

# Number of fitted parameters.
FITTED = 2

# Numbers of one array of the bootstrap: 8 MB each.
CHUNK = 1_000_000


@checked_call
def contact(
    load: ArrayLike,
    area: ArrayLike,
    radius: float,
    *,
    contacts: int = 1,
    radius_sd: float = 0.0,
    errors: MeasurementErrors = USUAL,
    area_sd: ArrayLike | None = None,
    test: ArrayLike | None = None,
    poisson_ratio: float | None = None,
    model: Model | None = None,
    contact: Contact | None = None,
    surface: Surface | None = None,
    robust: bool = False,
    bootstrap: int = 0,
    rng: Any = 0,
) -> ContactCalibration:
    """Return E* and adhesion energy w from loads and contact areas, with errors on both.

    ``P = sum_j (E* q(A_j) - b s(A_j))`` with ``b = sqrt(w E*)`` and ``s = sqrt(8 pi a^3)``, ``A = pi a^2``:
    q = P/E* is the load of the cap without adhesion, 4 a^3/(3 R) for `metafem.Hertz`, or with `surface` that
    of the sample under `model`. The law is linear in E* and b. The sum of squared distances from it, over
    their variances at the fitted areas, is smallest; for given variances that is the orthogonal distance
    regression of ODRPACK. b has a sign, so that intervals of sqrt(w) are right where w is nearly 0. The
    straight line of Aymard et al. is computed beside it (`AdhesiveLine`).

    Valid for elastic contacts with adhesion of short range. That neighbours change the adhesive part of the
    load as well is neglected: 1e-5 of E* for caps 7 mm apart, 1e-4 for 2 mm. Johnson, Kendall and Roberts,
    Proc. R. Soc. A 324, 301 (1971), doi:10.1098/rspa.1971.0141.

    Parameters
    ----------
    load : array_like, (k,)
        Measured normal loads P [N] of all contacts together; noise may make small ones negative.
    area : array_like, (k,) or (k, contacts)
        Measured areas [mm^2] of all contacts together, or one by one, 0 for an open contact.
    radius : float
        R of the caps [mm].
    contacts : int
        Number of contacts that share a load; default: 1. Equal ones are assumed where `area` is their total.
    radius_sd : float
        Standard deviation of R [mm], common to all points; default: 0. Caps with a profile or a table of
        their own keep their shape.
    errors : MeasurementErrors
        Standard deviations of the measured loads, of all contacts together, and of the areas of single
        contacts, which are independent; default: ``MeasurementErrors()``, those of Aymard et al.
    area_sd : array_like, of the shape of `area`, optional
        Standard deviations of the areas [mm^2], in place of those of `errors`.
    test : array_like, (k,), optional
        Labels of the tests to which the points belong; default: one test. The points of a test stand in the
        order in which they were measured: where successive residuals are correlated, the errors drift, the
        covariance includes it, and a note says by how much.
    poisson_ratio : float, optional
        nu of the material [-]; default: that of `surface`, or 0.5.
    model : Model, optional
        Model of the sample, with `surface`; default: `metafem.Independent`.
    contact : Contact, optional
        Elastic law of a cap without adhesion; default: that of `model`, or `metafem.Hertz`.
    surface : Surface, optional
        The sample: positions, heights and radii of its caps, and its block; default: contacts far apart.
    robust : bool
        Whether points far from the law lose weight, down to 0 at 4.7 standard deviations (Tukey's biweight),
        for data with outliers; default: False. Without outliers the intervals are 2.6 % wider.
    bootstrap : int
        Number of draws of a bootstrap of the points; default: 0, none.
    rng : int or numpy.random.Generator
        Seed or generator of the bootstrap; default: 0.

    Returns
    -------
    ContactCalibration

    Raises
    ------
    InvalidInput
        For areas that are negative, all 0 or beyond the law, fewer than three points, points of one area,
        loads that fall as the area grows, a `surface` of other radii or another number of caps, and a robust
        fit with fewer than two points near the law.
    NotConverged
        If the fit does not converge, or the model has no solution for the sample.

    Examples
    --------
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> load = 4 / 3 * 1.36 * a**3 / 0.526 - np.sqrt(8 * np.pi * 9e-6 * 1.36 * a**3)
    >>> found = contact(5 * load, 5 * np.pi * a**2, 0.526, contacts=5, radius_sd=0.005)
    >>> round(found.composite_modulus, 6), round(found.adhesion_energy, 9)
    (1.36, 9e-06)
    >>> [round(end, 3) for end in found.composite_modulus_interval]
    [1.341, 1.379]
    """
    size = check.number("radius", radius, above=0.0)
    size_sd = check.number("radius_sd", radius_sd, at_least=0.0)
    if size_sd >= size:
        raise InvalidInput(
            f"radius_sd = {formatted('radius_sd', size_sd)} must be less than the radius, "
            f"{formatted('radius', size)}"
        )
    draws = check.integer("bootstrap", bootstrap, at_least=0)
    data = replace(checked_data(load, area, contacts, errors, area_sd, test), robust=robust)
    cap = checked_cap(contact if contact is not None else Hertz() if model is None else contact_of(model))
    sample, ratio = checked_sample(surface, model, size, data.total_contacts, poisson_ratio)

    def curve(of: float) -> AreaCurve:
        law = cap if of == size else scaled_cap(cap, of / size)
        if sample is None:
            return cap_curve(law, of)
        scaled = replace(sample, radius=sample.radius * (of / size))
        return sample_curve(scaled, model, law, data.area, data.one_by_one)

    nominal = curve(size)
    data.refuse_beyond(nominal, cap, size)
    found, verdict, drift = _judged(data, data.checked_fit(nominal))
    change = np.zeros(FITTED)
    if size_sd:
        high, low = (data.checked_fit(curve(size + sign * size_sd)) for sign in (1.0, -1.0))
        change = 0.5 * np.array([high.modulus - low.modulus, high.root - low.root])
    tests, agreement = _single_tests(data, nominal)
    drawn = _bootstrap(data, nominal, draws, check.generator(rng)) if draws else None
    modulus, root = float(found.modulus), float(found.root)
    sd, (law_load, law_area) = data.sd_of(found.area), data.law(nominal, found)
    made = ContactCalibration(
        material=Material(modulus, ratio),
        adhesion_root=root,
        root_covariance=found.root_covariance + np.outer(change, change),
        statistical_covariance=found.root_covariance,
        radius=size,
        radius_sd=size_sd,
        radius_change=change,
        contact_law=adhesive_cap(cap, max(root, 0.0) ** 2, modulus),
        load=data.load,
        load_sd=data.load_sd,
        load_fitted=data.loads(nominal, found),
        law_load=law_load,
        law_area=law_area,
        area=data.area if data.one_by_one else data.contacts * data.area[:, 0],
        area_sd=sd if data.one_by_one else data.contacts * sd[:, 0],
        contacts=data.total_contacts,
        residual=found.residual,
        weight=found.weight,
        verdict=verdict,
        line=adhesive_line(data.load / data.total_contacts, data.area.mean(axis=1), size),
        tests=tests,
        heterogeneity=agreement,
        bootstrap=drawn,
    )
    return replace(made, notes=(*notes_of(made, cap, draws), *drift))


def _single_tests(data: Data, curve: AreaCurve) -> tuple[tuple[ContactTest, ...], Heterogeneity | None]:
    """Return the fits of single tests, and whether they agree."""
    names = np.array(data.test)
    if len(set(data.test)) < 2:
        return (), None
    tests, values, covariances = [], [], []
    for name in dict.fromkeys(data.test):
        rows = np.flatnonzero(names == name)
        tests.append(ContactTest(name, len(rows)))
        if len(rows) < FEWEST or np.ptp(data.area[rows].sum(axis=1)) <= ONE_AREA * data.area[rows].max():
            continue
        fit = data.fit(curve, rows)
        if not (fit.converged and fit.modulus > 0.0):
            continue
        fit, verdict, _ = _judged(data, fit, rows)
        modulus, root = float(fit.modulus), float(fit.root)
        first, second = np.sqrt(np.diag(fit.root_covariance)).tolist()
        tests[-1] = ContactTest(name, len(rows), modulus, root, first, second, verdict)
        values.append(np.array([modulus, root]))
        covariances.append(fit.root_covariance)
    return tuple(tests), heterogeneity(values, covariances) if values else None


def _judged(
    data: Data, fit: DistanceFit, rows: Any = slice(None)
) -> tuple[DistanceFit, Verdict, tuple[Note, ...]]:
    """Return a fit to rows with the covariance of its errors, its verdict, and a note on correlated errors.

    Points to which a robust fit gives less than half of their weight are left out, unless they are many.
    """
    kept = fit.weight >= OUTLYING
    kept |= (~kept).mean() > MANY_OUTLIERS
    measured = Succession(np.array(data.test)[rows][kept], fit.regressor[kept])
    verdict = judged_in_order(fit.residual[kept], data.load[rows][kept], measured)
    rho, notes = errors_of(verdict, measured, "E* and w")
    return replace(fit, covariance=measured.covariance(rho)) if rho else fit, verdict, notes


def _bootstrap(data: Data, curve: AreaCurve, draws: int, rng: np.random.Generator) -> FloatArray:
    """Return E* and sqrt(w) (draws, 2) of points drawn with replacement from those of each test.

    Draws without a fit, such as those of one area, are left out.
    """
    names = np.array(data.test)
    groups = [np.flatnonzero(names == name) for name in dict.fromkeys(data.test)]
    some = max(CHUNK // data.area.size, 1)
    found = []
    for start in range(0, draws, some):
        number = min(some, draws - start)
        rows = np.concatenate(
            [own[rng.integers(len(own), size=(number, len(own)))] for own in groups], axis=1
        )
        fit = data.fit(curve, rows)
        good = fit.converged & (fit.modulus > 0.0)
        found.append(np.stack([fit.modulus, fit.root], axis=-1)[good])
    return np.concatenate(found)
