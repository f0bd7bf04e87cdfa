"""Times of curves with other contact laws over those with Hertz's, in one run on one core.

64 asperities, 100 loads up to P/E* = 0.5 mm^2, inside the compiled kernel. The laws take turns,
and each time is the least of several.
"""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.contact import Contact
from validation.timing import Row, best, kernel_time

LOADS, ROUNDS = 100, 5
MATERIAL = mf.Material(1.36)

# Largest time over that of Hertz contacts.
ELASTIC, PLASTIC = 2.0, 3.0


def steeper(rho: np.ndarray) -> np.ndarray:
    """Return a profile [mm] that is no power."""
    return np.asarray(rho**2 / 1.1 + rho**4)


LAWS: dict[str, Contact] = {
    "Hertz": mf.Hertz(),
    "power 1.5": mf.PowerCap(1.5),
    "power 4": mf.PowerCap(4),
    "sphere": mf.SphericalCap(),
    "profile": mf.AxisymmetricCap(steeper, 0.45),
    "Kogut and Etsion": mf.KogutEtsion(10.0),
    "Jackson and Green": mf.JacksonGreen(3.0),
}


def surface() -> mf.Surface:
    """Return 64 asperities with exponentially distributed heights on a square lattice."""
    height = 0.12 - np.minimum(np.random.default_rng(0).exponential(0.035, 64), 0.12)
    return mf.Surface.square_lattice(height, radius=0.526, material=MATERIAL)


def rows() -> list[Row]:
    """Measure curves of interacting and of independent asperities."""
    scene, found = surface(), []
    loads = np.linspace(0.005, 0.5, LOADS)
    for order in (3, 1):
        laws = {name: law for name, law in LAWS.items() if law.largest_order >= order}
        times = dict.fromkeys(laws, np.inf)
        for _ in range(ROUNDS):
            for name, law in laws.items():
                model = mf.Interacting(order, contact=law)
                times[name] = min(times[name], kernel_time(model, scene, LOADS))
        hertz = times.pop("Hertz")
        found.append(Row(f"order {order}: Hertz, each load", np.inf, 1e6 * hertz, "us"))
        for name, time in times.items():
            most = ELASTIC if laws[name].largest_order > 1 else PLASTIC
            found.append(Row(f"order {order}: {name} over Hertz", most, time / hertz))
    alone = {
        name: best(lambda law=law: mf.Independent(law).curve(scene, loads), 30) for name, law in LAWS.items()
    }
    hertz = alone.pop("Hertz")
    found.append(Row("independent: Hertz, each load", np.inf, 1e6 * hertz / LOADS, "us"))
    for name, time in alone.items():
        found.append(Row(f"independent: {name} over Hertz", np.inf, time / hertz))
    return found
