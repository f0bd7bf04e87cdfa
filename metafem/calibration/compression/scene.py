"""Load as a function of contact area for a calibration sample with E* = 1 and without adhesion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.caps import Caps
from metafem.contact import JKR, AxisymmetricCap, Contact, Elastic, SphericalCap, TabulatedContact
from metafem.errors import refuse_if
from metafem.material import Material
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.prediction import equilibrium
from metafem.surface import Surface

# Default model of a sample.
INDEPENDENT = Independent()

# Contact radius over R at which the slope of an open contact is evaluated.
OPEN = 1e-6

# Largest contact radius over R of a sphere; at 1 the load is infinite.
MOST_OF_SPHERE = 0.999

# Largest relative difference between radii that count as equal.
SAME = 1e-9

# Range of the states of a sample: smallest area over the smallest measured area (BELOW), largest area over
# the largest measured area (ABOVE) and over the largest area of the law (WITHIN). Number of states (GRID),
# and smallest number of states in which each contact must be closed.
BELOW, ABOVE, WITHIN, GRID, FEWEST_STATES = 0.5, 1.5, 0.97, 60, 8


@dataclass(frozen=True, eq=False)
class AreaCurve:
    """Rescaled load as a function of contact area.

    Attributes
    ----------
    load_and_slope : callable
        Returns P/E* [mm^2] and its derivative with respect to the area [-] for contact areas (..., n) [mm^2].
    largest : float or ndarray, (n,)
        Largest areas that the law describes [mm^2]; infinite if there is no limit.
    """

    load_and_slope: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    largest: float | FloatArray


@dataclass(frozen=True)
class Sample:
    """Sample of a compression test: its contacts, its surface and its model.

    Parameters
    ----------
    contacts : int
        Number of contacts that share a load; default: 1. If only their total area was measured, the contacts
        are assumed to be equal.
    radius_sd : float
        Standard deviation of R [mm], common to all points; default: 0. Caps with a profile or a table are
        scaled in all dimensions.
    poisson_ratio : float, optional
        Poisson's ratio of the material [-]; default: the value of `surface`, or 0.5 without a surface.
    model : Model
        Model of the sample with the elastic contact law of its caps, without adhesion; default:
        `metafem.Independent()`. A model with interaction needs `surface`.
    surface : Surface, optional
        Surface with the positions, heights and radii of the caps, and the block; default: none, for contacts
        far apart.

    Raises
    ------
    InvalidInput
        If the contact law is adhesive or plastic, or if `surface` has another number of caps or another
        Poisson's ratio.

    Examples
    --------
    >>> Sample(contacts=5, radius_sd=0.005).model
    Independent()
    """

    contacts: int = 1
    radius_sd: float = 0.0
    poisson_ratio: float | None = None
    model: Model = INDEPENDENT
    surface: Surface | None = None

    def __post_init__(self) -> None:
        check.integer("contacts", self.contacts, at_least=1)
        check.member(self, "radius_sd", at_least=0.0)
        check.member(self, "poisson_ratio", optional=True, **check.POISSON)
        self._refuse_law(contact_of(checked_model(self.model)))
        if self.surface is not None:
            check.instance("surface", self.surface, Surface, "a metafem.Surface")
            self._refuse_other(self.surface)
        refuse_if(
            self.surface is None and self.model.couples,
            "model needs surface, the calibration sample: its caps with their positions, and its block",
        )

    @property
    def cap(self) -> Contact:
        """Contact law of a cap without adhesion."""
        law = contact_of(self.model)
        return law if self.surface is None or not isinstance(law, Elastic) else law.bound(self.surface)

    @property
    def ratio(self) -> float:
        """Poisson's ratio of the sample [-]."""
        if self.surface is not None:
            return self.surface.material.poisson_ratio
        return 0.5 if self.poisson_ratio is None else self.poisson_ratio

    def curve(self, radius: float, scale: float, area: FloatArray, one_by_one: bool) -> AreaCurve:
        """Return the load curve over areas (k, n) [mm^2], with all radii multiplied by `scale`."""
        law = self.cap if scale == 1.0 else scaled_cap(self.cap, scale)
        if self.surface is None:
            return cap_curve(law, scale * radius)
        scaled = self.surface.replaced(radius=scale * self.surface.radius, material=Material(1.0, self.ratio))
        return sample_curve(scaled, with_contact(self.model, law), area, one_by_one)

    def refuse_radius(self, radius: float) -> None:
        """Raise InvalidInput if a radius [mm] is below its error or differs from the surface's radii."""
        given = Given("radius", radius)
        less = "must be less than the radius, {.number}"
        refuse_if(self.radius_sd >= radius, less, given, key="radius_sd", value=self.radius_sd)
        if self.surface is not None:
            own = self.surface.radius
            i = int(np.abs(own - radius).argmax())
            other, key = "differs from {}; they must be the same", f"surface.radius[{i}]"
            refuse_if(abs(own[i] / radius - 1.0) > SAME, other, given, key=key, value=own[i])

    def _refuse_law(self, law: Contact) -> None:
        """Raise InvalidInput for a contact law whose load at a given area is not proportional to E*."""
        without = "; give the model its cap, such as metafem.Independent(contact=metafem.Hertz())"
        of_one_modulus = isinstance(law, TabulatedContact) and law.material is None
        for holds, reason in (
            (law.adhesive, f"has an adhesion energy, which is fitted{without}"),
            (law.plastic, f"is plastic; E* is fitted to an elastic law{without}"),
            (
                isinstance(law, Elastic) and self.surface is None,
                "takes the caps of a surface; give surface, the calibration sample",
            ),
            (
                of_one_modulus,
                "has loads in N for one E*, which must be known: contact.for_material(material)",
            ),
        ):
            refuse_if(holds, f"contact = {shown(law)} {reason}")

    def _refuse_other(self, surface: Surface) -> None:
        """Raise InvalidInput for a surface with another Poisson's ratio or another number of caps."""
        own, ratio = surface.material.poisson_ratio, self.poisson_ratio
        other = f"poisson_ratio = {ratio} differs from that of the surface, {own:g}"
        refuse_if(ratio not in (None, own), other)
        refuse_if(
            isinstance(surface.cap, Caps),
            "must be one cap for all asperities, because one law is fitted to all contacts: fit the contacts "
            "of each cap separately, each with a sample of its own",
            key="surface.cap",
            value=repr(surface.cap),
        )
        refuse_if(
            surface.count != self.contacts,
            f"surface has {surface.count} asperities, but contacts = {self.contacts} share the load; they "
            "must be the same",
        )


