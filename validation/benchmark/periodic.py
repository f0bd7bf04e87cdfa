"""Periodic cells against the unit cell of the finite elements, other sums, copies, and tamaas.

tamaas is installed by the extra ``[peers]`` (AGPL-3.0; metafem does not import it); without it the
comparison with tamaas is left out. Its areas are from the second moments of its pressures, and its cells are
extrapolated to zero.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem.substrate.periodic import lattice_sum
from validation.scenes.periodic import (
    COUNTS,
    LOAD,
    MATERIAL,
    ONE,
    PITCH,
    RADII,
    RADIUS,
    THIN,
    THREE,
    copies_error,
    extrapolated,
    repeated,
    unit_cell_error,
)
from validation.timing import Row, best

# Tolerance of tamaas on its own measure of complementarity.
PEER_TOLERANCE = 1e-10


def sum_errors() -> Iterator[tuple[str, float]]:
    """Yield the largest relative differences of sums with another splitting, and over images."""
    cell = mf.PeriodicCell(6.0, 2.0)
    x, y = np.array([0.0, 0.6, -2.7, 3.0]), np.array([0.0, 0.04, 0.6, 1.0])
    layer = mf.BondedLayer(THIN, 0.3)
    for substrate in (mf.HalfSpace(), layer):
        given = substrate.periodic(cell, x, y)
        other = lattice_sum(cell, x, y, substrate.transform, substrate.last_wavenumber, splitting=1.6)
        pairs = zip(given, other, strict=True)
        yield (
            f"{substrate.name}, another splitting",
            max(np.abs(a - b).max() / np.abs(a).max() for a, b in pairs),
        )
    i, j = (np.arange(-count, count + 1) * side for count, side in ((9, 6.0), (25, 2.0)))
    errors = []
    for k in range(1, len(x)):
        dx, dy = np.meshgrid(x[k] - i, y[k] - j)
        expected = float(layer.influence(np.hypot(dx, dy)).sum())
        errors.append(abs(layer.periodic(cell, x, y).value[k] / expected - 1.0))
    yield "layer, sum over images", max(errors)


def by_tamaas(surface: mf.Surface, count: int) -> tuple[np.ndarray, float]:
    """Return the loads of the asperities [N] and the area [mm^2] of tamaas, on count x count cells."""
    import tamaas

    assert surface.cell is not None
    side = surface.cell.width
    step = side / count
    axis = step * np.arange(count)
    depth = np.empty((surface.count, count, count))
    shift = np.empty((2, *depth.shape))
    for k, (centre, height) in enumerate(zip(surface.position, surface.height, strict=True)):
        dx, dy = surface.cell.nearest(*np.meshgrid(axis - centre[0], axis - centre[1], indexing="ij"))
        depth[k], shift[:, k] = height - (dx**2 + dy**2) / (2.0 * RADIUS), (dx, dy)
    owner = depth.argmax(axis=0)
    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(1)
    model = tamaas.Model(tamaas.model_type.basic_2d, [side] * 2, [count] * 2)
    model.E, model.nu = MATERIAL.composite_modulus, 0.0
    solver = tamaas.PolonskyKeerRey(model, depth.max(axis=0), PEER_TOLERANCE)
    solver.solve(LOAD / side**2)
    force = model.traction * step**2
    loads, areas = np.zeros(surface.count), 0.0
    for k in range(surface.count):
        p = np.where(owner == k, force, 0.0)
        loads[k] = p.sum()
        x, y = (part[k] - (p * part[k]).sum() / loads[k] for part in shift)
        xx, yy, xy = ((p * product).sum() / loads[k] for product in (x * x, y * y, x * y))
        areas += 5.0 * math.pi * math.sqrt(xx * yy - xy * xy)
    return loads, areas


def rows() -> Iterator[Row]:
    """Measure the errors of sums, order 3 and resolved contacts with a periodic cell, and times."""
    for name, error in sum_errors():
        yield Row(f"lattice sums: {name}", 1e-6, error)
    for radius in RADII:
        yield Row(
            f"P(a) against the unit cell of elements, a = {radius:g} mm", 5e-4, abs(unit_cell_error(radius))
        )
    yield Row("loads in a cell against the middle of 15 x 15 copies, layer of 1 mm", 1e-6, copies_error())
    model = mf.Interacting()
    single, several = (
        mf.equilibrium(surface, model, load=surface.count * 0.02).area / surface.count
        for surface in (ONE, repeated(ONE, 2))
    )
    yield Row("area of a cell of 2 x 2 against a cell of one", 1e-10, abs(several / single - 1.0))
    resolved = [mf.equilibrium(THREE, mf.BoundaryElements(3.0 / count), load=LOAD) for count in COUNTS]
    area = extrapolated([state.area for state in resolved])
    expected = mf.equilibrium(THREE, model, load=LOAD)
    yield Row(
        "area of resolved contacts, extrapolated, against order 3", 1e-3, abs(area / expected.area - 1.0)
    )
    if importlib.util.find_spec("tamaas") is not None:
        peers = [by_tamaas(THREE, count) for count in COUNTS]
        other = extrapolated([found[1] for found in peers])
        yield Row("the same area against tamaas, extrapolated", 1e-3, abs(area / other - 1.0))
        loads = np.array([extrapolated([float(found[0][k]) for found in peers]) for k in range(THREE.count)])
        own = [
            extrapolated([float(state.asperity_load[k]) for state in resolved]) for k in range(THREE.count)
        ]
        yield Row("loads of the asperities against tamaas", 1e-3, float(np.abs(own / loads - 1.0).max()))
        off = np.abs(expected.asperity_load / loads - 1.0).max()
        yield Row("loads of the asperities by order 3 against tamaas", 1e-3, float(off))
    lattice = mf.Surface.square_lattice(
        0.1, (8, 8), PITCH, radius=RADIUS, material=MATERIAL, cell=mf.PeriodicCell(8 * PITCH, 8 * PITCH)
    )
    heights = lattice.height + 0.02 * np.random.default_rng(0).random(64)
    scene = lattice.replaced(height=heights)
    load = np.linspace(0.05, 0.5, 20)
    periodic, bounded = (
        best(lambda s=s: model.curve(s, load), 3) for s in (scene, scene.replaced(cell=None))
    )
    yield Row("time of 20 loads of 64 asperities, divided by that without a cell", 1.5, periodic / bounded)
    heights = 0.1 + 0.03 * np.random.default_rng(0).random(10_000)
    large = mf.Surface.square_lattice(
        heights,
        (100, 100),
        PITCH,
        radius=RADIUS,
        material=MATERIAL,
        cell=mf.PeriodicCell(100 * PITCH, 100 * PITCH),
    )
    many = np.linspace(20.0, 100.0, 5)
    periodic, bounded = (
        best(lambda s=s: model.curve(s, many), 1) for s in (large, large.replaced(cell=None))
    )
    yield Row("time of 5 loads of 10,000 asperities, divided by that without a cell", 1.5, periodic / bounded)
    yield Row("5 loads of 10,000 asperities in a cell, order 3", 2.0, periodic, "s")
    seconds = best(lambda: mf.HalfSpace().influence_terms(scene), 3)
    yield Row("lattice sums of 64 sites", 0.1, seconds, "s")
