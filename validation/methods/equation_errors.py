"""The equations of asperity models in plain numpy, evaluated at the solution that a model returns.

A contact of radius a under the load p has to obey ``d(a, k) + u = approach - gap`` and ``p = P(a, k)`` of its
law, where displacement u and curvature k are those by the other contacts, and an open asperity must not
overlap: ``approach - gap - u <= 0``. Loads are P/E* [mm²]. Contact laws, influences and pedestals are those
of metafem, so that this is a test of self-consistency.
"""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem.contact import Contact
from metafem.contact.cap_compliance import pedestal_influence
from metafem.models import Curve, Model
from validation.methods.square_mean import mean_influence

# Newton's steps to a contact radius, to rounding.
MOST_STEPS = 20


def equation_error(surface: mf.Surface, model: Model, curve: Curve) -> float | None:
    """Return the largest error of the equations at the last load of a curve.

    Errors of loads are relative to the sum of all loads, with adhesion to that of the contact radii times the
    indentations of the caps; those of lengths to the largest indentation. None for resolved contacts, whose
    equations are those of the cells, and for order 3 of caps that are flat at their summits, for which
    `Interacting` limits the tilt.
    """
    if not isinstance(model, mf.Independent | mf.MeanField | mf.Interacting):
        return None
    law = model.contact.for_material(surface.material)
    if _flat_summit(law) and isinstance(model, mf.Interacting) and model.order == 3:
        return None
    third = isinstance(model, mf.Interacting) and model.order == 3
    p, a = curve.last.load, np.sqrt(curve.last.area / math.pi)
    if not a.any():
        return 0.0
    displacement, curvature = (_third if third else _first)(surface, model, law, p, a)
    free = float(curve.approach[-1]) - surface.gap - displacement
    closed, total = a > 0.0, np.abs(p).sum()
    errors = [p.sum() - curve.load[-1]]
    if third or law.adhesive:
        errors += list((law.load(a, surface.radius, curvature) - p)[closed])
        cap = law.without_adhesion.indentation(a, surface.radius, curvature)
        depth = law.indentation(a, surface.radius, curvature)
        total = (a * cap)[closed].sum() if law.adhesive else total
        lengths = np.where(closed, depth - free, np.maximum(free, 0.0)) / cap.max()
    else:  # also for laws whose contact radius is not that of their area
        errors += list(law.load(law.contact_radius(free, surface.radius), surface.radius) - p)
        lengths = np.zeros(1)
    return float(max(np.abs(errors).max() / total, np.abs(lengths).max()))


def _first(surface: mf.Surface, model: Model, law: Contact, p: np.ndarray, a: np.ndarray) -> tuple:
    """Return displacement [mm] and curvature [1/mm] by point loads, or by the mean pressure."""
    none = np.zeros(surface.count)
    if isinstance(model, mf.MeanField):
        return mean_influence() / math.sqrt(_nominal_area(surface.position)) * p.sum() + none, none
    if isinstance(model, mf.Interacting):
        return _influence(surface, model) @ p, none
    return none, none


def _nominal_area(position: np.ndarray) -> float:
    """Return the area A [mm²] with ``A² = (12 l1 + A/n)(12 l2 + A/n)``, l the second moments of the sites."""
    n, moments = len(position), 12.0 * np.linalg.eigvalsh(np.cov(position.T, bias=True))
    return (
        float(np.roots([1.0 - 1.0 / n**2, -moments.sum() / n, -moments.prod()]).max()) if n > 1 else math.inf
    )


def _third(surface: mf.Surface, model: Model, law: Contact, p: np.ndarray, a: np.ndarray) -> tuple:
    """Return displacement [mm] and curvature [1/mm] by contacts of finite size on each other's slopes."""
    bound = model.substrate.for_surface(surface)
    slope_x, slope_y, laplacian = bound.influence_derivatives(surface)
    along_x, along_y, k = slope_x @ p, slope_y @ p, 0.5 * laplacian @ p
    closed, radius = a > 0.0, surface.radius
    moment = np.where(closed, law.second_moment(a, radius, k), 0.0)
    tilt, turn = np.zeros((2, len(a)))
    tilt[closed], turn[closed] = _tilt(law, a[closed], radius[closed], k[closed])
    u = _influence(surface, model) @ p + 0.25 * laplacian.T @ moment
    u -= slope_x.T @ (tilt * along_x) + slope_y.T @ (tilt * along_y)
    return u - 0.5 * turn * (along_x**2 + along_y**2), k


def _tilt(law: Contact, a: np.ndarray, radius: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the moment of a tilted contact over the slope [mm³], and its derivative by the load [mm]."""
    cap = law.without_adhesion
    carried, own = cap.load(a, radius, k), a
    for _ in range(MOST_STEPS):  # the radius at the same load of the cap without curvature
        rate = 4.0 * math.pi * own**2 / cap.area_slope(own, radius)
        own = own - (cap.load(own, radius) - carried) / rate
    turn = cap.area_slope(own, radius) / math.pi
    return 4.0 / 3.0 * own**3 - turn * (carried - law.load(a, radius, k)), turn


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
