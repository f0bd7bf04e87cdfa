"""Composite modulus and adhesion energy from the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.statistics import (
    PAPER,
    Calibration,
    Estimate,
    Line,
    MeasurementErrors,
    each_test,
    positive,
    scatter,
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

# Contact radius over R at which the slope of an open contact is evaluated, and the number of points at which
# a figure shows the law.
OPEN, GRID = 1e-6, 200

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


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ContactCalibration(Calibration):
    """Composite modulus E* and adhesion energy w from compression tests.

    Intervals contain the true value in 68 % of repeated calibrations.

    Attributes
    ----------
    composite_modulus : float
        E* [MPa].
    adhesion_root, adhesion_energy : float
        sqrt(w) [sqrt(N/mm)], negative if the measured loads exceed the law without adhesion, and w [N/mm], at
        least 0.
    adhesive : bool
        Whether the data show adhesion: the 68 % interval of w does not begin at 0.
    root_covariance : ndarray, (2, 2)
        Covariance of E* and sqrt(w), including the error of the radius.
    modulus_without_adhesion : (float, float)
        E* and its standard deviation [MPa] if w is known to be 0.
    estimates : mapping of str to Estimate
        Value, standard deviation and 68 % interval of the E* of `material` and of w; the interval of w is
        asymmetric and may include 0.
    parameters, covariance : tuple of str, and ndarray, (p, p)
        Names and covariance of the parameters for `metafem.studies.uncertainty`; `joint_covariance` adds the
        parameters of shear tests. At a fixed load, the effects of an error of the radius and of the resulting
        error of E* on the contact area nearly cancel.
    material, contact_law : Material and Contact
        Material and law for a model: JKR with E* and w if the data show adhesion, else the law of the cap
        with E* without adhesion.
    sample : Sample
    radius : float
        Radius of the caps [mm].
    radius_change : ndarray, (2,)
        Changes of E* and sqrt(w) if the radius grows by its standard deviation.
    lines : (Line,)
        Total loads [N] over total areas [mm^2] with the fitted law of equal contacts, and their verdict.
    tests : mapping of str to ContactCalibration
        Calibration by each test if there are several; None for a test without a fit.
    heterogeneity : Verdict or None
        Whether the tests agree; None for a single test.
    notes : tuple of Note

    Examples
    --------
    >>> from metafem.calibration import fit_compression
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> found = fit_compression(1.36 * 4 * a**3 / (3 * 0.526), np.pi * a**2, 0.526)
    >>> round(found.composite_modulus, 4), found.adhesive, found.lines[0].verdict.fits
    (1.36, False, True)
    """

    composite_modulus: float
    adhesion_root: float
    root_covariance: FloatArray
    modulus_without_adhesion: tuple[float, float]
    sample: Sample
    radius: float
    radius_change: FloatArray

    @property
    def adhesion_energy(self) -> float:
        """Adhesion energy w [N/mm], at least 0."""
        return max(self.adhesion_root, 0.0) ** 2

    @property
    def adhesive(self) -> bool:
        """Whether the 68 % interval of w does not begin at 0."""
        return self.estimates["adhesion_energy"].interval[0] > 0.0

    @property
    def material(self) -> Material:
        """Material with the E* that belongs to `contact_law`."""
        return Material(self.estimates["composite_modulus"].value)

    @property
    def contact_law(self) -> Contact:
        """Contact law for a model, adhesive if the data show adhesion."""
        energy = self.adhesion_energy if self.adhesive else 0.0
        return self.sample.law(energy, self.material.composite_modulus)


@dataclass(frozen=True, eq=False)
class AreaLaw:
    """Law ``P = c sum_j (E* q(A_j) - b s(A_j))`` of n areas that each stand for c contacts.

    q is the rescaled load P/E* [mm^2] of a contact without adhesion, ``s = sqrt(8 pi a^3)`` [mm^(3/2)] and
    ``A = pi a^2``. `cap` is the contact law of a contact of `radius` [mm], all of whose dimensions are
    multiplied by `scale`, and `contacts` is c.
    """

    cap: Contact
    radius: float
    contacts: int = 1
    adhesive: bool = True
    scale: float = 1.0

    @property
    def widest(self) -> float:
        """Largest contact radius that the law describes [mm]."""
        deepest = float(self.cap.largest_indentation(self.radius))
        if deepest == math.inf:
            return math.inf
        return self.scale * float(self.cap.contact_radius(deepest, self.radius))

    def parts(self, area: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the loads for E* = 1 and b = 1, and their derivatives by the area, (..., n, 2) each."""
        a = np.sqrt(area / math.pi)
        closed = np.clip(a / self.scale, OPEN * self.radius, self.widest / self.scale)
        rescaled = np.where(area > 0.0, self.scale**2 * self.cap.load(closed, self.radius), 0.0)
        slope = self.cap.stiffness(closed, self.radius) / self.cap.area_slope(closed, self.radius)
        lowered = math.sqrt(8.0 * math.pi) * a**1.5
        steep = np.divide(0.75 * lowered, area, np.zeros(area.shape), where=area > 0.0)
        two = (rescaled, -lowered), (slope, -steep)
        load, by_area = (self.contacts * np.stack(np.broadcast_arrays(*each), axis=-1) for each in two)
        kept = slice(None) if self.adhesive else slice(1)
        return load[..., kept], by_area[..., kept]

    def __call__(self, p: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return load and areas (..., k, 1 + n), and their derivatives, as a model of errors in variables."""
        loads, slopes = self.parts(area)
        n, q = area.shape[-1], p.shape[-1]
        total = loads.sum(axis=-2)
        value = np.concatenate([(total @ p[..., None]), area], axis=-1)
        by_p = np.concatenate([total[..., None, :], np.zeros((*area.shape, q))], axis=-2)
        own = (slopes @ p[..., None, :, None])[..., 0][..., None, :]
        by_x = np.concatenate([own, np.broadcast_to(np.eye(n), (*area.shape, n))], axis=-2)
        return value, by_p, by_x


def fit_areas(
    law: AreaLaw,
    load: FloatArray,
    area: FloatArray,
    load_sd: FloatArray,
    area_sd: Callable[[FloatArray], FloatArray],
) -> variables.Fit:
    """Return fits of E* and b to loads (..., k) [N] and areas (..., k, n) [mm^2] of single contacts."""
    measured = np.concatenate([load[..., None], area], axis=-1)

    def deviation(value: FloatArray) -> FloatArray:
        of_load = np.broadcast_to(load_sd, value.shape[:-1])[..., None]
        return np.concatenate([of_load, np.broadcast_to(area_sd(value[..., 1:]), area.shape)], axis=-1)

    start = np.zeros((*load.shape[:-1], 2 if law.adhesive else 1))
    bounds = SMALLEST_PART * area, math.pi * law.widest**2
    return variables.fit(law, measured, deviation, start, area, bounds)


def of_root(fit: variables.Fit) -> tuple[FloatArray, FloatArray]:
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
    sample: Sample | None = None,
    *,
    errors: MeasurementErrors = PAPER,
    test: ArrayLike | None = None,
) -> ContactCalibration:
    """Return E* and the adhesion energy w fitted to loads and contact areas that both have errors.

    The law is ``P = sum_j (E* q(A_j) - b s(A_j))`` with ``b = sqrt(w E*)``, ``s = sqrt(8 pi a^3)`` and
    ``A = pi a^2``. q is the rescaled load P/E* of a contact without adhesion, 4 a^3/(3 R) for
    `metafem.Hertz`. The true areas are unknowns of the fit, which minimises the sum of the squared distances
    from the law over their variances at the fitted areas. b may be negative, so that the intervals of sqrt(w)
    are correct even if w is nearly 0.

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
    ContactCalibration

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
    >>> round(found.composite_modulus, 6), round(found.adhesion_energy, 9)
    (1.36, 9e-06)
    >>> [round(end, 3) for end in found.estimates["composite_modulus"].interval]
    [1.341, 1.379]
    """
    given = Sample() if sample is None else sample
    check.instance("sample", given, Sample, "a metafem.calibration.Sample")
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    size = check.number("radius", radius, above=0.0)
    less = f"must be less than the radius, {size:g} mm"
    refuse_if(given.radius_sd >= size, less, key="radius_sd", value=given.radius_sd)
    points = _points(load, area, given, size, errors)
    law = points.law()
    found = points.whole(law)
    value, covariance = of_root(found)
    change = _radius_change(points)
    total = covariance + np.outer(change, change)
    alone = points.fit(points.law(adhesive=False))
    without = float(alone.parameter[0])
    sd = math.hypot(math.sqrt(alone.covariance[0, 0]), without * change[0] / float(value[0]))
    root, root_sd, (lowest, highest) = positive(float(value[1]), total[1, 1])
    modulus = positive(float(value[0]), total[0, 0]) if lowest > 0.0 else positive(without, sd**2)
    energy = Estimate(max(root, 0.0) ** 2, 2.0 * abs(root) * root_sd, (lowest**2, highest**2))
    shared = given.radius_sd * change[0] * modulus.value / float(value[0])
    joint = np.array([[given.radius_sd**2, shared], [shared, modulus.sd**2]])
    known = 0 if given.radius_sd else 1
    exact = replace(given, radius_sd=0.0)
    tests = each_test(
        test,
        len(points.load),
        lambda rows: fit_compression(points.load[rows], np.asarray(area)[rows], size, exact, errors=errors),
    )
    fitted = [each for each in tests.values() if each is not None]
    made = ContactCalibration(
        composite_modulus=float(value[0]),
        adhesion_root=float(value[1]),
        root_covariance=total,
        modulus_without_adhesion=(without, sd),
        estimates={"composite_modulus": modulus, "adhesion_energy": energy},
        parameters=("radius", "composite_modulus")[known:],
        covariance=joint[known:, known:],
        sample=given,
        radius=size,
        radius_change=change,
        lines=(_line(points, law, found),),
        tests=tests,
        heterogeneity=scatter(
            [(each.composite_modulus, each.adhesion_root) for each in fitted],
            [each.root_covariance for each in fitted],
        ),
    )
    widest = math.sqrt(points.area.max() / math.pi) / size
    _refuse_unusual(modulus.value, widest, points)
    return replace(made, notes=(*_notes(made, widest), *made.doubts()))


@dataclass(frozen=True, eq=False)
class _Points:
    """Total loads (k,) and areas of single contacts (k, n), each of which stands for as many contacts."""

    load: FloatArray
    area: FloatArray
    sample: Sample
    radius: float
    errors: MeasurementErrors

    @property
    def alike(self) -> int:
        """Number of equal contacts for which an area stands."""
        return self.sample.contacts // len(self.area[0])

    def law(self, adhesive: bool = True, scale: float = 1.0) -> AreaLaw:
        """Return the law of the areas, of caps that are larger by a factor in all dimensions."""
        return AreaLaw(self.sample.contact, self.radius, self.alike, adhesive, scale)

    def sd_of(self, area: FloatArray) -> FloatArray:
        """Return the standard deviations of fitted areas [mm^2], of open contacts too."""
        each = self.errors.of_area(area)
        opened = np.maximum(each, self.errors.of_open)
        return np.asarray(np.where(self.area > 0.0, each, opened) / math.sqrt(self.alike))

    def fit(self, law: AreaLaw) -> variables.Fit:
        """Return the fit of a law."""
        return fit_areas(law, self.load, self.area, self.errors.of_load(self.load), self.sd_of)

    def whole(self, law: AreaLaw) -> variables.Fit:
        """Return the fit of a law, or raise if it does not exist."""
        fit = self.fit(law)
        if not fit.converged:
            raise NotConverged(
                "the fit of E* and the adhesion energy does not converge; leave out areas that are not much "
                "larger than their errors, or check their unit",
                fit,
            )
        modulus = float(fit.parameter[0])
        falls = f"the load does not grow with the contact area: the fitted E* is {modulus:.3g} MPa; check the"
        refuse_if(not modulus > 0.0, f"{falls} columns and their order")
        return fit


def _points(
    load: ArrayLike, area: ArrayLike, sample: Sample, radius: float, errors: MeasurementErrors
) -> _Points:
    """Return the checked loads and areas."""
    loads = check.array("load", load, shape=(None,))
    count, number, one_by_one = len(loads), sample.contacts, np.ndim(area) == 2
    few = f"load has {count} points; E* and the adhesion energy need at least {FEWEST}, at different areas"
    refuse_if(count < FEWEST, few)
    given = check.array("area", area, shape=(count, number) if one_by_one else (count,))
    check.refuse_entries("area", given, given < 0.0, "must not be negative")
    total = given.sum(axis=1) if one_by_one else given
    check.refuse_entries("area", total, total == 0.0, "is no contact; leave the row out")
    same = f"all areas are {total.max():g} mm^2: E* and the adhesion energy need points at different areas"
    refuse_if(np.ptp(total) <= ONE_AREA * total.max(), same)
    points = _Points(loads, given if one_by_one else given[:, None] / number, sample, radius, errors)
    share = (np.sqrt(points.area / math.pi) / radius).reshape(given.shape)
    reach = points.law().widest / radius
    ends = f"is beyond the largest contact of {shown(sample.contact)}, whose radius is {reach:.3g} R; leave "
    check.refuse_entries("area", given, share > (1.0 + ROUNDING) * reach, f"{ends}the point out")
    return points


def _radius_change(points: _Points) -> FloatArray:
    """Return the changes of E* and sqrt(w) if the radius grows by its standard deviation, (2,)."""
    sd = points.sample.radius_sd / points.radius
    if sd == 0.0:
        return np.zeros(2)
    high, low = (of_root(points.whole(points.law(scale=1.0 + sign * sd)))[0] for sign in (1.0, -1.0))
    return np.asarray(0.5 * (high - low))


def _refuse_unusual(modulus: float, widest: float, points: _Points) -> None:
    """Raise InvalidInput if E* [MPa] or the largest contact radius over R is not that of a soft material."""
    (small, wide), (least, most), sample = SHARES, MODULI, points.sample
    usual = small <= widest <= wide and least <= modulus <= most
    refuse_if(
        not (usual or sample.unusual),
        f"E* = {modulus:.4g} MPa with contact radii up to {widest:.3g} R is unusual: soft materials have "
        f"{least:g} to {most:g} MPa, and contacts {small:g} to {wide:g} R; check the units of loads and "
        f"areas, the radius, {points.radius:g} mm, and the number of contacts under one load, "
        f"{sample.contacts}; if they are right, insist with the option --unusual (in Python, "
        "Sample(unusual=True))",
    )


def _line(points: _Points, law: AreaLaw, fit: variables.Fit) -> Line:
    """Return the measured and the fitted total loads over total areas."""
    grid = np.linspace(0.0, float(points.area.mean(axis=1).max()), GRID)
    count = points.area.shape[1]
    off = points.load - (law.parts(fit.abscissa)[0].sum(axis=-2) @ fit.parameter)
    return Line(
        name="E* and w",
        axes=("load  P [N]", "contact area  A0 [mm²]"),
        x=points.load,
        y=law.contacts * points.area.sum(axis=1),
        x_sd=points.errors.of_load(points.load),
        y_sd=law.contacts * np.sqrt((points.sd_of(fit.abscissa) ** 2).sum(axis=1)),
        fitted_x=count * law.parts(grid)[0] @ fit.parameter,
        fitted_y=points.sample.contacts * grid,
        residual=np.sign(off) * np.sqrt(fit.chi_square),
        parameters=2,
    )


def _notes(found: ContactCalibration, widest: float) -> Iterator[Note]:
    """Return notes on the range of the data, adhesion and the error of the radius."""
    table = isinstance(found.sample.contact, TabulatedContact)
    if widest > KNOWN and not table:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads, or use a table of finite elements "
            "as the contact law, metafem.TabulatedContact"
        )
    if not found.adhesive:
        modulus, sd = found.modulus_without_adhesion
        yield information(
            f"the data do not show adhesion: the 68 % interval of w begins at 0; with w = 0, "
            f"E* = {modulus:.4g} ± {sd:.2g} MPa"
        )
    elif table:
        yield Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
    if found.sample.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        yield information(f"the error of the radius changes E* by {percent(share)}")
