"""Composite modulus and adhesion energy from the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.calibration.statistics import (
    PAPER,
    Calibration,
    Estimate,
    Fit,
    MeasurementErrors,
    Verdict,
    errors_in_variables,
    positive,
)
from metafem.errors import NotConverged, refuse_if
from metafem.notes import Note, information

# Smallest number of points: two for the parameters and one for a residual.
FEWEST = 3

# Smallest relative range of areas for which a fit is possible.
ONE_AREA = 1e-6

# Contact radius over R beyond which large strains change the law. Up to this radius, the load of a soft cap
# (neo-Hookean, incompressible) is 1 to 4 % below the Hertzian load. At 0.76 R the load is between 2 % below
# and 1 % above the Hertzian load, depending on the height of the cap. Source: finite-element results in
# meshes/deep_caps.csv.
KNOWN = 0.5

# Range of the largest contact radius over R, and of E* [MPa]. Beyond it, a unit or a number is usually wrong:
# rubbers and gels have moduli of 0.01 to 100 MPa.
SHARES, MODULI = (1e-3, 1.0), (0.01, 100.0)

# Smallest ratio of a fitted to a measured area during the iteration, which keeps the areas positive.
SMALLEST_PART = 0.1


def fit_areas(
    load: FloatArray,
    area: FloatArray,
    radius: float,
    contacts: int = 1,
    errors: MeasurementErrors = PAPER,
    adhesive: bool = True,
) -> Fit:
    """Return fits of E* and b to loads (..., k) [N] and areas (..., k, n) [mm^2] of single contacts.

    The areas are those of all contacts, or equal areas for which one stands. Their sum is the abscissa of a
    point, of which each contact has its measured share. Without adhesion, E* is the only parameter.
    """
    alike, count = contacts // area.shape[-1], 2 if adhesive else 1
    total = area.sum(axis=-1)
    shares = area / total[..., None]

    def model(p: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return load and sum of areas, with ``P = c sum_j (E* 4 a_j^3/(3 R) - b sqrt(8 pi a_j^3))``."""
        a = np.sqrt(shares * x[..., None] / math.pi)
        each = [4.0 / (3.0 * radius) * (a**3).sum(axis=-1), -math.sqrt(8.0 * math.pi) * (a**1.5).sum(axis=-1)]
        by_p = alike * np.stack(each, axis=-1)[..., :count]
        part = by_p * p[..., None, :]
        # the parts grow as x^(3/2) and x^(3/4)
        by_x = (part * [1.5, 0.75][:count]).sum(axis=-1) / x
        derivatives = np.stack([by_p, np.zeros(by_p.shape)], axis=-2)
        return np.stack([part.sum(axis=-1), x], axis=-1), derivatives, np.stack([by_x, np.ones(x.shape)], -1)

    def deviation(value: FloatArray) -> FloatArray:
        each = errors.of_area(shares * value[..., 1:])
        each = np.where(area > 0.0, each, np.maximum(each, errors.of_open)) / math.sqrt(alike)
        return np.stack([errors.of_load(value[..., 0]), np.linalg.norm(each, axis=-1)], axis=-1)

    measured, start = np.stack([load, total], axis=-1), np.zeros((*load.shape[:-1], count))
    return errors_in_variables(model, measured, deviation, start, total, SMALLEST_PART * total)


