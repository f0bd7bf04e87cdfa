"""The models under which designs are checked and timed."""

from __future__ import annotations

import metafem as mf

MODELS = {
    "independent": mf.Independent(),
    "half-space": mf.Interacting(),
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
}
