"""What a model leaves out of a surface at given loads: estimates, and the notes that state them.

Every model is compared with asperities that interact by order 3, in A0 at given load, on the bonded layer
where the surface has a block. A uniform sinking leaves A0(P) as it is, and what remains is of either sign:
sums over the neighbours are off by factors of ten where contacts are crowded, and the solution at a few loads
costs less than a design. Against resolved contacts it tells the change within a factor of two even where
contacts overlap or are as wide as a layer; `truncation` estimates its own error. The true block differs from
the layer by less than 0.4 % in A0, and its influence takes a minute, so the layer is used.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_geometry import foot_radius
from metafem.errors import MetafemError, NotConverged
from metafem.models.interacting.model import DENSE_LIMIT, Interacting
from metafem.models.model import ContactState, Curve, Model, Status
from metafem.notes import Note, information
from metafem.substrate import BondedLayer, HalfSpace, Substrate
from metafem.surface import Surface

# Relative error of A0 at given load, rms over the loads, above which a note warns. The source paper's
# surfaces reach 0.4 to 3.3 % by interaction, on any placement of their heights, and it counts them as
# achieved; at 5 % every design must be warned of. The rms over the probed loads differs from that over a
# hundred by less than the fifth between.
BOUND = 0.04

# Smallest error that is stated in a note of information.
TOLD = 0.01

# Loads of a law at which it is estimated, and of scenes beyond the dense solver.
PROBES, FEW_PROBES = 8, 3

# Relative error of A0 by order 3 per sum of (a/r)^5: on a 3 x 3 lattice resolved contacts err by up to 0.20
# of the mean sum (0.066 % at 0.0034, 0.01 % at 0.0006); a quarter more for safety.
PAIRS = 0.25

# The same per (a/t)^5 of a contact on a layer: resolved contacts err by 0.12, 0.5 and 1.5 % at a/t = 0.3, 0.4
# and 0.5 with nu = 0.5 (0.9 % at 0.5 with nu = 0.3).
LAYER = 0.5

# Neighbours whose fields are counted in it; on a lattice those farther away add less than a hundredth.
NEIGHBOURS = 24

# Contact radius over distance of neighbours up to which order 3 was compared with resolved contacts.
COMPARED = 0.32

# Contact radius over radius of curvature up to which Hertz's law with a fitted modulus stays near the soft
# cap at large strain: 2 % in the load at .5, and a tenth of grace. What errs by BOUND in A0 errs by 6 % in
# the load, at 1.3 times that even if the error grows as (a/R)^4.
WIDEST, TOO_WIDE = 0.55, 0.65

# What to do where a model finds no equilibrium.
REMEDY = "use lighter loads, a larger pitch or the model resolved"

UNKNOWN = "what elastic interaction changes cannot be estimated over all loads"

# The base gap at its load of contact, relative to the largest height.
BASE_TOLERANCE = 1e-9

# Steps towards a plane that reaches the base; each at least doubles what the sinking left.
MOST_STEPS = 60


def law_notes(surface: Surface, model: Model, curve: Curve) -> tuple[Note, ...]:
    """Return the notes of a curve, and what the model leaves out along it."""
    return (*curve.notes, *_left_out(surface, model, curve.load, curve.area, None))


def state_notes(surface: Surface, model: Model, state: ContactState) -> tuple[Note, ...]:
    """Return the notes of a state, and what the model leaves out of it."""
    load = np.array([state.load / surface.material.composite_modulus])
    return (*state.notes, *_left_out(surface, model, load, np.array([state.area]), state))


def _left_out(
    surface: Surface, model: Model, load: FloatArray, area: FloatArray, last: ContactState | None
) -> tuple[Note, ...]:
    """Return what is to be said at increasing rescaled loads (k,) with the areas (k,) of the model."""
    try:
        # resolved contacts cost much: order 3 stands for what is asked of one contact
        state = last or model.gradient_model.solve_load(surface, float(load[-1]))
    except MetafemError:  # the same reason is told below
        state = None
    notes = [] if state is None else [*_base_notes(surface, model, state), *_wide_notes(surface, state)]
    return (*notes, *_interaction_notes(surface, model, load, area, state), *_surface_notes(surface))


def reference_of(surface: Surface, model: Model) -> Interacting:
    """Return the model with which a model is compared on a surface, with its block where it has one."""
    reference = model.reference
    if surface.block is not None and isinstance(reference.substrate, HalfSpace):
        return replace(reference, substrate=BondedLayer())
    return reference


def converged(model: Model, curve: Curve) -> Curve:
    """Return the curve if it holds the model's tolerance, or raise NotConverged."""
    worst = float(curve.residual.max())
    if not worst <= max(model.tolerance, curve.tolerance):
        raise NotConverged(f"not converged: largest residual {worst:.2g}", curve)
    return curve


