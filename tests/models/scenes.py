"""Scenes and models that several tests share."""

import numpy as np

import metafem as mf

PEDESTAL = mf.Interacting(order=3, substrate=mf.BondedLayer(), pedestal=True)

MODELS = [
    mf.Independent(),
    mf.Interacting(order=1),
    mf.Interacting(order=3),
    mf.Interacting(order=1, substrate=mf.BondedLayer()),
    mf.Interacting(order=3, substrate=mf.BondedLayer()),
    PEDESTAL,
]


class Read(mf.Elastic):
    """The law of a cap, which kernels read from its table even if it is a paraboloid."""

    def bound(self, surface):
        return self


# A bowl, and loads and areas of spheres of 0.526 mm at indentations, up to those of the scenes here.
BOWL = np.linspace(0.0, 3.0, 8)
DEEP = np.geomspace(1e-6, 1.0, 12)

# Every other contact law, in units of length and of the modulus. A new law is one line here.
LAWS = {
    "quartic": lambda length, modulus: mf.Elastic(mf.Power(4, 0.5)),
    "sphere": lambda length, modulus: mf.Elastic(mf.Sphere()),
    "profile": lambda length, modulus: mf.Elastic(mf.Profile(length * np.array([BOWL, BOWL**2 / 1.1]))),
    "jkr": lambda length, modulus: mf.JKR(9e-6 * length * modulus),
    "kogut-etsion": lambda length, modulus: mf.KogutEtsion(0.8 * modulus),
    "jackson-green": lambda length, modulus: mf.JacksonGreen(0.4 * modulus),
    "tabulated": lambda length, modulus: mf.TabulatedContact(
        length * DEEP, 1.36 * modulus * length**2 * DEEP**1.4, length**2 * 1.7 * DEEP
    ),
}


def with_law(name, length=1.0, modulus=1.0):
    """Models of a contact law, without and with interaction, of the law's largest order."""
    law = LAWS[name](length, modulus)
    return mf.Independent(contact=law), mf.Interacting(order=law.largest_order, contact=law)


# Six unequal asperities, none at a special place.
PLACE = np.array([[0.1, 0.2], [1.4, -0.3], [-0.2, 1.9], [1.7, 1.5], [3.3, 0.4], [2.9, 2.6]])
HEIGHT = np.array([0.10, 0.16, 0.13, 0.149, 0.155, 0.11])
RADIUS = np.array([0.5, 0.6, 0.4, 0.526, 0.45, 0.7])


def scene(place=PLACE, height=HEIGHT, radius=RADIUS, modulus=1.36, thickness=7.2, poisson_ratio=0.5):
    material = mf.Material(modulus, poisson_ratio)
    return mf.Surface(place, height, radius, material, block=mf.Block(20, 20, thickness))


def lattice(height, radius=0.526, **material):
    side = round(np.sqrt(np.size(height)))
    x = 1.5 * np.arange(side)
    return scene(np.column_stack([np.tile(x, side), np.repeat(x, side)]), height, radius, **material)


def single_contact(law, cells, offset=(0.3, 0.1), contact_radius=0.2):
    """States of one contact by so many cells per radius, its centre off those of the cells, and by its law.

    A far, low summit moves the middle of the grid.
    """
    cell = contact_radius / cells
    far = [200.0 * cell + 2.0 * offset[0] * cell, 2.0 * offset[1] * cell]
    surface = mf.Surface([[0.0, 0.0], far], [0.0, -10.0], 0.526, mf.Material(1.36))
    approach = float(law.indentation(contact_radius, 0.526))
    models = mf.BoundaryElements(cell, contact=law), mf.Independent(contact=law)
    return [mf.equilibrium(surface, model, approach=approach) for model in models]


def said(result):
    """The notes of a state, a law or a design, as one text."""
    return "\n".join(map(str, result.notes))
