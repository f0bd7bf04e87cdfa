"""Composite modulus and adhesion energy from the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.statistics import (
    PAPER,
    Calibration,
    Estimate,
    MeasurementErrors,
    Verdict,
    positive,
)
from metafem.contact import JKR, Contact, Elastic, Hertz, TabulatedContact
from metafem.contact.law import checked_contact
from metafem.errors import NotConverged, refuse_if
from metafem.material import Material
from metafem.notes import Note, information

# Smallest number of points: two for the parameters and one for a residual.
FEWEST = 3

# Smallest relative range of areas for which a fit is possible, and the relative rounding error of areas.
ONE_AREA, ROUNDING = 1e-6, 1e-9

# Contact radius over R beyond which large strains change the law. Up to this radius, the load of a soft cap
# (neo-Hookean, incompressible) is 1 to 4 % below the Hertzian load. At 0.76 R the load is between 2 % below
# and 1 % above the Hertzian load, depending on the height of the cap. Source: finite-element results in
# meshes/deep_caps.csv.
KNOWN = 0.5

# Contact radius over R at which the slope of an open contact is evaluated.
OPEN = 1e-6

# Range of the largest contact radius over R, and of E* [MPa]. Beyond it, a unit or a number is usually wrong:
# rubbers and gels have moduli of 0.01 to 100 MPa.
SHARES, MODULI = (1e-3, 1.0), (0.01, 100.0)

# Smallest ratio of a fitted to a measured area during the iteration, which keeps the areas positive.
SMALLEST_PART = 0.1

# Default contact law.
HERTZ = Hertz()


@dataclass(frozen=True)
class Sample:
    """Sample of a compression test, whose contacts are far apart.

    Parameters
    ----------
    contacts : int
        Number of contacts that share a load; default: 1. If only their total area was measured, the contacts
        are assumed to be equal.
    radius_sd : float
        Standard deviation of R [mm], common to all points; default: 0. Caps with a profile or a table are
        scaled in all dimensions.
    contact : Contact
        Elastic contact law of a cap, without adhesion; default: `metafem.Hertz`.
    unusual : bool
        Whether moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R, are accepted; default:
        False.

    Raises
    ------
    InvalidInput
        If the contact law is adhesive or plastic, or takes the caps of a surface.

    Examples
    --------
    >>> Sample(contacts=5, radius_sd=0.005).contact
    Hertz()
    """

    contacts: int = 1
    radius_sd: float = 0.0
    contact: Contact = HERTZ
    unusual: bool = False

    def __post_init__(self) -> None:
        check.integer("contacts", self.contacts, at_least=1)
        check.member(self, "radius_sd", at_least=0.0)
        law = checked_contact(self.contact)
        wrong = law.adhesive or law.plastic or law == Elastic()
        wrong = wrong or (isinstance(law, TabulatedContact) and law.material is None)
        must = (
            "must be the elastic law of a cap without adhesion, such as metafem.Hertz(), or a table whose E*"
        )
        refuse_if(wrong, f"contact = {shown(law)} {must} is known, by contact.for_material(material)")

    def law(self, adhesion_energy: float, modulus: float) -> Contact:
        """Return the contact law of the cap for this E* [MPa], adhesive if w > 0 [N/mm]."""
        cap = self.contact
        if isinstance(cap, TabulatedContact) and cap.material is not None:
            depth, load, area = cap.table
            return TabulatedContact(depth, load * (modulus / cap.material.composite_modulus), area)
        return JKR(adhesion_energy, cap) if adhesion_energy > 0.0 and cap.largest_order > 1 else cap


def areas_model(sample: Sample, radius: float, alike: int, adhesive: bool = True) -> variables.Model:
    """Return the model of errors in variables of n areas that each stand for `alike` contacts.

    The quantities are the load ``P = c sum_j (E* s^2 q(A_j/s^2) - b s(A_j))`` and the areas A_j. The
    parameters are E*, b and z, of which ``s = 1 + z u`` multiplies all dimensions of the caps with the
    relative error u of their radius. b has no effect unless the law is `adhesive`.
    """
    cap, share, widest = sample.contact, sample.radius_sd / radius, widest_radius(sample.contact, radius)

    def model(p: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        modulus, product, z = (p[..., i, None, None] for i in range(3))
        a, scale = np.sqrt(area / math.pi), 1.0 + share * z
        closed = np.clip(a / scale, OPEN * radius, widest)
        rescaled = np.where(area > 0.0, scale**2 * cap.load(closed, radius), 0.0)
        slope = cap.stiffness(closed, radius) / cap.area_slope(closed, radius)
        lowered = adhesive * math.sqrt(8.0 * math.pi) * a**1.5
        steep = np.divide(0.75 * lowered, area, np.zeros(area.shape), where=area > 0.0)
        by_z = modulus * share * 2.0 / scale * (rescaled - area * slope)
        total = alike * np.stack([rescaled, -lowered, by_z], axis=-1).sum(axis=-2)
        load = total[..., :2] @ p[..., :2, None]
        single = np.broadcast_to(np.eye(area.shape[-1]), (*area.shape, area.shape[-1]))
        own = alike * (modulus * slope - product * steep)
        by_p = np.concatenate([total[..., None, :], np.zeros((*area.shape, 3))], axis=-2)
        by_area = np.concatenate([own[..., None, :], single], axis=-2)
        return np.concatenate([load, area], axis=-1), by_p, by_area

    return model


def widest_radius(cap: Contact, radius: float) -> float:
    """Return the largest contact radius that a law describes [mm]."""
    deepest = float(cap.largest_indentation(radius))
    return math.inf if deepest == math.inf else float(cap.contact_radius(deepest, radius))


def fit_areas(
    load: FloatArray,
    area: FloatArray,
    radius: float,
    sample: Sample,
    errors: MeasurementErrors = PAPER,
    adhesive: bool = True,
) -> variables.Fit:
    """Return fits of E*, b and z to loads (..., k) [N] and areas (..., k, n) [mm^2] of single contacts.

    The areas are those of all contacts of the sample, or equal areas for which one stands.
    """
    alike = sample.contacts // area.shape[-1]
    measured = np.concatenate([load[..., None], area], axis=-1)

    def deviation(value: FloatArray) -> FloatArray:
        each = errors.of_area(value[..., 1:])
        each = np.where(area > 0.0, each, np.maximum(each, errors.of_open)) / math.sqrt(alike)
        return np.concatenate([errors.of_load(value[..., :1]), each], axis=-1)

    model = areas_model(sample, radius, alike, adhesive)
    start, precision = np.zeros((*load.shape[:-1], 3)), (0.0, 0.0 if adhesive else 1.0, 1.0)
    bounds = SMALLEST_PART * area, math.pi * widest_radius(sample.contact, radius) ** 2
    return variables.fit(model, measured, deviation, start, area, bounds, precision)


def of_root(fit: variables.Fit) -> tuple[FloatArray, FloatArray]:
    """Return E*, sqrt(w) = b/sqrt(E*) and z, (..., 3), and their covariance; nan where E* is not positive."""
    modulus, product, z = np.moveaxis(fit.parameter, -1, 0)
    with np.errstate(invalid="ignore"):
        scale = np.sqrt(modulus)
    jacobian = np.broadcast_to(np.eye(3), fit.covariance.shape).copy()
    jacobian[..., 1, 0], jacobian[..., 1, 1] = -0.5 * product / (scale * modulus), 1.0 / scale
    covariance = jacobian @ fit.covariance @ np.swapaxes(jacobian, -1, -2)
    return np.stack([modulus, product / scale, z], axis=-1), covariance


def fit_compression(
    load: ArrayLike,
    area: ArrayLike,
    radius: float,
    sample: Sample | None = None,
    *,
    errors: MeasurementErrors = PAPER,
    test: ArrayLike | None = None,
) -> Calibration:
    """Return E* and the adhesion energy w fitted to loads and contact areas that both have errors.

    The law is ``P = sum_j (E* q(A_j) - b s(A_j))`` with ``b = sqrt(w E*)``, ``s = sqrt(8 pi a^3)`` and
    ``A = pi a^2``. q is the rescaled load P/E* of a contact without adhesion, 4 a^3/(3 R) for
    `metafem.Hertz`. The true areas are unknowns of the fit, which minimises the sum of the squared distances
    from the law over their variances at the fitted areas. b may be negative, so that the intervals of sqrt(w)
    are correct even if w is nearly 0. The radius R is a parameter too, measured with its error; it scales the
    caps in all dimensions. If the interval of w begins at 0, E* is that of a fit with w = 0.

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
    sample : Sample, optional
        Number of contacts, the error of R, and the contact law of the caps; default: one contact.
    errors : MeasurementErrors
        Standard deviations of the total loads and of the areas of single contacts, whose errors are
        independent; default: the error bars of Aymard et al. An open contact has the error of a contact whose
        radius is twice the error of the boundary.
    test : array_like, (k,), optional
        Labels of the tests to which the points belong; default: one test.

    Returns
    -------
    Calibration

    Raises
    ------
    InvalidInput
        If areas are negative, all 0, all equal or beyond the law, if there are fewer than three points, if
        the load falls as the area grows, or if E* or the contact radii are unusual.
    NotConverged
        If the fit does not converge.

    Examples
    --------
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> load = 4 / 3 * 1.36 * a**3 / 0.526 - np.sqrt(8 * np.pi * 9e-6 * 1.36 * a**3)
    >>> found = fit_compression(5 * load, 5 * np.pi * a**2, 0.526, Sample(contacts=5, radius_sd=0.005))
    >>> modulus, energy = found.estimates["composite_modulus"], found.estimates["adhesion_energy"]
    >>> round(modulus.value, 6), [round(end, 3) for end in modulus.interval], round(energy.value, 9)
    (1.36, [1.341, 1.379], 9e-06)
    """
    given = Sample() if sample is None else sample
    check.instance("sample", given, Sample, "a metafem.calibration.Sample")
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    size = check.number("radius", radius, above=0.0)
    less = f"must be less than the radius, {size:g} mm"
    refuse_if(given.radius_sd >= size, less, key="radius_sd", value=given.radius_sd)
    loads, areas = _points(load, area, given, size)
    fit = fit_areas(loads, areas, size, given, errors)
    if not fit.converged:
        raise NotConverged(
            "the fit of E* and the adhesion energy does not converge; leave out areas that are not much "
            "larger than their errors, or check their unit",
            fit,
        )
    value, covariance = of_root(fit)
    falls = f"the load does not grow with the contact area: the fitted E* is {value[0]:.3g} MPa; check the"
    refuse_if(not value[0] > 0.0, f"{falls} columns and their order")
    root = positive(float(value[1]), covariance[1, 1])
    adhesive = root.interval[0] > 0.0
    if not adhesive:
        value, covariance = of_root(fit_areas(loads, areas, size, given, errors, adhesive=False))
    modulus, energy = positive(float(value[0]), covariance[0, 0]), max(root.value, 0.0) ** 2
    low, high = root.interval
    widest = math.sqrt(areas.max() / math.pi) / size
    _refuse_unusual(modulus.value, widest, size, given)
    found = {
        "composite_modulus": modulus,
        "adhesion_energy": Estimate(energy, 0.5 * (high**2 - low**2), (low**2, high**2)),
    }
    if given.radius_sd:
        fitted = size + given.radius_sd * float(value[2])
        found["radius"] = positive(fitted, given.radius_sd**2 * float(covariance[2, 2]))
    scale, order = np.array([given.radius_sd, 1.0]), np.array([2, 0])
    joint = scale[:, None] * covariance[np.ix_(order, order)] * scale
    known = 0 if given.radius_sd else 1  # an exact radius is no parameter
    exact, rows = replace(given, radius_sd=0.0), np.asarray(area)
    return Calibration(
        estimates=found,
        parameters=("radius", "composite_modulus")[known:],
        covariance=joint[known:, known:],
        verdict=Verdict(float(fit.chi_square.sum()), len(loads) - 2),
        material=Material(modulus.value),
        contact_law=given.law(energy if adhesive else 0.0, modulus.value),
        notes=tuple(_notes(given, adhesive, widest)),
    ).of_tests(
        test, len(loads), lambda own: fit_compression(loads[own], rows[own], size, exact, errors=errors)
    )


def _points(load: ArrayLike, area: ArrayLike, sample: Sample, radius: float) -> tuple[FloatArray, FloatArray]:
    """Return the checked loads (k,), and areas of single contacts (k, contacts), or of equal ones (k, 1)."""
    loads = check.array("load", load, shape=(None,))
    count, number, one_by_one = len(loads), sample.contacts, check.depth(area) == 2
    few = f"load has {count} points; E* and the adhesion energy need at least {FEWEST}, at different areas"
    refuse_if(count < FEWEST, few)
    given = check.array("area", area, shape=(count, number) if one_by_one else (count,))
    check.refuse_entries("area", given, given < 0.0, "must not be negative")
    total = given.sum(axis=1) if one_by_one else given
    check.refuse_entries("area", total, total == 0.0, "is no contact; leave the row out")
    same = f"all areas are {total.max():g} mm^2: E* and the adhesion energy need points at different areas"
    refuse_if(np.ptp(total) <= ONE_AREA * total.max(), same)
    single = given if one_by_one else given[:, None] / number
    reach = widest_radius(sample.contact, radius) / radius
    beyond = np.sqrt(single / math.pi).reshape(given.shape) > (1.0 + ROUNDING) * reach * radius
    ends = f"is beyond the largest contact of {shown(sample.contact)}, whose radius is {reach:.3g} R; leave "
    check.refuse_entries("area", given, beyond, f"{ends}the point out")
    return loads, single


def _refuse_unusual(modulus: float, widest: float, radius: float, sample: Sample) -> None:
    """Raise InvalidInput if E* [MPa] or the largest contact radius over R is not that of a soft material."""
    (small, wide), (least, most) = SHARES, MODULI
    usual = small <= widest <= wide and least <= modulus <= most
    refuse_if(
        not (usual or sample.unusual),
        f"E* = {modulus:.4g} MPa with contact radii up to {widest:.3g} R is unusual: soft materials have "
        f"{least:g} to {most:g} MPa, and contacts {small:g} to {wide:g} R; check the units of loads and "
        f"areas, the radius, {radius:g} mm, and the number of contacts under one load, {sample.contacts}; "
        "if they are right, insist with the option --unusual (in Python, Sample(unusual=True))",
    )


def _notes(sample: Sample, adhesive: bool, widest: float) -> Iterator[Note]:
    """Return notes on the range of the data and on adhesion."""
    table = isinstance(sample.contact, TabulatedContact)
    if widest > KNOWN and not table:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads, or use a table of finite elements "
            "as the contact law, metafem.TabulatedContact"
        )
    if not adhesive:
        yield information("the data do not show adhesion: the 68 % interval of w begins at 0; E* is of w = 0")
    elif table:
        yield Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
