"""Change of A0(P) by the compliance of the caps' pedestals, on the five surfaces of the paper."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Claim, below, reported
from validation.paper.interaction_error import LOADS
from validation.paper.surfaces import surfaces

MODELS = "order 3 on the bonded layer, with and without pedestals, this check"
# A0 grows as the sum of P_i^(2/3), which is largest for equal loads.
SIGN = "sign: compliance of each cap evens out the loads, and A0 ~ Σ P_i^(2/3) grows"


def claim() -> Claim:
    """Compare the layer with and without pedestals, at order 3."""
    checks = []
    for name in surfaces():
        independent, layer, pedestals = laws(name)
        added = pedestals.area / layer.area - 1.0
        coupled = layer.area / independent.area - 1.0
        lower = 1e3 * (layer.separation - pedestals.separation)
        checks += [
            reported(f"{name}: rms change of A0 by the pedestals", _rms(added), MODELS),
            reported(f"{name}: rms change of A0 by the layer alone", _rms(coupled), MODELS),
            reported(
                f"{name}: rms change of A0 by both", _rms(pedestals.area / independent.area - 1.0), MODELS
            ),
            reported(f"{name}: decrease of separation at the last load [µm]", lower[-1], MODELS),
            below(f"{name}: largest loss of A0 by the pedestals", float(-added.min()), 0.0, SIGN),
        ]
    return Claim("The pedestals' effect on the law", checks, {"change": _figure})


def laws(name: str) -> tuple[mf.FrictionLaw, mf.FrictionLaw, mf.FrictionLaw]:
    """Laws of independent asperities, of the layer, and of the layer with pedestals."""
    surface = surfaces()[name]
    load = LOADS * surface.material.composite_modulus
    layer = mf.BondedLayer()
    models = (
        mf.Independent(),
        mf.Interacting(substrate=layer),
        mf.Interacting(substrate=layer, pedestal=True),
    )
    first, second, third = (mf.friction_law(surface, model, load=load) for model in models)
    return first, second, third


def _rms(change: np.ndarray) -> float:
    return float(np.sqrt((change**2).mean()))


def _figure():
    figure = new_figure(8.0, 3.2)
    ax = figure.add_subplot()
    for name in surfaces():
        independent, _, pedestals = laws(name)
        ax.plot(LOADS, 100.0 * (pedestals.area / independent.area - 1.0), label=name)
    ax.axhline(0.0, color="grey", lw=0.8)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("change of A0, layer and pedestals [%]")
    ax.legend(frameon=False)
    return figure
