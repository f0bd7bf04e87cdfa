"""Load over area of the contacts of a calibration sample, for unit E* and without adhesion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from metafem import _validate as check
from metafem._given import formatted, shown
from metafem._validate import FloatArray
from metafem.contact import JKR, AxisymmetricCap, Contact, SphericalCap, TabulatedContact
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.models import Independent, Model
from metafem.models.model import checked_contact, checked_model, with_contact
from metafem.prediction import equilibrium
from metafem.surface import Surface

# Contact radius over R of which the slope is that of an open contact.
OPEN = 1e-6

# Largest contact radius over R of a sphere, whose load is infinite at 1.
MOST_OF_SPHERE = 0.999

# Relative difference of two radii that are the same.
SAME = 1e-9

# States of a sample: their areas over the smallest and the largest measured one, over the largest of the law,
# their number, and the fewest in which a contact must be closed.
BELOW, ABOVE, WITHIN, GRID, FEWEST_STATES = 0.5, 1.5, 0.97, 60, 8


@dataclass(frozen=True, eq=False)
class AreaCurve:
    """Rescaled load over contact area.

    Attributes
    ----------
    load_and_slope : callable
        Returns P/E* [mm^2] and its derivative by the area [-] of contacts of areas (..., n) [mm^2].
    largest : float or ndarray, (n,)
        Largest areas that the law describes [mm^2]; infinite where there is none.
    """

    load_and_slope: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    largest: float | FloatArray


def checked_cap(contact: Contact) -> Contact:
    """Return a law whose load is proportional to E* at a given area, or raise InvalidInput."""
    contact = checked_contact(contact)
    if contact.adhesive:
        raise InvalidInput(
            f"contact = {shown(contact)} has an adhesion energy, which is fitted; give its cap, such as "
            "metafem.Hertz()"
        )
    if contact.plastic:
        raise InvalidInput(
            f"contact = {shown(contact)} is plastic; E* is fitted to an elastic law, such as metafem.Hertz()"
        )
    if contact.individual:
        raise InvalidInput(f"contact = {shown(contact)} must be one law for all contacts")
    if isinstance(contact, TabulatedContact) and contact.material is None:
        raise InvalidInput(
            f"contact = {shown(contact)} has loads in N for one E*, which must be known: "
            "contact.for_material(metafem.Material(composite_modulus))"
        )
    return contact


def cap_curve(cap: Contact, radius: float) -> AreaCurve:
    """Return the curve of a contact of its own, of a radius [mm]."""

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
    """Return the law of caps all of whose lengths are larger by a factor, where R alone does not tell it."""
    if isinstance(cap, TabulatedContact):
        return TabulatedContact(
            *(cap.table.T * np.array([scale, scale**2, scale**2])).T, material=cap.material
        )
    if isinstance(cap, AxisymmetricCap):
        profile = cap.profile
        if callable(profile):
            extent = None if cap.extent is None else scale * cap.extent
            return AxisymmetricCap(lambda rho: scale * profile(rho / scale), extent)
        return AxisymmetricCap(scale * profile)
    return cap


def adhesive_cap(cap: Contact, adhesion_energy: float, modulus: float) -> Contact:
    """Return the law of the contacts: the cap, adhesive if w > 0 [N/mm]; a table has the loads of this E*."""
    if isinstance(cap, TabulatedContact) and cap.material is not None:
        depth, load, area = cap.table
        return TabulatedContact(depth, load * (modulus / cap.material.composite_modulus), area)
    return JKR(adhesion_energy, cap) if adhesion_energy > 0.0 and cap.largest_order > 1 else cap


def checked_sample(
    surface: Surface | None, model: Model | None, radius: float, contacts: int, poisson_ratio: float | None
) -> tuple[Surface | None, float]:
    """Return the sample with E* = 1, and Poisson's ratio."""
    ratio = None if poisson_ratio is None else check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    if surface is None:
        if model is not None:
            raise InvalidInput(
                "model needs surface, the calibration sample: its caps with their positions, and its block"
            )
        return None, 0.5 if ratio is None else ratio
    check.instance("surface", surface, Surface, "a metafem.Surface")
    own = surface.material.poisson_ratio
    if ratio is not None and ratio != own:
        raise InvalidInput(f"poisson_ratio = {ratio:g} differs from that of the surface, {own:g}")
    if surface.count != contacts:
        raise InvalidInput(
            f"surface has {surface.count} asperities, but contacts = {contacts} share the load; they must be "
            "the same"
        )
    other = np.flatnonzero(np.abs(surface.radius / radius - 1.0) > SAME)
    if other.size:
        i = int(other[0])
        raise InvalidInput(
            f"surface.radius[{i}] = {formatted('radius', surface.radius[i])} differs from "
            f"radius = {formatted('radius', radius)}; they must be the same"
        )
    return replace(surface, material=Material(1.0, own)), own


def sample_curve(
    surface: Surface, model: Model | None, cap: Contact, area: FloatArray, one_by_one: bool
) -> AreaCurve:
    """Return the curve of a sample with E* = 1 under a model, for areas (k, n) [mm^2] of single contacts.

    The sample is solved at loads that reach beyond the areas, and the logarithm of load over area is
    interpolated by a cubic spline, for each contact where areas are measured one by one.
    """
    solver = with_contact(Independent(cap) if model is None else checked_model(model), cap)
    alone = cap_curve(cap, float(surface.radius[0]))
    closed = area[area > 0.0]
    ends = np.array([BELOW * closed.min(), min(ABOVE * closed.max(), WITHIN * float(alone.largest))])
    low, high = surface.count * alone.load_and_slope(ends)[0]
    loads = np.geomspace(low, high, GRID)
    if one_by_one:
        states = [equilibrium(surface, solver, load=load) for load in loads.tolist()]
        pairs = [
            (np.array([s.asperity_area[j] for s in states]), np.array([s.asperity_load[j] for s in states]))
            for j in range(surface.count)
        ]
    else:
        curve = solver.curve(surface, loads).checked()
        pairs = [(curve.area / surface.count, curve.load / surface.count)]
    splines = [_logarithmic(*pair, f"asperity {j}") for j, pair in enumerate(pairs)]

    def load_and_slope(of: FloatArray) -> tuple[FloatArray, FloatArray]:
        parts = [spline(of[..., j]) for j, spline in enumerate(splines)]
        load, slope = (np.stack([part[i] for part in parts], axis=-1) for i in (0, 1))
        return load, slope

    return AreaCurve(load_and_slope, alone.largest)


def _logarithmic(
    area: FloatArray, load: FloatArray, name: str
) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    """Return load and slope over area from a table, as powers beyond its ends."""
    from scipy.interpolate import CubicSpline

    closed = area > 0.0
    if closed.sum() < FEWEST_STATES:
        raise InvalidInput(
            f"surface: {name} is in contact in {int(closed.sum())} of {len(area)} states up to the largest "
            "area; its height must be near that of the others"
        )
    x, y = np.log(area[closed]), np.log(load[closed])
    spline = CubicSpline(x, y, bc_type="natural")
    rate = spline.derivative()

    def load_and_slope(of: FloatArray) -> tuple[FloatArray, FloatArray]:
        given = np.log(np.where(of > 0.0, of, 1.0))
        inside = np.clip(given, x[0], x[-1])
        power = rate(inside)
        found = np.where(of > 0.0, np.exp(spline(inside) + power * (given - inside)), 0.0)
        return found, np.divide(power * found, of, np.zeros(of.shape), where=of > 0.0)

    return load_and_slope
