"""The models under which designs are checked and timed, and the errors that their documentation states."""

from __future__ import annotations

import metafem as mf

MODELS = {
    "independent": mf.Independent(),
    "half-space": mf.Interacting(),
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
}

# Largest relative errors of order 3 in A0 at a given load and in P at a given approach, up to contact radii
# of 0.32 of the distances on a half-space: in the docstring of `Interacting`, the guide and the README. The
# first is that of 64 equal contacts; that of up to nine contacts is the second, because fewer neighbours act.
# They hold for paraboloids; those of nine spheres and power caps, up to power 4, are larger.
AREA_ERROR, FEW_ERROR, LOAD_ERROR = 2.5e-3, 1.2e-3, 3e-4
CAP_ERROR, CAP_LOAD_ERROR = 1.5e-3, 4e-4

# The same of A0 for one contact on a layer, up to contact radii of 0.3 of its thickness.
LAYER_ERROR = 2e-3