def of_root(fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Return E* and sqrt(w) = b/sqrt(E*), (..., 2), and their covariance; nan where E* is not positive."""
    modulus, product = fit.parameter[..., 0], fit.parameter[..., 1]
    with np.errstate(invalid="ignore"):
        scale = np.sqrt(modulus)
    jacobian = np.zeros((*modulus.shape, 2, 2))
    jacobian[..., 0, 0] = 1.0
    jacobian[..., 1, 0], jacobian[..., 1, 1] = -0.5 * product / (scale * modulus), 1.0 / scale
    covariance = jacobian @ fit.covariance @ np.swapaxes(jacobian, -1, -2)
    return np.stack([modulus, product / scale], axis=-1), covariance


def fit_compression(
    load: ArrayLike,
    area: ArrayLike,
    radius: float,
    *,
    contacts: int = 1,
    errors: MeasurementErrors = PAPER,
    test: ArrayLike | None = None,
    unusual: bool = False,
) -> Calibration:
    """Return E* and the adhesion energy w fitted to loads and contact areas that both have errors.

    The law is ``P = sum_j (E* 4 a_j^3/(3 R) - b sqrt(8 pi a_j^3))`` with ``b = sqrt(w E*)`` and
    ``A = pi a^2``. The true areas are unknowns of the fit, which minimises the sum of the squared distances
    from the law over their variances at the fitted areas. b may be negative, so that the intervals of sqrt(w)
    are correct even if w is nearly 0. If the interval of w begins at 0, E* is that of a fit with w = 0. The
    error of the radius enters by E* ~ R and sqrt(w) ~ 1/sqrt(R) at given loads and areas.

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
    contacts : int
        Number of contacts that share a load and are far apart, if only their total area was measured; they
        are assumed to be equal. Default: 1.
    errors : MeasurementErrors
        Standard deviations of the total loads, of the areas of single contacts, whose errors are independent,
        and of R; default: the error bars of Aymard et al., and an exact R. An open contact has the error of a
        contact whose radius is twice the error of the boundary.
    test : array_like, (k,), optional
        Labels of the tests to which the points belong; default: one test.
    unusual : bool
        Whether moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R, are accepted; default:
        False.

    Returns
    -------
    Calibration

    Raises
    ------
    InvalidInput
        If areas are negative, all 0 or all equal, if there are fewer than three points, if
        the load falls as the area grows, or if E* or the contact radii are unusual.
    NotConverged
        If the fit does not converge.

    Examples
    --------
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> load = 4 / 3 * 1.36 * a**3 / 0.526 - np.sqrt(8 * np.pi * 9e-6 * 1.36 * a**3)
    >>> errors = MeasurementErrors(radius_sd=0.005)
    >>> found = fit_compression(5 * load, 5 * np.pi * a**2, 0.526, contacts=5, errors=errors)
    >>> modulus, energy = found.estimates["composite_modulus"], found.estimates["adhesion_energy"]
    >>> round(modulus.value, 6), [round(end, 3) for end in modulus.interval], round(energy.value, 9)
    (1.36, [1.341, 1.379], 9e-06)
    """
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    size = check.number("radius", radius, above=0.0)
    less = f"must be less than the radius, {size:g} mm"
    refuse_if(errors.radius_sd >= size, less, key="radius_sd", value=errors.radius_sd)
    loads, areas, count = _points(load, area, check.integer("contacts", contacts, at_least=1))
    found, verdict = _estimates(loads, areas, size, count, errors)
    modulus, energy, sd = found["composite_modulus"], found["adhesion_energy"], errors.radius_sd
    widest = math.sqrt(areas.max() / math.pi) / size
    if not unusual:
        _refuse_unusual(modulus.value, widest, size, count)
    both = sd**2 / size * modulus.value
    joint = np.array([[sd**2, both], [both, modulus.sd**2]])
    known = 0 if sd else 1  # an exact radius is no parameter
    # an error of the radius is common to all tests
    given: dict[str, Any] = {"contacts": count, "errors": replace(errors, radius_sd=0.0), "unusual": unusual}
    return Calibration(
        estimates=found | ({"radius": positive(size, sd**2)} if sd else {}),
        parameters=("radius", "composite_modulus")[known:],
        covariance=joint[known:, known:],
        verdict=verdict,
        notes=tuple(_notes(energy.interval[0] > 0.0, widest)),
    ).of_tests(
        test, len(loads), lambda own: fit_compression(loads[own], np.asarray(area)[own], size, **given)
    )


def _estimates(
    loads: FloatArray, areas: FloatArray, radius: float, contacts: int, errors: MeasurementErrors
) -> tuple[dict[str, Estimate], Verdict]:
    """Return E* and w, and whether the law fits."""
    fit = fit_areas(loads, areas, radius, contacts, errors)
    if not fit.converged:
        raise NotConverged(
            "the fit of E* and the adhesion energy does not converge; leave out areas that are not much "
            "larger than their errors, or check their unit",
            fit,
        )
    (modulus, root), covariance = of_root(fit)
    falls = f"the load does not grow with the contact area: the fitted E* is {modulus:.3g} MPa; check the"
    refuse_if(not modulus > 0.0, f"{falls} columns and their order")
    # at given loads and areas, E* grows in proportion to R, and sqrt(w) as 1/sqrt(R)
    share = errors.radius_sd / radius
    root = positive(float(root), covariance[1, 1] + (0.5 * share * root) ** 2)
    low, high = root.interval
    energy = Estimate(max(root.value, 0.0) ** 2, 0.5 * (high**2 - low**2), (low**2, high**2))
    verdict = Verdict(float(fit.chi_square.sum()), len(loads) - 2)
    if not low:
        fit = fit_areas(loads, areas, radius, contacts, errors, adhesive=False)
    modulus, variance = float(fit.parameter[0]), float(fit.covariance[0, 0])
    found = {
        "composite_modulus": positive(modulus, variance + (share * modulus) ** 2),
        "adhesion_energy": energy,
    }
    return found, verdict


def _points(load: ArrayLike, area: ArrayLike, contacts: int) -> tuple[FloatArray, FloatArray, int]:
    """Return checked loads (k,), areas of single contacts (k, n) or equal ones (k, 1), and their number."""
    loads = check.array("load", load, shape=(None,))
    few = f"load has {len(loads)} points; E* and the adhesion energy need at least {FEWEST}, at different"
    refuse_if(len(loads) < FEWEST, f"{few} areas")
    given = check.array("area", area, shape=(len(loads), None)[: np.ndim(area) or 1])
    check.refuse_entries("area", given, given < 0.0, "must not be negative")
    areas = given.reshape(len(loads), -1)
    total, count = areas.sum(axis=1), areas.shape[1]
    check.refuse_entries("area", total, total == 0.0, "is no contact; leave the row out")
    same = f"all areas are {total.max():g} mm^2: E* and the adhesion energy need points at different areas"
    refuse_if(np.ptp(total) <= ONE_AREA * total.max(), same)
    if count == 1:
        return loads, areas / contacts, contacts
    must = f"must be 1 or {count}, because area has the {count} contacts one by one"
    refuse_if(contacts not in (1, count), must, key="contacts", value=contacts)
    return loads, areas, count


def _refuse_unusual(modulus: float, widest: float, radius: float, contacts: int) -> None:
    """Raise InvalidInput if E* [MPa] or the largest contact radius over R is not that of a soft material."""
    (small, wide), (least, most) = SHARES, MODULI
    usual = small <= widest <= wide and least <= modulus <= most
    refuse_if(
        not usual,
        f"E* = {modulus:.4g} MPa with contact radii up to {widest:.3g} R is unusual: soft materials have "
        f"{least:g} to {most:g} MPa, and contacts {small:g} to {wide:g} R; check the units of loads and "
        f"areas, the radius, {radius:g} mm, and the number of contacts under one load, {contacts}; "
        "if they are right, insist with the option --unusual (in Python, unusual=True)",
    )


def _notes(adhesive: bool, widest: float) -> Iterator[Note]:
    """Return notes on the range of the data and on adhesion."""
    if widest > KNOWN:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads"
        )
    if not adhesive:
        yield information("the data do not show adhesion: the 68 % interval of w begins at 0; E* is of w = 0")
