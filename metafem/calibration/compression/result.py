"""Result of a compression calibration: E* and the adhesion energy with their uncertainties."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.bounded_interval import WIDTH, interval_of
from metafem.calibration.compression.adhesive_line import AdhesiveLine
from metafem.calibration.covariance import propagated
from metafem.calibration.verdict import SingleTest, Verdict
from metafem.contact import Contact
from metafem.drawing import calibration
from metafem.material import Material
from metafem.notes import Note, counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Names of the parameters, in the order of `metafem.studies.uncertainty`.
PARAMETERS = ("radius", "composite_modulus")


@dataclass(frozen=True, eq=False, repr=False)
class ContactCalibration(Value):
    """Composite modulus E* and adhesion energy w from compression tests.

    Intervals contain the true value in 68 % of repeated calibrations.

    Attributes
    ----------
    material : Material
        Material with the fitted E*.
    composite_modulus, adhesion_energy : float
        E* [MPa] and w [N/mm], at least 0.
    adhesion_root : float
        sqrt(w) [sqrt(N/mm)]; negative if the measured loads exceed the law without adhesion.
    composite_modulus_interval, adhesion_energy_interval, adhesion_root_interval : (float, float)
        68 % intervals; the interval of w is asymmetric and may include 0.
    covariance : ndarray, (2, 2)
        Covariance of E* and w; includes the error of the radius.
    parameters, parameter_covariance : tuple of str, and ndarray, (p, p)
        Names and covariance of the parameters for `metafem.studies.uncertainty`; `joint_covariance` adds the
        parameters of shear tests.
    root_covariance, statistical_covariance : ndarray, (2, 2)
        Covariances of E* and sqrt(w), with and without the error of the radius.
    radius, radius_sd : float
        Radius of the caps and its standard deviation [mm].
    radius_change : ndarray, (2,)
        Changes of E* and sqrt(w) if the radius grows by its standard deviation.
    contact_law : Contact
        Contact law for a model: the law of the cap, adhesive if w > 0.
    load, load_sd, load_fitted : ndarray, (k,)
        Measured loads, their standard deviations, and the fitted loads at the measured areas [N].
    law_load, law_area : ndarray, (m,)
        Loads [N] and total areas [mm^2] of the fitted law for contacts of equal area.
    area, area_sd : ndarray, (k,) or (k, contacts)
        Measured total areas or areas of single contacts, and the standard deviations at the fitted areas
        [mm^2].
    contacts : int
        Number of contacts that share a load.
    residual : ndarray, (k,)
        Distances from the law over their standard deviations [-].
    verdict : Verdict
        Whether the law fits the points.
    line : AdhesiveLine
        The straight line of Aymard et al. through the same points.
    tests : tuple of SingleTest
        E* and sqrt(w) of each test if there are several tests; nan for a test with too few points.
    heterogeneity : Verdict or None
        Whether the tests agree; None for a single test.
    notes : tuple of Note

    Examples
    --------
    >>> from metafem.calibration import fit_compression
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> found = fit_compression(1.36 * 4 * a**3 / (3 * 0.526), np.pi * a**2, 0.526)
    >>> round(found.composite_modulus, 4), found.adhesion_energy < 1e-20, found.verdict.fits
    (1.36, True, True)
    """

    material: Material
    adhesion_root: float
    root_covariance: FloatArray
    statistical_covariance: FloatArray
    radius: float
    radius_sd: float
    radius_change: FloatArray
    contact_law: Contact
    load: FloatArray
    load_sd: FloatArray
    load_fitted: FloatArray
    law_load: FloatArray
    law_area: FloatArray
    area: FloatArray
    area_sd: FloatArray
    contacts: int
    residual: FloatArray
    verdict: Verdict
    line: AdhesiveLine
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
    def composite_modulus(self) -> float:
        """Composite modulus E* [MPa]."""
        return self.material.composite_modulus

    @property
    def adhesion_energy(self) -> float:
        """Adhesion energy w [N/mm], at least 0."""
        return max(self.adhesion_root, 0.0) ** 2

    @property
    def covariance(self) -> FloatArray:
        """Covariance of E* and w, (2, 2), for a normally distributed sqrt(w)."""
        (first, both), (_, last) = self.root_covariance
        root = max(self.adhesion_root, 0.0)
        mixed = 2.0 * root * both
        return np.array([[first, mixed], [mixed, 4.0 * root**2 * last + 2.0 * last**2]])

    @property
    def composite_modulus_interval(self) -> tuple[float, float]:
        """68 % interval of E* [MPa], nowhere negative."""
        return interval_of(self.composite_modulus, self.root_covariance[0, 0])

    @property
    def adhesion_root_interval(self) -> tuple[float, float]:
        """68 % interval of sqrt(w) [sqrt(N/mm)], symmetric about an estimate that may be negative."""
        half = WIDTH * math.sqrt(self.root_covariance[1, 1])
        return self.adhesion_root - half, self.adhesion_root + half

    @property
    def adhesion_energy_interval(self) -> tuple[float, float]:
        """68 % interval of w [N/mm], asymmetric; it begins at 0 if the data do not show adhesion."""
        low, high = interval_of(self.adhesion_root, self.root_covariance[1, 1])
        return low**2, high**2

    @property
    def modulus_without_adhesion(self) -> tuple[float, float]:
        """E* and its standard deviation [MPa] if w is known to be 0."""
        # the fit is linear in E* and b = sqrt(w E*)
        modulus, root = self.composite_modulus, self.adhesion_root
        scale = math.sqrt(modulus)
        rows = (1.0, 0.0), (0.5 * root / scale, scale)
        (first, both), (_, last) = propagated(self.statistical_covariance, *rows)
        without = modulus - both / last * root * scale
        systematic = without * self.radius_change[0] / modulus
        return float(without), math.sqrt(first - both**2 / last + systematic**2)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the rows of `parameter_covariance`, for `metafem.studies.uncertainty`."""
        return PARAMETERS if self.radius_sd else PARAMETERS[1:]

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of E* [MPa] and, if it has an error, the radius [mm], (1, 1) or (2, 2).

        The fitted E* grows with the assumed radius. At a fixed load, the effects of an error of the radius
        and of the resulting error of E* on the contact area nearly cancel.
        """
        variance, radius = self.root_covariance[0, 0], self.radius_sd
        if not radius:
            return np.array([[variance]])
        both = radius * self.radius_change[0]
        return np.array([[radius**2, both], [both, variance]])

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
        calibration.measured(ax, self.load, self.total_area, self.load_sd, self.total_area_sd)
        calibration.fitted(ax, self.law_load, self.law_area)
        ax.set_xlabel("load  P [N]")
        ax.set_ylabel("contact area  A0 [mm²]")
        return ax

    @property
    def total_area(self) -> FloatArray:
        """Measured total areas [mm^2], (k,)."""
        return self.area if self.area.ndim == 1 else np.asarray(self.area.sum(axis=1))

    @property
    def total_area_sd(self) -> FloatArray:
        """Standard deviations of the total areas [mm^2], (k,)."""
        return self.area_sd if self.area.ndim == 1 else np.sqrt((self.area_sd**2).sum(axis=1))