def cap_curve(cap: Contact, radius: float) -> AreaCurve:
    """Return the load curve of an isolated contact with a cap of this radius [mm]."""

    deepest = float(cap.largest_indentation(radius))
    widest = MOST_OF_SPHERE * radius if isinstance(cap, SphericalCap) else math.inf
    if math.isfinite(deepest):
        widest = float(cap.contact_radius(deepest, radius))

    def load_and_slope(area: FloatArray) -> tuple[FloatArray, FloatArray]:
        closed = np.clip(np.sqrt(area / math.pi), OPEN * radius, widest)
        load = np.where(area > 0.0, cap.load(closed, radius), 0.0)
        return load, np.asarray(cap.stiffness(closed, radius) / cap.area_slope(closed, radius))

    return AreaCurve(load_and_slope, math.pi * widest**2)


def scaled_cap(cap: Contact, scale: float) -> Contact:
    """Return the contact law of a scaled cap; a law without a table or profile is unchanged."""
    if isinstance(cap, TabulatedContact):
        depth, load, area = cap.table
        return TabulatedContact(scale * depth, scale**2 * load, scale**2 * area, material=cap.material)
    if isinstance(cap, AxisymmetricCap):
        profile = cap.profile
        if callable(profile):
            extent = None if cap.extent is None else scale * cap.extent
            return AxisymmetricCap(lambda rho: scale * profile(rho / scale), extent)
        return AxisymmetricCap(scale * profile)
    return cap


def adhesive_cap(cap: Contact, adhesion_energy: float, modulus: float) -> Contact:
    """Return the contact law of the cap for this E* [MPa], adhesive if w > 0 [N/mm]."""
    if isinstance(cap, TabulatedContact) and cap.material is not None:
        depth, load, area = cap.table
        return TabulatedContact(depth, load * (modulus / cap.material.composite_modulus), area)
    return JKR(adhesion_energy, cap) if adhesion_energy > 0.0 and cap.largest_order > 1 else cap


def sample_curve(surface: Surface, model: Model, area: FloatArray, one_by_one: bool) -> AreaCurve:
    """Return the load curve of a sample with E* = 1, over areas of single contacts (k, n) [mm^2].

    The model is solved at loads that cover more than the range of the areas. A cubic spline interpolates the
    logarithm of the load over the logarithm of the area, separately for each contact if single areas were
    measured.
    """
    single = cap_curve(contact_of(model), float(surface.radius[0]))
    closed = area[area > 0.0]
    ends = np.array([BELOW * closed.min(), min(ABOVE * closed.max(), WITHIN * float(single.largest))])
    low, high = surface.count * single.load_and_slope(ends)[0]
    loads = np.geomspace(low, high, GRID)
    if one_by_one:
        states = [equilibrium(surface, model, load=load) for load in loads.tolist()]
        found = np.array([(state.asperity_area, state.asperity_load) for state in states])
        areas, carried = found.transpose(1, 2, 0)
    else:
        curve = model.curve(surface, loads).checked()
        areas, carried = (each[None] / surface.count for each in (curve.area, curve.load))
    splines = [_logarithmic(*pair, j) for j, pair in enumerate(zip(areas, carried, strict=True))]

    def load_and_slope(of: FloatArray) -> tuple[FloatArray, FloatArray]:
        parts = [spline(of[..., j]) for j, spline in enumerate(splines)]
        load, slope = (np.stack([part[i] for part in parts], axis=-1) for i in (0, 1))
        return load, slope

    return AreaCurve(load_and_slope, single.largest)


def _logarithmic(
    area: FloatArray, load: FloatArray, j: int
) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    """Return a function for load and slope that interpolates a table and extrapolates with power laws."""
    closed = area > 0.0
    refuse_if(
        closed.sum() < FEWEST_STATES,
        f"surface: asperity {j} is in contact in {int(closed.sum())} of {len(area)} states up to the largest "
        "area; its height must be near that of the others",
    )
    x, y = np.log(area[closed]), np.log(load[closed])
    spline = CubicSpline(x, y, bc_type="natural")
    rate = spline.derivative()

    def load_and_slope(of: FloatArray) -> tuple[FloatArray, FloatArray]:
        wanted = np.log(np.where(of > 0.0, of, 1.0))
        inside = np.clip(wanted, x[0], x[-1])
        power = rate(inside)
        found = np.where(of > 0.0, np.exp(spline(inside) + power * (wanted - inside)), 0.0)
        return found, np.divide(power * found, of, np.zeros(of.shape), where=of > 0.0)

    return load_and_slope