def truncation(surface: Surface, contact_radius: FloatArray, substrate: Substrate) -> float:
    """Return the relative error of A0 by order 3, estimated from the contact radii (n,) [mm].

    The next terms of the neighbours' fields fall as (a/r)^5, and those of a layer's own as (a/t)^5.
    """
    from scipy.spatial import cKDTree

    closed = np.flatnonzero(contact_radius > 0.0)
    if closed.size == 0:
        return 0.0
    radius, curved = contact_radius[closed], surface.radius[closed]
    share = radius**2 / (radius**2).sum()
    bound = substrate.for_surface(surface)
    thickness = bound.thickness if isinstance(bound, BondedLayer) and bound.thickness else math.inf
    error = LAYER * float(share @ (radius / thickness) ** 5)
    if closed.size == 1:
        return error
    place = surface.position[closed]
    if closed.size <= NEIGHBOURS + 1:
        distance = np.hypot(*(place[:, None] - place[None, :]).T)
        np.fill_diagonal(distance, math.inf)
        ratio, relative = radius[None, :] / distance, curved[:, None] / curved[None, :]
    else:
        distance, other = cKDTree(place).query(place, k=NEIGHBOURS + 1)
        ratio, relative = radius[other[:, 1:]] / distance[:, 1:], curved[:, None] / curved[other[:, 1:]]
    # the curvature by a source is p/r^3 = 4 a^3/(3 R r^3); its effect is proportional to R of the contact
    return error + PAIRS * float(share @ (ratio**5 * relative).sum(axis=1))


def _interaction_notes(
    surface: Surface, model: Model, load: FloatArray, area: FloatArray, state: ContactState | None
) -> list[Note]:
    """Say what the neighbours and the block change, and how far order 3 holds."""
    reference, stand_in = reference_of(surface, model), model.gradient_model
    rows = _probed(load, surface.count)
    if not rows.size:
        return []
    probed, held = load[rows], area[rows]
    notes: list[Note] = []
    try:
        if reference != stand_in:
            full = reference.curve(surface, probed)
            solved = full.residual <= max(reference.tolerance, full.tolerance)
            if model.couples:  # what resolved contacts hold beyond order 3 is not of the block
                held = converged(stand_in, stand_in.curve(surface, probed)).area
            if solved.any():
                change = full.area[solved] / held[solved] - 1.0
                notes += _change_notes(surface, model, reference, probed[solved], change)
            if not solved.all():
                newtons = surface.material.composite_modulus * probed[~solved][0]
                raise NotConverged(f"order 3 has no solution at {newtons:.4g} N", full)
    except MetafemError as reason:
        notes.append(Note(f"{UNKNOWN}: {reason}; use the model resolved, or lighter loads"))
    resolved = model != stand_in  # its contacts may merge
    return notes if state is None or resolved else notes + _width_notes(surface, model, reference, state)


def _probed(load: FloatArray, count: int) -> IntArray:
    """Return the rows of a few positive loads, the last among them."""
    rows: IntArray = np.flatnonzero(load > 0.0)
    some = PROBES if count <= DENSE_LIMIT else FEW_PROBES
    if rows.size <= some:
        return rows
    ends: IntArray = np.rint(np.arange(1, some + 1) * rows.size / some).astype(np.int64) - 1
    return rows[ends]


