"""The equations of asperity models in plain numpy, evaluated at the solution that a model returns.

A contact of radius a under the load p has to obey ``d(a, k) + u = approach - gap`` and ``p = P(a, k)`` of its
law, where displacement u and curvature k are those by the other contacts, and an open asperity must not
overlap: ``approach - gap - u <= 0``. With order 3 the slopes of the displacements change the areas. Loads are
P/E* [mm²]. Contact laws, influences and pedestals are those of metafem, so that this is a test of
self-consistency.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem.contact import Contact
from metafem.contact.pedestal import pedestal_influence
from metafem.models import Curve, Model
from validation.methods.bent import Bent

# Newton's steps to a contact radius, to rounding.
MOST_STEPS = 20

# Relative step of the differences of fourth order. Up to a/R = 0.998 of a sphere rounding and truncation are
# about 1e-11.
STEP = 2e-5


def equation_error(surface: mf.Surface, model: Model, curve: Curve) -> float:
    """Return the largest error of the equations at the last load of a curve.

    Errors of loads are relative to the sum of all loads, with adhesion to that of the contact radii times
    the indentations of the caps; those of lengths to the largest indentation. It is nan for resolved
    contacts, as their equations are those of the cells, and for order 3 of caps that are flat at their
    summits, for which `Interacting` limits the tilt.
    """
    if not isinstance(model, mf.Independent | mf.Interacting):
        return math.nan
    law = model.contact.bound(surface)
    if _flat_summit(law) and isinstance(model, mf.Interacting) and model.order == 3:
        return math.nan
    third = isinstance(model, mf.Interacting) and model.order == 3
    p, a = curve.last.load, np.sqrt(curve.last.area / math.pi)
    if not a.any():
        return 0.0
    contact = _third(surface, model, law, p, a) if third else _first(surface, model, law, p, a)
    free = float(curve.approach[-1]) - surface.gap - contact.displacement
    closed, total = a > 0.0, np.abs(p).sum()
    errors = [p.sum() - curve.load[-1]]
    if third or law.adhesive:
        errors += list((contact.load - p)[closed])
        total = (a * contact.cap)[closed].sum() if law.adhesive else total
        lengths = np.where(closed, contact.cap - contact.deficit - free, np.maximum(free, 0.0))
        # of an elastic contact the radius follows from the load, and the area has to be that of this radius
        wider = np.sqrt(contact.area / math.pi) - a
        lengths = np.append(lengths / contact.cap.max(), wider / a.max())
    else:  # also for laws whose contact radius is not that of their area
        errors += list(law.load(law.contact_radius(free, surface.radius), surface.radius) - p)
        lengths = np.zeros(1)
    return float(max(np.abs(errors).max() / total, np.abs(lengths).max()))


class _Contact(NamedTuple):
    """Contacts under the loads of a solution, (n,)."""

    displacement: np.ndarray  # by the other contacts [mm]
    load: np.ndarray  # of the law [mm²]
    cap: np.ndarray  # indentation of the cap [mm]
    deficit: np.ndarray  # decrease of the indentation by adhesion [mm]
    area: np.ndarray  # [mm²]


def _first(surface: mf.Surface, model: Model, law: Contact, p: np.ndarray, a: np.ndarray) -> _Contact:
    """Return contacts displaced by point loads."""
    u = np.zeros(surface.count)
    if isinstance(model, mf.Interacting):
        u += _influence(surface, model) @ p
    if not law.adhesive:
        return _Contact(u, p, u, u, math.pi * a**2)
    cap = law.without_adhesion.indentation(a, surface.radius)
    load, depth = law.load(a, surface.radius), law.indentation(a, surface.radius)
    return _Contact(u, load, cap, cap - depth, math.pi * a**2)


def _third(surface: mf.Surface, model: Model, law: Contact, p: np.ndarray, a: np.ndarray) -> _Contact:
    """Return contacts of finite size on each other's slopes."""
    bound, radius = model.substrate.for_surface(surface), surface.radius
    slope_x, slope_y, laplacian = bound.influence_derivatives(surface)
    along_x, along_y, k = slope_x @ p, slope_y @ p, 0.5 * laplacian @ p
    closed, square = a > 0.0, along_x**2 + along_y**2
    wide, k = np.where(closed, a, 0.1 * radius), np.where(closed, k, 0.0)  # open contacts are masked below
    bent = Bent(law, k)
    wide = _radius_at(bent, np.where(closed, p, bent.load(wide, radius)), wide, radius)
    carried = bent.load(wide, radius)
    own = _radius_at(law, carried, wide, radius)
    turn = law.area_slope(own, radius) / math.pi
    slope, bend = _profile(bent, wide, radius)
    moment = bent.second_moment(wide, radius)
    tilt = np.where(closed, 4.0 / 3.0 * own**3, 0.0)
    u = _influence(surface, model) @ p + 0.25 * laplacian.T @ np.where(closed, moment, 0.0)
    u -= slope_x.T @ (tilt * along_x) + slope_y.T @ (tilt * along_y) + 0.5 * closed * turn * square
    area = math.pi * np.where(closed, wide, 0.0) ** 2
    y = (bend - 1.0) * square / slope**2
    area *= np.where(y > 0.0, 1.0 / np.sqrt(1.0 + 4.0 * np.maximum(y, 0.0)), 1.0 - 2.0 * y)
    depth = np.where(closed, bent.indentation(wide, radius), 0.0)
    return _Contact(u, carried, depth, np.zeros(len(a)), area)


def _radius_at(cap: Contact | Bent, p: np.ndarray, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Return the contact radius [mm] at which a cap without adhesion has a load; a: initial guess."""
    for _ in range(MOST_STEPS):
        rate = 4.0 * math.pi * a**2 / cap.area_slope(a, radius)
        a = a - (cap.load(a, radius) - p) / rate
    return a


def _profile(cap: Bent, a: np.ndarray, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the slope D' of the indentation over the contact radius, and a D''/D'."""
    slope = cap.profile_slope(a, radius)
    return slope, _relative_rate(lambda t: cap.profile_slope(a * t, radius)) / slope


def _relative_rate(value: Callable[[float], np.ndarray]) -> np.ndarray:
    """Return the derivative at 1 of a function of a factor, by differences of fourth order."""
    near, far = (value(1.0 + step) - value(1.0 - step) for step in (STEP, 2.0 * STEP))
    return (8.0 * near - far) / (12.0 * STEP)


def _flat_summit(law: Contact) -> bool:
    """Whether the curvature of a cap without adhesion vanishes at its summit."""
    return law.power is not None and law.power > 2.0


def _influence(surface: mf.Surface, model: mf.Interacting) -> np.ndarray:
    """Return the influence matrix [1/mm] with the compliance of the caps on its diagonal."""
    matrix = np.array(model.substrate.for_surface(surface).influence_matrix(surface))
    if model.pedestal:
        own, _ = pedestal_influence(surface.height, surface.radius)
        matrix[np.diag_indices(surface.count)] += own
    return matrix
