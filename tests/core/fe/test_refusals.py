"""Wrong input of the finite elements is refused by its name and value."""

import numpy as np

import metafem as mf
from metafem.fe import Block3D
from tests.refusals import faults

BLOCK, MATERIAL = mf.Block(20.0, 20.0, 7.2), mf.Material(1.36)
LAYER = {"contact_radius": 0.1, "radius": 0.526, "thickness": 7.2}


def press(**change):
    mf.fe.press(**{**LAYER, **change})


def block(position=((0.0, 0.0),), block=BLOCK, **values):
    height = np.full(len(position), 0.1)
    Block3D(**values).for_surface(mf.Surface(position, height, 0.526, MATERIAL, block=block))


# Two of the words that an error must hold: the argument and the given value, or what limits it.
REFUSALS = [
    (lambda: press(contact_radius=0.0), "contact_radius", "0"),
    (lambda: press(poisson_ratio=0.51), "poisson_ratio", "0.51"),
    (lambda: press(radius=None), "radius", "missing"),
    (lambda: press(profile=np.square), "profile", "radius"),
    (lambda: press(thickness=None, height=0.1), "height", "thickness"),
    (lambda: press(height=0.12, contact_radius=0.4), "contact_radius = 0.4", "0.334"),
    (lambda: press(height=0.6), "height", "0.6"),
    (lambda: press(height=0.12, thickness=0.1), "thickness = 0.1", "0.12"),
    (lambda: press(cell_radius=0.846, contact_radius=0.9), "contact_radius = 0.9", "cell_radius = 0.846"),
    (lambda: press(height=0.2, block_radius=0.2), "block_radius = 0.2", "foot"),
    (lambda: mf.fe.press(0.1, profile=lambda r: -(r**2)), "profile", "load"),
    (lambda: mf.fe.press(0.2, 0.526, thickness=1.0, block_radius=2.0).displacement(3.0), "r", "body"),
    (lambda: block(block=None), "block", "Block3D"),
    (lambda: block([[0.0, 0.0], [11.0, 0.0]]), "position[1]", "(11, 0)"),
    (lambda: block(cell=0.0), "cell", "0"),
    (lambda: block(edge_cell=2.0), "edge_cell", "2"),
    (lambda: block(block=BLOCK, poisson_ratio=0.3), "poisson_ratio", "0.3"),
]


def test_wrong_input_is_refused_with_its_name_and_value():
    assert faults(REFUSALS) == []