def _change_notes(
    surface: Surface, model: Model, reference: Interacting, load: FloatArray, change: FloatArray
) -> list[Note]:
    """Say how much A0 at given load changes by what the model leaves out."""
    rms = math.sqrt(float((change**2).mean()))
    if rms < TOLD:
        return []
    most = int(np.abs(change).argmax())
    layer = isinstance(reference.substrate, BondedLayer)
    if not model.couples:
        cause = "the elastic interaction of the asperities, which this model leaves out,"
    elif model.reference == reference:
        cause = "the size of the contacts, which point loads leave out,"
    else:
        cause = "the block's thickness, which a half-space leaves out,"
    spread = f"by {100.0 * rms:.2g} % rms and " if load.size > 1 else ""
    text = (
        f"{cause} changes A0 at a given load {spread}by up to {100.0 * change[most]:+.2g} %, at "
        f"{surface.material.composite_modulus * load[most]:.4g} N (order 3 on the "
        f"{'bonded layer' if layer else 'half-space'})"
    )
    if rms <= BOUND:
        return [information(text)]
    return [Note(f"{text}; use the model {'layer' if layer else 'half-space'}, or a larger pitch")]


def _width_notes(surface: Surface, model: Model, reference: Interacting, state: ContactState) -> list[Note]:
    """Say where contacts overlap, or are too wide beside their neighbours and their layer."""
    radius = np.sqrt(state.asperity_area / math.pi)
    overlaps, ratio = _neighbours(surface, radius)
    if overlaps:
        return [
            Note(
                f"contacts overlap: {overlaps} {'pair reaches' if overlaps == 1 else 'pairs reach'} into "
                f"each other at {state.load:.4g} N, where real contacts merge; use the model resolved, a "
                "larger pitch or lighter loads"
            )
        ]
    notes = []
    if ratio > COMPARED and model.couples:
        notes.append(
            information(
                f"a/r = {ratio:.2f} exceeds {COMPARED}, up to which order 3 was compared with resolved "
                "contacts"
            )
        )
    error = truncation(surface, radius, reference.substrate)
    if error > BOUND:
        notes.append(
            Note(
                f"the contacts are too wide for their distances or their layer: order 3 may err by "
                f"{100.0 * error:.2g} % in A0 at {state.load:.4g} N; use the model resolved"
            )
        )
    return notes


def _neighbours(surface: Surface, contact_radius: FloatArray) -> tuple[int, float]:
    """Return how many pairs of contacts overlap, and the largest contact radius over their distance."""
    from scipy.spatial import cKDTree

    closed = np.flatnonzero(contact_radius > 0.0)
    if closed.size < 2:
        return 0, 0.0
    a = contact_radius[closed]
    # the field of j bends i by p_j R_i/r^3, (a_j/r)^3 R_i/R_j: a sharp summit counts as a wider one
    blunt = np.cbrt(surface.radius[closed])
    sharp = a / blunt
    # pairs beyond this cannot overlap, nor leave the range
    reach = float((sharp * blunt.max()).max()) * max(2.0, 1.0 / COMPARED)
    tree = cKDTree(surface.position[closed])
    i, j = tree.query_pairs(reach, output_type="ndarray").T
    if not i.size:
        return 0, 0.0
    r = np.hypot(*(tree.data[i] - tree.data[j]).T)
    bending = np.maximum(sharp[j] * blunt[i], sharp[i] * blunt[j])
    return int((a[i] + a[j] > r).sum()), float((np.maximum(np.maximum(a[i], a[j]), bending) / r).max())


