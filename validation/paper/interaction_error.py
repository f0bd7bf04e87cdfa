"""The paper's claim that elastic interaction changes A0(P) by less than 2.3 % rms, on its surfaces.

The in-plane places of the heights are printed for Fig. 5 alone; for the others the change is that of
1,000 random placements, and of the tallest asperities together in the centre.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Check, Claim, below, near
from validation.paper.surfaces import fig3, fig4, template
from validation.published import PAPER, paper, table

# The tests of this claim carry the mark "slow".
SLOW = True

PLACEMENTS = 1000

# Loads P/E* [mm²], which reach from the lightest measured ones beyond full contact of all surfaces.
LOADS = 0.7 * np.arange(1, 21) / 20

MODELS = {
    f"{name}, order {order}": mf.Interacting(order=order, substrate=substrate)
    for name, substrate in (("half-space", mf.HalfSpace()), ("layer", mf.BondedLayer()))
    for order in (1, 3)
}

# An independent computation found .4 to 1.4 % on the designs of Figs. 4 and 5 and up to 3.3 % for some
# placements of Fig. 3; its loads are not stated, and they move the figure in its last digit.
EXPECTED_LOW, EXPECTED_HIGH = 0.003, 0.015

COLOURS = {"half-space, order 3": ("#1b6f8a", -0.2), "layer, order 3": ("#c8553d", 0.2)}


@cache
def surfaces() -> dict[str, mf.Surface]:
    """Return the five surfaces; Fig. 5 with the printed heights at their printed places."""
    printed = table("table_s2")
    found = {"Fig. 3": fig3().surface, "Fig. 4 blue": fig4("blue").surface, "Fig. 4 red": fig4("red").surface}
    for colour in ("blue", "red"):
        found[f"Fig. 5 {colour}"] = template(f"fig5_{colour}").replaced(height=printed[colour] / 1e3)
    return found


@cache
def changes(name: str, model: str, placements: int = PLACEMENTS) -> dict[str, np.ndarray]:
    """Relative change of A0 (k,) as placed and centred, of random placements (m, k), and sinking [mm]."""
    surface = surfaces()[name]
    rng = np.random.default_rng(0)
    nearest = np.argsort((surface.position**2).sum(axis=1))
    centred = np.empty(surface.count)
    centred[nearest] = np.sort(surface.height)[::-1]
    heights = [surface.height, centred, *(rng.permutation(surface.height) for _ in range(placements))]
    alone, _, area, _ = mf.Independent().curves(surface.height, surface.radius, LOADS)
    approach, _, coupled, _ = MODELS[model].curves(surface, np.array(heights), LOADS)
    placed, centre, *dealt = coupled / area - 1.0
    sinking = approach[0] - alone[0]
    return {"placed": placed, "centred": centre, "random": np.array(dealt), "sinking": sinking}


def rms(change: np.ndarray) -> np.ndarray:
    """Root mean square over the loads."""
    return np.sqrt((change**2).mean(axis=-1))


def claim() -> Claim:
    """Measure the change on the five surfaces, and compare the models with each other."""
    limit = paper()["interaction"]["rms_area_difference_below"]
    checks: list[Check] = []
    for name in surfaces():
        half_space, layer = changes(name, "half-space, order 3"), changes(name, "layer, order 3")
        random = rms(half_space["random"])
        if "5" in name:
            rounded = rms(half_space["placed"])
            checks.append(below(f"{name}, placed as printed: rms", rounded, limit, f"{PAPER}, text"))
        elif "4" in name:
            checks.append(
                below(f"{name}: median rms of placements", np.median(random), limit, f"{PAPER}, text")
            )
        else:
            checks.append(below(f"{name}: least rms of placements", random.min(), limit, f"{PAPER}, text"))
        worst = np.abs(half_space["placed"]).max()
        checks += [
            _told(f"{name}: share of {PLACEMENTS} placements below {limit}", (random < limit).mean()),
            _told(f"{name}: median rms of them", np.median(random)),
            _told(f"{name}: largest rms of them", random.max()),
            _told(f"{name}: rms with the tallest in the centre", rms(half_space["centred"])),
            _told(f"{name}, as placed: largest change at one load", worst),
            _told(f"{name}, as placed: rms, layer", rms(layer["placed"])),
            _told(f"{name}: sinking at 0.35 mm², half-space [µm]", 1e3 * half_space["sinking"][9]),
            _told(f"{name}: sinking at 0.35 mm², layer [µm]", 1e3 * layer["sinking"][9]),
        ]
    placed = [
        rms(changes(name, "half-space, order 1", 0)["placed"]) for name in surfaces() if "3" not in name
    ]
    middle, half = 0.5 * (EXPECTED_LOW + EXPECTED_HIGH), 0.5 * (EXPECTED_HIGH - EXPECTED_LOW)
    checks += [
        near("Figs. 4 and 5: smallest rms, order 1", min(placed), middle, half, "recomputed"),
        near("Figs. 4 and 5: largest rms, order 1", max(placed), middle, half, "recomputed"),
    ]
    for substrate in ("half-space", "layer"):
        orders = [changes("Fig. 5 red", f"{substrate}, order {order}", 0)["placed"] for order in (1, 3)]
        name = f"Fig. 5 red, {substrate}: largest difference of orders 1 and 3"
        checks.append(_told(name, np.abs(orders[0] - orders[1]).max()))
    return Claim("Elastic interaction changes A0(P)", checks, {"placements": _placements, "laws": _laws})


def _told(name: str, value: float) -> Check:
    """Report a number that nobody has printed."""
    return Check(name, float(value), "measured", bool(np.isfinite(value)), "")


def _placements():
    figure = new_figure(8.0, 3.4)
    ax = figure.add_subplot()
    for i, name in enumerate(surfaces()):
        for model, shift, colour in (
            ("half-space, order 3", -0.2, "#1b6f8a"),
            ("layer, order 3", 0.2, "#c8553d"),
        ):
            change = changes(name, model)
            spread = 100.0 * rms(change["random"])
            ax.boxplot([spread], positions=[i + shift], widths=0.3, whis=(0, 100),
                       boxprops={"color": colour}, medianprops={"color": colour})  # fmt: skip
            ax.plot(i + shift, 100.0 * rms(change["placed"]), "D", ms=5, color=colour,
                    label=model if i == 0 else None)  # fmt: skip
    ax.axhline(2.3, color="grey", lw=0.8, ls="--", label="the paper's bound")
    ax.set_xticks(range(len(surfaces())), list(surfaces()))
    ax.set_ylabel("rms change of A0 [%]")
    ax.legend(frameon=False)
    return figure


def _laws():
    figure = new_figure(8.0, 3.4)
    ax = figure.add_subplot()
    for name in surfaces():
        ax.plot(LOADS, 100.0 * changes(name, "half-space, order 3")["placed"], label=name)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("change of A0, half-space [%]")
    ax.legend(frameon=False)
    return figure
