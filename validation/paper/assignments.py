"""Changes of A0 by elastic interaction, of many assignments of the heights of a surface to its sites."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from validation.paper.surfaces import LOADS, designs, surfaces

ASSIGNMENTS = 1000

SUBSTRATES = {"half-space": mf.HalfSpace(), "layer": mf.BondedLayer()}


def fitted_loads(name: str) -> np.ndarray:
    """Return 20 equal loads [mm²] over the lines that are fitted to the law of a design, (20,)."""
    ends = [branch.load_range for branch, _ in designs()[name].fits]
    return np.linspace(np.min(ends), np.max(ends), len(LOADS))


@cache
def changes(
    name: str, on: str = "half-space", order: int = 3, fitted: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the changes of A0 as designed, centred and at random sites (m, k), and the sinking [mm].

    fitted: at the loads of the fitted lines, else at `LOADS`.
    """
    loads = fitted_loads(name) if fitted else LOADS
    surface, rng = surfaces()[name], np.random.default_rng(0)
    nearest = np.argsort((surface.position**2).sum(axis=1))
    centred = np.empty(surface.count)
    centred[nearest] = np.sort(surface.height)[::-1]
    random = (rng.permutation(surface.height) for _ in range(ASSIGNMENTS))
    alone = mf.Independent().curve(surface, loads)
    model, heights = mf.Interacting(order, SUBSTRATES[on]), [surface.height, centred]
    curves = [
        model.curve(surface.replaced(height=height), loads).checked()
        for height in (*heights, *(random if order == 3 else ()))
    ]
    area = np.array([curve.area for curve in curves])
    return area / alone.area - 1.0, curves[0].approach - alone.approach


def rms(change: np.ndarray) -> np.ndarray:
    """Root mean square over the loads."""
    return np.sqrt((change**2).mean(axis=-1))


def readings(name: str) -> dict[str, np.ndarray]:
    """Return the rms of the assignments on a half-space by each reading of the paper, (m,)."""
    change, surface = changes(name)[0][2:], surfaces()[name]
    alone = mf.Independent().curve(surface, LOADS)
    area, step = alone.area, np.abs(np.gradient(alone.approach))
    return {
        "rms": rms(change),
        "rms over the largest A0": rms(change * area) / area.max(),
        "rms over the rms of A0": rms(change * area) / rms(area),
        "rms at loads up to 0.35 mm²": rms(change[:, : len(LOADS) // 2]),
        "rms even in separation": np.sqrt((change**2 * step).sum(axis=-1) / step.sum()),
    }