def base_contact_load(surface: Surface, model: Model) -> float:
    """Return the rescaled load [mm^2] at which the plane reaches the sunken base beside a summit.

    The base gap of `ContactState` falls through zero there. Order 3 stands for resolved contacts.

    Raises
    ------
    NotConverged, InvalidInput
        Where the model has no solution under such a load.
    """
    from scipy.optimize import brentq

    top = float(surface.height.max())
    if top <= 0.0:
        return 0.0

    def state_at(approach: float) -> ContactState:
        state = model.gradient_model.solve(surface, approach)
        if state.status is not Status.CONVERGED:
            raise NotConverged(f"{state.status.value}: residual {state.residual:.2g}", state)
        return state

    # independent asperities reach it here; common sinking puts it off, and a layer's rise may hasten it
    high, gap = top, state_at(top).base_gap
    for _ in range(MOST_STEPS):
        if gap <= BASE_TOLERANCE * top:
            break
        high += max(2.0 * gap, high - top)  # where nearly all of a step goes into sinking, steps double
        gap = state_at(high).base_gap
    if abs(gap) > BASE_TOLERANCE * top:
        high = brentq(lambda x: state_at(x).base_gap, 0.0, high, xtol=BASE_TOLERANCE * top)
    return state_at(high).load / surface.material.composite_modulus


def _base_notes(surface: Surface, model: Model, state: ContactState) -> list[Note]:
    """Say from which load on the plane would reach the base plane."""
    if state.base_gap > 0.0:
        return []
    try:
        onset = min(surface.material.composite_modulus * base_contact_load(surface, model), state.load)
    except MetafemError:  # no solution on the way to the base: this load is known to be beyond it
        onset = state.load
    return [
        Note(
            f"the base plane would touch from a load of {onset:.4g} N on: at {state.load:.4g} N the plane "
            f"would be {-1e3 * state.base_gap:.3g} um below the base beside a summit; the load that the base "
            "would carry is not counted"
        )
    ]


def _wide_notes(surface: Surface, state: ContactState) -> list[Note]:
    """Say where contacts are wider than any model of small strain holds for."""
    ratio = float((np.sqrt(state.asperity_area / math.pi) / surface.radius).max())
    if ratio <= WIDEST:
        return []
    text = (
        f"the widest contact has a/R = {ratio:.2f} at {state.load:.4g} N: Hertz's law "
        f"holds up to about {WIDEST:g}, with a fitted modulus"
    )
    return [Note(text) if ratio > TOO_WIDE else information(text)]


def _surface_notes(surface: Surface) -> list[Note]:
    """Say where no such part can be made."""
    notes = []
    high = int((surface.height > surface.radius).sum())
    if high:
        notes.append(
            Note(
                f"{high} of {surface.count} summits stand higher than their radius and cannot be made as "
                f"caps: lower them to {float(surface.radius.min()):g} mm, or use larger radii"
            )
        )
    buried = _overlapping_caps(surface)
    if buried:
        notes.append(
            Note(
                f"the caps of {buried} {'pair' if buried == 1 else 'pairs'} of summits overlap on the base "
                "plane and cannot be made as separate caps: increase the pitch, or lower the summits"
            )
        )
    block = surface.block
    if block is not None:
        outside = np.abs(surface.position) > 0.5 * np.array([block.width, block.length])
        count = int(outside.any(axis=1).sum())
        if count:
            notes.append(
                Note(
                    f"{count} of {surface.count} summits stand outside the block of {block.width:g} by "
                    f"{block.length:g} mm, whose centre is at (0, 0): make it larger, or move them"
                )
            )
    return notes


def _overlapping_caps(surface: Surface) -> int:
    """Return how many pairs of spherical caps overlap."""
    from scipy.spatial import cKDTree

    height = np.clip(surface.height, 0.0, surface.radius)
    foot = foot_radius(height, surface.radius)
    pairs = cKDTree(surface.position).query_pairs(2.0 * float(foot.max()), output_type="ndarray")
    distance = np.hypot(*(surface.position[pairs[:, 0]] - surface.position[pairs[:, 1]]).T)
    return int((distance < foot[pairs].sum(axis=1)).sum())
