"""Composite modulus and adhesion energy from the loads and contact areas of compression tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.statistics import (
    PAPER,
    MeasurementErrors,
    SingleTest,
    Verdict,
    interval_of,
    judged,
    labels_of,
    scatter,
)
from metafem.caps import Profile
from metafem.contact import JKR, Contact, Elastic, Hertz, TabulatedContact
from metafem.contact.law import checked_contact
from metafem.drawing import calibration
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.material import Material
from metafem.notes import Note, counted, information

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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

# Range of the largest contact radius over R and of E* [MPa] for soft contacts (a/R above SOFT). Beyond it, a
# unit or a number is usually wrong: rubbers and gels have moduli of 0.01 to 100 MPa.
SHARES, MODULI, SOFT = (1e-3, 1.0), (0.01, 100.0), 0.02

# Smallest ratio of a fitted to a measured area during the iteration, which keeps the areas positive.
SMALLEST_PART = 0.1

# JKR law with w = 1 N/mm and E* = 1 MPa.
UNIT = JKR(1.0, material=Material(1.0))

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
    poisson_ratio : float
        Poisson's ratio of the material [-]; default: 0.5.
    contact : Contact
        Elastic contact law of a cap, without adhesion; default: `metafem.Hertz`.
    unusual : bool
        Whether moduli outside 0.01 to 100 MPa of contacts with a/R > 0.02, and contact radii outside 0.001 R
        to R, are accepted; default: False.

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
    poisson_ratio: float = 0.5
    contact: Contact = HERTZ
    unusual: bool = False

    def __post_init__(self) -> None:
        check.integer("contacts", self.contacts, at_least=1)
        check.member(self, "radius_sd", at_least=0.0)
        check.member(self, "poisson_ratio", **check.POISSON)
        law = checked_contact(self.contact)
        without = "; give the cap, such as metafem.Hertz()"
        of_one_modulus = isinstance(law, TabulatedContact) and law.material is None
        for holds, reason in (
            (law.adhesive, f"has an adhesion energy, which is fitted{without}"),
            (law.plastic, f"is plastic; E* is fitted to an elastic law{without}"),
            (law == Elastic(), f"takes the caps of a surface{without}"),
            (
                of_one_modulus,
                "has loads in N for one E*, which must be known: contact.for_material(material)",
            ),
        ):
            refuse_if(holds, f"contact = {shown(law)} {reason}")

    def scaled(self, scale: float) -> Contact:
        """Return the contact law of a cap scaled in all dimensions; others only take their radius."""
        law = self.contact
        if isinstance(law, TabulatedContact):
            depth, load, area = law.table
            return TabulatedContact(scale * depth, scale**2 * load, scale**2 * area, material=law.material)
        if isinstance(law, Elastic) and isinstance(law.cap, Profile):
            profile = law.cap.profile
            if callable(profile):
                return Elastic(Profile(lambda rho: scale * profile(rho / scale), scale * law.cap.reach))
            return Elastic(Profile(scale * profile))
        return law

    def law(self, adhesion_energy: float, modulus: float) -> Contact:
        """Return the contact law of the cap for this E* [MPa], adhesive if w > 0 [N/mm]."""
        cap = self.contact
        if isinstance(cap, TabulatedContact) and cap.material is not None:
            depth, load, area = cap.table
            return TabulatedContact(depth, load * (modulus / cap.material.composite_modulus), area)
        return JKR(adhesion_energy, cap) if adhesion_energy > 0.0 and cap.largest_order > 1 else cap


@dataclass(frozen=True, eq=False, repr=False)
class ContactCalibration(Value):
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
    composite_modulus_interval, adhesion_energy_interval : (float, float)
        68 % intervals; the interval of w is asymmetric and may include 0.
    modulus_without_adhesion : (float, float)
        E* and its standard deviation [MPa] if w is known to be 0.
    parameters, parameter_covariance : tuple of str, and ndarray, (p, p)
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
    load, load_sd : ndarray, (k,)
        Measured loads and their standard deviations [N].
    area, area_sd : ndarray, (k,)
        Measured total areas, and their standard deviations at the fitted areas [mm^2].
    law_load, law_area : ndarray, (m,)
        Loads [N] and total areas [mm^2] of the fitted law for contacts of equal area.
    residual : ndarray, (k,)
        Distances from the law over their standard deviations [-].
    verdict : Verdict
        Whether the law fits the points.
    tests : tuple of SingleTest
        E* and sqrt(w) of each test if there are several tests; nan for a test without a fit.
    heterogeneity : Verdict or None
        Whether the tests agree; None for a single test.
    notes : tuple of Note

    Examples
    --------
    >>> from metafem.calibration import fit_compression
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> found = fit_compression(1.36 * 4 * a**3 / (3 * 0.526), np.pi * a**2, 0.526)
    >>> round(found.composite_modulus, 4), found.adhesive, found.verdict.fits
    (1.36, False, True)
    """

    composite_modulus: float
    adhesion_root: float
    root_covariance: FloatArray
    modulus_without_adhesion: tuple[float, float]
    sample: Sample
    radius: float
    radius_change: FloatArray
    load: FloatArray
    load_sd: FloatArray
    area: FloatArray
    area_sd: FloatArray
    law_load: FloatArray
    law_area: FloatArray
    residual: FloatArray
    verdict: Verdict
    tests: tuple[SingleTest, ...] = ()
    heterogeneity: Verdict | None = None
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        modulus, root = np.sqrt(np.diag(self.root_covariance))
        return (
            f"<ContactCalibration: E* = {self.composite_modulus:.4g} ± {modulus:.2g} MPa, "
            f"sqrt(w) = {self.adhesion_root:.3g} ± {root:.2g} sqrt(N/mm), {len(self.load)} points, "
            f"{'fits' if self.verdict.fits else 'does not fit'}, {counted(self.notes)}>"
        )

    @property
    def adhesion_energy(self) -> float:
        """Adhesion energy w [N/mm], at least 0."""
        return max(self.adhesion_root, 0.0) ** 2

    @property
    def adhesive(self) -> bool:
        """Whether the 68 % interval of w does not begin at 0."""
        return self.adhesion_energy_interval[0] > 0.0

    @property
    def material(self) -> Material:
        """Material with the E* that belongs to `contact_law`."""
        modulus = self.composite_modulus if self.adhesive else self.modulus_without_adhesion[0]
        return Material(modulus, self.sample.poisson_ratio)

    @property
    def contact_law(self) -> Contact:
        """Contact law for a model, adhesive if the data show adhesion."""
        energy = self.adhesion_energy if self.adhesive else 0.0
        return self.sample.law(energy, self.material.composite_modulus)

    @property
    def composite_modulus_interval(self) -> tuple[float, float]:
        """68 % interval of E* [MPa], nowhere negative."""
        return interval_of(self.composite_modulus, self.root_covariance[0, 0])

    @property
    def adhesion_energy_interval(self) -> tuple[float, float]:
        """68 % interval of w [N/mm], asymmetric; it begins at 0 if the data do not show adhesion."""
        low, high = interval_of(self.adhesion_root, self.root_covariance[1, 1])
        return low**2, high**2

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the rows of `parameter_covariance`."""
        return ("radius", "composite_modulus") if self.sample.radius_sd else ("composite_modulus",)

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of the radius [mm], if it has an error, and the E* of `material` [MPa]."""
        (alone, alone_sd), sd, change = (
            self.modulus_without_adhesion,
            self.sample.radius_sd,
            self.radius_change[0],
        )
        variance = self.root_covariance[0, 0]
        if not self.adhesive:
            variance, change = alone_sd**2, change * alone / self.composite_modulus
        whole = np.array([[sd**2, sd * change], [sd * change, variance]])
        return whole if sd else whole[1:, 1:]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the measured points with error bars and the fitted law, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.

        Examples
        --------
        >>> from metafem.calibration import fit_compression
        >>> a = np.linspace(0.08, 0.4, 20)
        >>> fit_compression(1.36 * 4 * a**3 / (3 * 0.526), np.pi * a**2, 0.526).plot().get_xlabel()
        'load  P [N]'
        """
        ax = drawing.axes(ax)
        calibration.measured(ax, self.load, self.area, self.load_sd, self.area_sd)
        calibration.fitted(ax, self.law_load, self.law_area)
        ax.set(xlabel="load  P [N]", ylabel="contact area  A0 [mm²]")
        return ax


@dataclass(frozen=True, eq=False)
class AreaLaw:
    """Law ``P = c sum_j (E* q(A_j) - b s(A_j))`` of n areas that each stand for c contacts.

    q is the rescaled load P/E* [mm^2] of a contact without adhesion, ``s = sqrt(8 pi a^3)`` [mm^(3/2)] and
    ``A = pi a^2``. `cap` is the contact law of a contact of `radius` [mm], and `contacts` is c.
    """

    cap: Contact
    radius: float
    contacts: int = 1
    adhesive: bool = True

    @property
    def largest(self) -> float:
        """Largest area of a contact that the law describes [mm^2]."""
        deepest = float(self.cap.largest_indentation(self.radius))
        return (
            math.pi * float(self.cap.contact_radius(deepest, self.radius)) ** 2
            if deepest < math.inf
            else math.inf
        )

    def parts(self, area: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the loads for E* = 1 and b = 1, and their derivatives by the area, (..., n, 2) each."""
        radius = np.sqrt(area / math.pi)
        widest = math.sqrt(self.largest / math.pi)
        closed = np.clip(radius, OPEN * self.radius, widest)
        rescaled = np.where(area > 0.0, self.cap.load(closed, self.radius), 0.0)
        slope = self.cap.stiffness(closed, self.radius) / self.cap.area_slope(closed, self.radius)
        lowered = 2.0 * radius * UNIT.deficit(radius)
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
    return variables.fit(law, measured, deviation, start, area, (SMALLEST_PART * area, law.largest))


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
    >>> [round(end, 3) for end in found.composite_modulus_interval]
    [1.341, 1.379]
    """
    given = Sample() if sample is None else sample
    check.instance("sample", given, Sample, "a metafem.calibration.Sample")
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    size = check.number("radius", radius, above=0.0)
    less = "must be less than the radius, {.number}"
    refuse_if(given.radius_sd >= size, less, Given("radius", size), key="radius_sd", value=given.radius_sd)
    loads, areas = _checked(load, area, given.contacts)
    data = _Data(given, size, loads, areas, errors, labels_of(test, len(loads)))
    data.refuse_beyond()
    found = data.whole()
    value, covariance = of_root(found)
    change = np.zeros(2)
    if given.radius_sd:
        high, low = (of_root(data.whole(sign * given.radius_sd))[0] for sign in (1.0, -1.0))
        change = 0.5 * (high - low)
    labels = list(dict.fromkeys(data.test))
    tests = tuple(data.single(name) for name in labels) if len(labels) > 1 else ()
    law = data.law()
    area_grid = np.linspace(0.0, float(areas.mean(axis=1).max()), GRID)
    off = loads - (law.parts(found.abscissa)[0].sum(axis=-2) @ found.parameter)
    residual = np.sign(off) * np.sqrt(found.chi_square)
    made = ContactCalibration(
        composite_modulus=float(value[0]),
        adhesion_root=float(value[1]),
        root_covariance=covariance + np.outer(change, change),
        modulus_without_adhesion=data.without_adhesion(change[0] / value[0]),
        sample=given,
        radius=size,
        radius_change=change,
        load=loads,
        load_sd=errors.of_load(loads),
        area=law.contacts * areas.sum(axis=1),
        area_sd=law.contacts * np.sqrt((data.sd_of(found.abscissa) ** 2).sum(axis=1)),
        law_load=areas.shape[1] * law.parts(area_grid)[0] @ found.parameter,
        law_area=given.contacts * area_grid,
        residual=residual,
        verdict=judged(residual, 2),
        tests=tests,
        heterogeneity=scatter(tests),
    )
    data.refuse_unusual(made)
    return replace(made, notes=tuple(_notes(made, math.sqrt(areas.max() / math.pi) / size)))


@dataclass(frozen=True, eq=False)
class _Data:
    """Total loads (k,) and areas of single contacts (k, n), each of which stands for as many contacts."""

    sample: Sample
    radius: float
    load: FloatArray
    area: FloatArray
    errors: MeasurementErrors
    test: tuple[str, ...]

    def law(self, change: float = 0.0, adhesive: bool = True) -> AreaLaw:
        """Return the law of the areas, of caps whose radius is changed [mm]."""
        scale = 1.0 + change / self.radius
        cap = self.sample.scaled(scale) if change else self.sample.contact
        return AreaLaw(cap, scale * self.radius, self.sample.contacts // self.area.shape[1], adhesive)

    def sd_of(self, area: FloatArray, rows: Any = slice(None)) -> FloatArray:
        """Return the standard deviations of fitted areas [mm^2], of open contacts too."""
        each, closed = self.errors.of_area(area), self.area[rows] > 0.0
        alike = math.sqrt(self.sample.contacts // self.area.shape[1])
        return np.asarray(np.where(closed, each, np.maximum(each, self.errors.of_open)) / alike)

    def fit(self, law: AreaLaw, rows: Any = slice(None)) -> variables.Fit:
        """Return the fit of a law to some of the points."""
        load, area = self.load[rows], self.area[rows]
        return fit_areas(law, load, area, self.errors.of_load(load), lambda of: self.sd_of(of, rows))

    def whole(self, change: float = 0.0) -> variables.Fit:
        """Return the fit to all points, or raise if it does not exist."""
        fit = self.fit(self.law(change))
        if not fit.converged:
            uncertain = self.sd_of(self.area) / np.where(self.area > 0.0, self.area, np.inf)
            i, j = np.unravel_index(int(uncertain.argmax()), uncertain.shape)
            raise NotConverged(
                "the fit of E* and the adhesion energy does not converge; the most uncertain area is {}, "
                f"with an error of {percent(float(uncertain.max()))}; leave out areas that are not much "
                "larger than their errors, or check their unit",
                fit,
                Given(*self.entry(int(i), int(j)).values()),
            )
        order = np.argsort(self.area.sum(axis=1), kind="stable")
        refuse_if(
            not fit.parameter[0] > 0.0,
            "the load does not grow with the contact area: {} at the smallest area and {} at the largest, "
            f"and the fitted E* is {float(fit.parameter[0]):.3g} MPa; check the columns and their order",
            *(Given(f"load[{i}]", self.load[i]) for i in order[[0, -1]].tolist()),
        )
        return fit

    def without_adhesion(self, relative: float) -> tuple[float, float]:
        """Return E* and its standard deviation for w = 0; `relative` is the error by the radius."""
        fit = self.fit(self.law(adhesive=False))
        modulus = float(fit.parameter[0])
        return modulus, math.hypot(math.sqrt(fit.covariance[0, 0]), relative * modulus)

    def single(self, name: str) -> SingleTest:
        """Return the fit to the points of one test; its values are nan if no fit exists."""
        rows = np.flatnonzero(np.array(self.test) == name)
        area = self.area[rows]
        if len(rows) >= FEWEST and np.ptp(area.sum(axis=1)) > ONE_AREA * area.max():
            fit = self.fit(self.law(), rows)
            if fit.converged and fit.parameter[0] > 0.0:
                return SingleTest(name, len(rows), *of_root(fit))
        return SingleTest(name, len(rows), np.full(2, np.nan), np.full((2, 2), np.nan))

    def refuse_beyond(self) -> None:
        """Raise InvalidInput if an area exceeds the largest area of the law, or of any cap of the radius."""
        law = self.law()
        last = Given("area", law.contacts * law.largest), Given("contact", shown(self.sample.contact))
        must = "is beyond {.number}, the last area of {.number}; leave the point out, or give a law that"
        for i, j in np.argwhere(self.area > (1.0 + ROUNDING) * law.largest)[:1].tolist():
            raise InvalidInput(f"{must} reaches it", *last, **self.entry(i, j))
        closed = self.area[self.area > 0.0]
        usual, most = float(np.median(closed)), float(closed.max())
        wrong = most if most > math.pi * (SHARES[1] * self.radius) ** 2 else usual
        place = np.unravel_index(int(np.abs(self.area - wrong).argmin()), self.area.shape)
        share = math.sqrt(wrong / math.pi) / self.radius
        refuse_if(
            not self.sample.unusual and not SHARES[0] <= share <= SHARES[1],
            f"is that of a contact radius of {share:.3g} R; usual are {SHARES[0]:g} to {SHARES[1]:g} R. "
            "Check the radius, {.number}, the unit of the areas, and the number of contacts under one load, "
            f"{self.sample.contacts}{INSIST}",
            Given("radius", self.radius),
            **self.entry(int(place[0]), int(place[1])),
        )

    def refuse_unusual(self, found: ContactCalibration) -> None:
        """Raise InvalidInput if E* is not that of a soft material, although the contacts are wide."""
        least, most = MODULI
        modulus = found.material.composite_modulus
        soft = math.sqrt(float(self.area.max()) / math.pi) / self.radius > SOFT
        refuse_if(
            not self.sample.unusual and soft and not least <= modulus <= most,
            f"E* = {modulus:.4g} MPa is not that of a soft material, {least:g} to {most:g} MPa; check the "
            f"unit of the loads, that of the radius, {{.number}}, and that of the areas{INSIST}",
            Given("radius", self.radius),
        )

    def entry(self, i: int, j: int) -> dict[str, Any]:
        """Return the key and the value of an area for an error."""
        one_by_one = self.area.shape[1] > 1
        if one_by_one:
            return {"key": f"area[{i}, {j}]", "value": self.area[i, j]}
        return {"key": f"area[{i}]", "value": self.sample.contacts * self.area[i, j]}


# What a user does whose numbers are right although they are unusual.
INSIST = "; if they are right, insist with the option --unusual (in Python, Sample(unusual=True))"


def _checked(load: Any, area: Any, number: int) -> tuple[FloatArray, FloatArray]:
    """Return the checked loads (k,) and areas of single contacts (k, n)."""
    loads = check.array("load", load, shape=(None,))
    count, one_by_one = len(loads), check.depth(area) == 2
    few = f"load has {count} points; E* and the adhesion energy need at least {FEWEST}, at different areas"
    refuse_if(count < FEWEST, few)
    shape = (count, number) if one_by_one else (count,)
    areas = check.array("area", area, shape=shape)
    check.refuse_entries("area", areas, areas < 0.0, "must not be negative")
    total = areas.sum(axis=1) if one_by_one else areas
    check.refuse_entries("area", total, total == 0.0, "is no contact; leave the row out")
    alike = "all areas are {.number}: E* and the adhesion energy need points at different areas"
    refuse_if(np.ptp(total) <= ONE_AREA * total.max(), alike, Given("area", total.max()))
    of_each = 1 if one_by_one else number
    return loads, areas.reshape(count, -1) / of_each


def _notes(found: ContactCalibration, widest: float) -> Iterator[Note]:
    """Return notes on the range of the data, adhesion, the fit and the tests."""
    table = isinstance(found.sample.contact, TabulatedContact)
    if widest > KNOWN and not table:
        yield Note(
            f"contact radii reach {widest:.2f} R; beyond {KNOWN} R large strain changes the load of a soft "
            "cap, which appears as adhesion. Leave out the largest loads, or use a table of "
            "finite elements as the contact law, metafem.TabulatedContact"
        )
    if not found.adhesive:
        modulus, sd = found.modulus_without_adhesion
        yield information(
            f"the data do not show adhesion: the 68 % interval of w begins at 0; with w = 0, "
            f"E* = {modulus:.4g} ± {sd:.2g} MPa"
        )
    elif table:
        yield Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
    if not found.verdict.fits:
        yield found.verdict.note("the law does not fit")
    if found.heterogeneity is not None and not found.heterogeneity.fits:
        yield found.heterogeneity.note("the tests differ")
    unfitted = ", ".join(test.name for test in found.tests if np.isnan(test.value[0]))
    if unfitted:
        yield Note(
            f"the tests {unfitted} have no fit of their own: they have few points, or loads that do not grow "
            "with their areas; they are part of the common fit only"
        )
    if found.sample.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        yield information(f"the error of the radius changes E* by {percent(share)}")
