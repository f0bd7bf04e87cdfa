"""Asperities whose contacts are close to each other, on lattices and at irregular distances."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

import metafem as mf

# Radius of the caps and pitch of the lattice of the paper [mm].
RADIUS, PITCH = 0.526, 1.5

# Nine crowded contacts: largest radius over the pitch and over R, at the ends of the documented ranges, where
# the caps overlap on the base. The approach is that at which order 3 has this radius.
CROWDED, WIDTH = 0.319, 0.5

# Steps to equal contacts.
STEPS = 12


@dataclass(frozen=True)
class Scene:
    """Asperities with a cap on a substrate, at an approach [mm]."""

    surface: mf.Surface
    approach: float
    contact: mf.Contact = field(default_factory=mf.Hertz)
    substrate: mf.HalfSpace | mf.BondedLayer = field(default_factory=mf.HalfSpace)

    def state(self, model: mf.Model, load: float | None = None) -> mf.ContactState:
        """Return the equilibrium at the scene's approach, or at a load."""
        given = {"approach": self.approach} if load is None else {"load": load}
        return mf.equilibrium(self.surface, model, **given)

    def expansion(self, order: int) -> mf.Interacting:
        """Return the model of an order."""
        return mf.Interacting(order, self.substrate, self.contact)


def lattice(approach: float, pitch: float = PITCH, **options) -> Scene:
    """Return nine equal asperities on a lattice, by default the paper's."""
    part = {"radius": RADIUS, "material": mf.Material(1.0), "block": mf.Block(20.0, 20.0, 7.2)}
    return Scene(mf.Surface.square_lattice(0.2, (3, 3), pitch, **part), approach, **options)


def irregular() -> Scene:
    """Return six unequal asperities at irregular distances."""
    position = [[0.0, 0.0], [0.9, 0.1], [0.3, 1.0], [-0.8, 0.5], [1.4, 1.2], [-0.3, -1.1]]
    height = [0.20, 0.17, 0.19, 0.16, 0.20, 0.18]
    radius = [0.526, 0.4, 0.6, 0.526, 0.45, 0.526]
    return Scene(mf.Surface(position, height, radius, mf.Material(1.0)), 0.1)


def crowded(law: mf.Contact) -> Scene:
    """Return nine equal asperities of a law at the approach of the crowded contacts."""

    def at(approach: float) -> Scene:
        return lattice(approach, WIDTH * RADIUS / CROWDED, contact=law)

    def beyond(approach: float) -> float:
        state = at(approach).state(at(approach).expansion(3))
        return float(np.sqrt(state.asperity_area.max() / np.pi)) - WIDTH * RADIUS

    return at(brentq(beyond, 0.01, 0.3, xtol=1e-9))


def unit_lattice(height: ArrayLike, side: int, radius: float) -> mf.Surface:
    """Return asperities on a lattice of pitch 1."""
    return mf.Surface.square_lattice(height, (side, side), 1.0, radius=radius, material=mf.Material(1.0))


def equal_contacts(side: int, radius: float) -> tuple[mf.Surface, float]:
    """Return a crowded lattice of pitch 1 with heights that make all contacts equal, and their load.

    The sum over the neighbours is largest there.
    """
    surface = unit_lattice(2.0 * radius, side, radius)
    load = surface.count * 4.0 / 3.0 * CROWDED**3 / radius
    for _ in range(STEPS):
        square = mf.equilibrium(surface, mf.Interacting(), load=load).asperity_area / math.pi
        surface = surface.replaced(height=surface.height + (CROWDED**2 - square) / radius)
    return surface, load
