"""Unusual specifications: the page has data of each that a browser can read, or the reason in words."""

import json

import numpy as np
import pytest

from metafem.explorer.answer import answered
from metafem.explorer.certainty import tables_of
from metafem.explorer.contact_data import contact_data, press_data
from metafem.explorer.history import State
from metafem.explorer.law_data import law_data
from metafem.explorer.surface_data import layout_data, site_data
from metafem.explorer.table import with_values
from metafem.files import demo_text

LINEAR = with_values(State(demo_text("linear")).table, {"lattice.shape": [4, 4], "limits.height_step": None})
PINS = {"sites.pinned": [5], "sites.heights": ["150 um"], "sites.empty": [9]}
TOOLS = {"lattice.radius": None, "tools.radii": ["300 um", "526 um"]}
POINTS = {"target.kind": "sampled", "target.slope": None}
MANY = np.linspace(0.01, 0.1, 1000)
TABULATED = "indentation_um,load_mN,area_mm2\n" + "".join(
    f"{1e3 * d:.6g},{1e3 * 4 / 3 * 1.36 * 0.526**0.5 * d**1.5:.6g},{np.pi * 0.526 * d:.6g}\n"
    for d in np.linspace(0.004, 0.4, 40)
)
SCENES = {
    "one asperity": {"lattice.shape": [1, 1], "part": None},
    "a row": {"lattice.shape": [1, 50], "block.width": "80 mm"},
    "steep": {"target.slope": 1e4},
    "a thousand points": POINTS
    | {
        "target.rescaled_load": [f"{load:.6g} mm^2" for load in MANY],
        "target.rescaled_friction": [f"{7 * load:.6g} mm^2" for load in MANY],
        "lattice.shape": [2, 2],
    },
    "kept heights of several radii": TOOLS | PINS,
    "kept heights with adhesion": PINS
    | {"lattice.shape": [2, 5], "contact.kind": "jkr", "contact.adhesion_energy": "9 mJ/m^2"},
    "incompressible layer": {"model.kind": "layer", "material.poisson_ratio": 0.5},
    "plastic": {"contact.kind": "jackson-green", "contact.yield_strength": "4 MPa"},
    "a tabulated contact": {"contact.kind": "tabulated", "contact.file": "contact.csv"},
    "plastic contacts, resolved": {
        "model.kind": "resolved", "contact.kind": "kogut-etsion", "contact.hardness": "10 MPa",
    },
    "heights below a nanometre": {"limits.max_height": "0.0001 um"},
}  # fmt: skip


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_shown_or_refused_in_words(scene):
    state = State("", {"contact.csv": TABULATED}).edited(with_values(LINEAR, SCENES[scene]))
    answer = answered(state, 1, None, True)
    design = answer.design
    assert answer.current or answer.refused
    law = law_data(answer)
    law.pop("base")  # stays in the server
    shown = [law, site_data(answer)]
    shown.append(tables_of(answer))
    if design is not None:
        contacts = contact_data(design, None, sensitive=True)
        assert sum(radius is not None for radius in contacts["radius"]) == design.surface.count
        pressed = press_data(design)
        assert len(pressed["states"]) > 1
        assert sum(load is not None for load in pressed["entry"]) == np.count_nonzero(
            [radius or 0.0 for radius in pressed["states"][-1]["area"]]
        )
        shown += [layout_data(design), contacts, pressed]
    read = json.loads(json.dumps(shown, allow_nan=False))
    assert read[0]["refusal"] == answer.refused
    assert len(json.dumps(read[0])) < 2e4
