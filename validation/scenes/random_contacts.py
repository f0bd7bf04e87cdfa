"""Random surfaces, contact laws, models and loads.

A scene depends on its seed alone: 2 to 64 asperities, on a lattice or scattered, of one or several radii; one
of nine kinds of law with random parameters; independent asperities, the mean field, or order 1 or 3 on the
half-space or on a bonded layer. Its loads end where the largest contact without interaction has a given part
of the documented range: a/R = 0.5, contacts with a/L = 0.3 and as wide as 0.3 of the thickness of a layer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import metafem as mf
from metafem.contact import Contact
from metafem.models import Model

MATERIAL = mf.Material(1.36)
RANGE = 0.5, 0.3, 0.3  # a/R, a/L, a/t

# Contact radius over R that a sphere can have.
LESS_THAN_A_SPHERE = 0.95

# Loads of a curve.
LOADS = 12


@dataclass(frozen=True)
class Scene:
    """A surface, a model with its contact law, and increasing loads [N]."""

    surface: mf.Surface
    model: Model
    law: Contact
    load: np.ndarray


def random_scene(seed: int, inside: bool = True) -> Scene:
    """Return a scene whose loads end inside the documented range, or at up to twice its end."""
    rng = np.random.default_rng(seed)
    side = int(rng.integers(2, 9))
    count = side**2 if rng.random() < 0.5 else int(rng.integers(2, 65))
    if count == side**2:
        pitch = rng.uniform(0.6, 2.0)
        grid = pitch * np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
        position = np.asarray(grid, dtype=np.float64)
    else:
        position = _scattered(rng, count, rng.uniform(0.4, 1.0))
    radius = rng.choice([0.3, 0.526, 0.8], count) if rng.random() < 0.3 else np.full(count, 0.526)
    depth = rng.exponential(rng.uniform(0.002, 0.05), count)
    height = 0.2 - np.minimum(depth - depth.min(), 0.19)
    thickness = rng.uniform(1.0, 8.0)
    surface = mf.Surface(position, height, radius, MATERIAL, block=mf.Block(40.0, 40.0, thickness))
    apart = np.linalg.norm(position[:, None] - position, axis=-1)[np.triu_indices(count, 1)].min()
    law = _law(rng)
    substrate = mf.HalfSpace() if rng.random() < 0.5 else mf.BondedLayer()
    kind = int(rng.integers(0, 5))
    models: list[Model] = [
        mf.Independent(law),
        mf.MeanField(contact=law),
        *(mf.Interacting(min(order, law.largest_order), substrate, law) for order in (1, 3, 3)),
    ]
    limits = RANGE[0] * float(radius.min()), RANGE[1] * float(apart), RANGE[2] * thickness
    part = rng.uniform(0.1, 0.9) if inside else rng.uniform(1.0, 2.0)
    widest = min(part * min(limits), LESS_THAN_A_SPHERE * float(radius.min()))
    return Scene(surface, models[kind], law, _loads(surface, law, widest))


def _scattered(rng: np.random.Generator, count: int, closest: float) -> np.ndarray:
    """Return random sites at least `closest` apart."""
    width = 1.6 * closest * np.sqrt(count)
    position = rng.uniform(0.0, width, (1, 2))
    while len(position) < count:
        site = rng.uniform(0.0, width, 2)
        if np.hypot(*(position - site).T).min() >= closest:
            position = np.vstack([position, site])
        else:
            width *= 1.01
    return position


def _law(rng: np.random.Generator) -> Contact:
    """Return a random law."""
    cap: Contact = (mf.Hertz(), mf.SphericalCap(), mf.PowerCap(rng.uniform(1.5, 4.0)))[int(rng.integers(3))]
    d = np.linspace(0.005, 3.0, 60)
    laws: list[Contact] = [
        mf.Hertz(),
        mf.SphericalCap(),
        mf.PowerCap(rng.uniform(1.0, 8.0), rng.uniform(0.3, 1.0)),
        mf.AxisymmetricCap(_Profile(*rng.uniform(0.8, 1.5, 2)), 1.2),
        mf.JKR(float(np.exp(rng.uniform(np.log(1e-6), np.log(3e-5)))), cap),
        mf.JKR(float(np.exp(rng.uniform(np.log(1e-6), np.log(3e-5))))),
        mf.KogutEtsion(float(np.exp(rng.uniform(np.log(1.0), np.log(100.0))))),
        mf.JacksonGreen(float(np.exp(rng.uniform(np.log(0.5), np.log(50.0))))),
        mf.TabulatedContact(
            d, MATERIAL.composite_modulus * d ** rng.uniform(1.2, 1.6), d ** rng.uniform(0.8, 1.2)
        ),
    ]
    return laws[int(rng.integers(len(laws)))]


class _Profile:
    """rho^2/(2 b R) + c rho^4 [mm]."""

    def __init__(self, b: float, c: float) -> None:
        self.b, self.c = b, c

    def __call__(self, rho: np.ndarray) -> np.ndarray:
        return np.asarray(rho**2 / (1.05 * self.b) + self.c * rho**4)


def _loads(surface: mf.Surface, law: Contact, widest: float) -> np.ndarray:
    """Return loads [N] up to that at which the tallest of independent contacts has a radius [mm]."""
    used = law.for_material(surface.material)
    top = int(surface.height.argmax())
    approach = float(used.indentation(widest, surface.radius[top]))
    z = np.maximum(approach - surface.gap, 0.0)
    plain = used.without_adhesion
    load = float(plain.load(plain.contact_radius(z, surface.radius), surface.radius).sum())
    return surface.material.composite_modulus * load * np.geomspace(1e-3, 1.0, LOADS)
