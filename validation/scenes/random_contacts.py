"""Random surfaces, contact laws, models and loads.

A scene depends on its seed alone: 1 to 64 asperities, on a lattice or scattered, of one or several radii, in
one in ten scenes with lengths and moduli in other units; one of nine kinds of law with random parameters; one
of nine kinds of model, or a design. Its loads end where the widest contact without interaction has a given
part of the documented range: a/R = 0.5, a/r = 0.32 with the nearest neighbour, and a/t = 0.3 on a layer.
Curves are those at loads or approaches. One kind of scene is a design whose target is the law of a random
surface.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.contact import Contact
from metafem.models import Model
from metafem.models.boundary_elements.model import resolvable

MODULUS = 1.36

# Ends of the documented ranges: a/R of README and `Hertz`, a/r of README and `Interacting`, and a/t, up to
# which the error of order 3 on a layer is 0.2 % (`metafem.models.error`).
WIDTH, CROWDING, LAYER = 0.5, 0.32, 0.3

# Contact radius over R that a sphere can have.
LESS_THAN_A_SPHERE = 0.95

# Tallest height over the radius for which the compliance of caps is tabulated (`Interacting`), with a margin.
TALLEST = 0.55

# Least indentation of adhesive contacts at the largest load, over that without adhesion at the same radius.
LEAST_DEPTH = 0.1

# Part of the scenes whose lengths and moduli are multiplied by up to a million, or divided by it.
OTHER_UNITS = 0.1

# Part of the scenes at given approaches in place of loads.
BY_APPROACH = 0.2

# Loads of a curve, and of one whose contacts may be resolved.
LOADS, FEW_LOADS = 4, 2

# Largest numbers of asperities: in general, with adhesion, where contacts may be resolved, of designs; and
# the part of the scenes with adhesion that have as many as others. Their time grows with the number cubed.
MOST, ADHESIVE, FEW, DESIGNED = 64, 9, 6, 16
CROWDED = 0.02

# Poisson's ratios; the influence of a layer is tabulated for each.
POISSON = (0.0, 0.2, 0.3, 0.4, 0.45, 0.5)

KINDS = (
    "independent", "order 1", "order 1, layer", "order 3", "order 3, layer", "pedestals",
    "automatic", "resolved", "design",
)  # fmt: skip

# Parts of the scenes. Resolved contacts take a hundred times as long as the others.
SHARES = (0.25, 0.13, 0.13, 0.14, 0.14, 0.1, 0.04, 0.02, 0.05)

# The same of the laws, in the order of `_law`. The tables of a profile take a tenth of a second.
LAWS = (0.16, 0.14, 0.15, 0.02, 0.08, 0.08, 0.13, 0.13, 0.11)


@dataclass(frozen=True)
class Scene:
    """A surface, a model with its contact law, and increasing rescaled loads [mm²] or approaches [mm]."""

    kind: str
    surface: mf.Surface
    model: Model
    law: Contact
    control: np.ndarray
    by_load: bool = True


@dataclass(frozen=True)
class Units:
    """Factors of lengths and of the modulus."""

    length: float = 1.0
    modulus: float = 1.0


def random_scene(seed: int, inside: bool = True) -> Scene:
    """Return a scene whose loads end inside the documented range, or at up to twice its end."""
    rng = np.random.default_rng([seed, int(inside)])
    units = Units(*10.0 ** rng.uniform(-6.0, 6.0, 2)) if rng.random() < OTHER_UNITS else Units()
    kind = str(rng.choice(KINDS, p=SHARES))
    law = _law(rng, units)
    if kind == "resolved" and not resolvable(law):
        kind = "automatic"
    if kind == "design" and (
        law.adhesive or (isinstance(law, mf.Elastic) and isinstance(law.cap, mf.Profile))
    ):
        law = mf.Hertz()
    resolved = kind in ("automatic", "resolved")
    few = law.adhesive and rng.random() >= CROWDED
    most = FEW if resolved else DESIGNED if kind == "design" else ADHESIVE if few else MOST
    surface = _surface(rng, units, most, kind, inside)
    ends = _ends(surface)
    part = rng.uniform(0.1, 1.0) if inside else rng.uniform(1.0, 2.0)
    approach = _approach(surface, law, np.minimum(part * ends, LESS_THAN_A_SPHERE * surface.radius))
    fractions = np.linspace(0.5, 1.0, FEW_LOADS) if resolved else np.geomspace(1e-3, 1.0, LOADS)
    by_load = kind == "design" or rng.random() >= BY_APPROACH
    control = fractions * (_load(surface, law, approach) if by_load else approach)
    model = _model(rng, kind, law, _widest(surface, law, approach))
    return Scene(kind, surface, model, law, control, by_load)


def _surface(rng: np.random.Generator, units: Units, most: int, kind: str, inside: bool) -> mf.Surface:
    """Return up to `most` asperities: of one radius for a design, of limited height for pedestals."""
    side = int(rng.integers(2, int(np.sqrt(most)) + 1))
    count = side**2 if rng.random() < 0.5 else int(rng.integers(1, most + 1))
    if count == side**2:
        pitch = rng.uniform(0.6, 2.0)
        grid = pitch * np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
        position = np.asarray(grid, dtype=np.float64)
    else:
        closest = rng.uniform(0.4, 1.0)
        position = scattered(rng, count, closest, 1.6 * closest * np.sqrt(count))
    several = rng.random() < 0.3 and kind != "design"
    radius = rng.choice([0.3, 0.526, 0.8], count) if several else np.full(count, 0.526)
    depth = rng.exponential(rng.uniform(0.002, 0.05), count)
    top = min(0.2, TALLEST * float(radius.min())) if inside and kind == "pedestals" else 0.2
    height = top - np.minimum(depth - depth.min(), 0.95 * top)
    length = units.length
    width = length * (2.0 * float(np.abs(position).max()) + 1.0)
    block = mf.Block(width, width, length * rng.uniform(1.05, 8.0))
    material = mf.Material(MODULUS * units.modulus, float(rng.choice(POISSON)))
    return mf.Surface(length * position, length * height, length * radius, material, block=block)


def scattered(rng: np.random.Generator, count: int, closest: float, width: float) -> np.ndarray:
    """Return random sites at least `closest` apart in a square, which grows until the next one fits."""
    position = rng.uniform(0.0, width, (1, 2))
    while len(position) < count:
        site = rng.uniform(0.0, width, 2)
        if np.hypot(*(position - site).T).min() >= closest:
            position = np.vstack([position, site])
        else:
            width *= 1.01
    return position


def _law(rng: np.random.Generator, units: Units) -> Contact:
    """Return a random law."""
    stress, energy = units.modulus, units.length * units.modulus
    cap: Contact = (mf.Hertz(), mf.Elastic(mf.Sphere()), mf.Elastic(mf.Power(rng.uniform(1.5, 4.0))))[
        int(rng.integers(3))
    ]
    work = energy * float(np.exp(rng.uniform(np.log(1e-6), np.log(3e-5))))
    laws: tuple[Callable[[], Contact], ...] = (
        mf.Hertz,
        lambda: mf.Elastic(mf.Sphere()),
        lambda: mf.Elastic(mf.Power(rng.uniform(1.05, 8.0), rng.uniform(0.3, 1.0))),
        lambda: _profile(int(rng.integers(PROFILES)), units),
        lambda: mf.JKR(work, cap),
        lambda: mf.JKR(work),
        lambda: mf.KogutEtsion(stress * float(np.exp(rng.uniform(np.log(1.0), np.log(100.0))))),
        lambda: mf.JacksonGreen(stress * float(np.exp(rng.uniform(np.log(0.5), np.log(50.0))))),
        lambda: _tabulated(rng, units),
    )
    return laws[int(rng.choice(len(LAWS), p=LAWS))]()


def _tabulated(rng: np.random.Generator, units: Units) -> mf.TabulatedContact:
    """Return powers of the indentation as a table."""
    d = np.geomspace(1e-6, 3.0, 60)
    load = MODULUS * units.modulus * units.length**2 * d ** rng.uniform(1.2, 1.6)
    return mf.TabulatedContact(units.length * d, load, units.length**2 * d ** rng.uniform(0.8, 1.2))


# Profiles from which one is drawn.
PROFILES = 8


@cache
def _profile(which: int, units: Units) -> mf.Elastic:
    """Return one of the caps rho²/(2 b R) + c rho⁴ with R = 0.526 mm."""
    b, c = np.random.default_rng(which).uniform(0.8, 1.5, 2)
    length = units.length

    def depth(rho: np.ndarray) -> np.ndarray:
        at = rho / length
        return np.asarray(length * (at**2 / (1.052 * b) + c * at**4))

    return mf.Elastic(mf.Profile(depth, 1.2 * length))


def largest_load(surface: mf.Surface, law: Contact, part: float) -> float:
    """Return P/E* [mm²] of contacts without interaction that reach a part of the documented range."""
    return _load(surface, law, _approach(surface, law, part * _ends(surface)))


def _ends(surface: mf.Surface) -> np.ndarray:
    """Return the contact radii at the ends of the documented ranges, (n,) [mm]."""
    found = np.minimum(WIDTH * surface.radius, LAYER * surface.block.thickness) + np.zeros(surface.count)
    if surface.count > 1:
        apart = np.linalg.norm(surface.position[:, None] - surface.position, axis=-1)
        np.fill_diagonal(apart, np.inf)
        found = np.minimum(found, CROWDING * apart.min(axis=1))
    return found


def _approach(surface: mf.Surface, law: Contact, widest: np.ndarray) -> float:
    """Return the approach [mm] at which the first contact without interaction has its radius (n,) [mm].

    Adhesive contacts that are wider without a load have a tenth of the indentation without adhesion.
    """
    used = law.bound(surface)
    plain = used.without_adhesion.indentation(widest, surface.radius)
    depth = np.maximum(used.indentation(widest, surface.radius), LEAST_DEPTH * plain)
    return float((surface.gap + depth).min())


def _widest(surface: mf.Surface, law: Contact, approach: float) -> float:
    """Return the radius of the widest contact without interaction at an approach [mm]."""
    used = law.bound(surface)
    return float(used.contact_radius(approach - surface.gap, surface.radius).max())


def _load(surface: mf.Surface, law: Contact, approach: float) -> float:
    """Return the load of contacts without interaction or adhesion at an approach, P/E* [mm²]."""
    plain = law.bound(surface).without_adhesion
    z = np.maximum(approach - surface.gap, 0.0)
    return float(plain.load(plain.contact_radius(z, surface.radius), surface.radius).sum())


def _model(rng: np.random.Generator, kind: str, law: Contact, contact_radius: float) -> Model:
    """Return the model of a kind; cells are a part of a contact radius [mm]."""
    if kind == "design":
        kind = str(rng.choice(["independent", "order 1", "order 3"]))
    substrate = mf.BondedLayer() if kind.endswith("layer") else mf.HalfSpace()
    if kind in ("pedestals", "automatic", "resolved") and rng.random() < 0.5:
        substrate = mf.BondedLayer()
    order = 1 if kind.startswith("order 1") else law.largest_order
    return {
        "independent": lambda: mf.Independent(law),
        "pedestals": lambda: mf.Interacting(order, substrate, law, pedestal=True),
        "automatic": lambda: mf.Automatic(10.0 ** rng.uniform(-2.5, -1.5), substrate, law),
        "resolved": lambda: mf.BoundaryElements(contact_radius / rng.uniform(8.0, 16.0), substrate, law),
    }.get(kind, lambda: mf.Interacting(order, substrate, law))()
