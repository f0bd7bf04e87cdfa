"""Views of surfaces."""

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection

import metafem as mf
from metafem.report.relief import RISE, projected, relief
from metafem.report.views import MOST_SHAPED, contact_figure, shape_figure

MATERIAL = mf.Material(1.36)
CORNERS = np.array([[-1.0, -1.0], [1.0, 1.0]])


def test_a_cap_is_drawn_at_its_projection_and_hides_what_is_behind_it():
    colour = np.array([[1.0, 0.0, 0.0, 1.0]])
    cap = np.zeros((1, 2)), np.array([0.5]), np.array([0.5]), colour
    image, (left, right, low, high), factor = relief(*cap, CORNERS)
    assert factor == 1
    rows, columns = image.shape[:2]

    def pixel(place, height):
        u, s = projected(np.array(place), height)
        row, column = (s - low) / (high - low), (u - left) / (right - left)
        return image[min(int(row * rows), rows - 1), min(int(column * columns), columns - 1)]

    assert pixel([0.0, 0.0], 0.49)[0] > 1.2 * pixel([0.0, 0.0], 0.49)[1]  # red: the summit
    # just behind the cap, on the line of sight through it
    behind = np.array([-math.sin(math.radians(30.0)), math.cos(math.radians(30.0))]) * 0.6
    reached = 0.6 * math.tan(RISE)
    assert reached < 0.5
    assert pixel(behind, 0.0)[0] > 1.2 * pixel(behind, 0.0)[1]
    assert pixel([0.9, -0.9], 0.0)[0] == pytest.approx(pixel([0.9, -0.9], 0.0)[1])  # the base is grey
    assert image[-1, 0, 3] == 0.0  # nothing beside the block


def test_a_cap_is_drawn_with_its_profile():
    colour = np.array([[1.0, 0.0, 0.0, 1.0]])
    cap = np.zeros((1, 2)), np.array([0.3]), np.array([0.5]), colour, CORNERS
    sphere, quartic, wide = (relief(*cap, shape)[0] for shape in (mf.Sphere(), mf.Power(4), mf.Power(8)))
    red = [int((image[..., 0] > 1.1 * image[..., 1]).sum()) for image in (sphere, quartic, wide)]
    # nearly that of the feet, 0.458, 0.468 and 0.494 mm, and of a blunt cap more
    assert red[0] < red[1] < red[2]


@pytest.mark.parametrize("kind", ["one", "row", "tall", "differing"])
def test_every_surface_has_a_picture(kind):
    surface = {
        "one": mf.Surface([[0.0, 0.0]], [0.1], 0.5, MATERIAL),
        "row": mf.Surface.square_lattice(0.1, (1, 5), radius=0.526, material=MATERIAL),
        "tall": mf.Surface.square_lattice([0.1, 0.9], (1, 2), radius=0.526, material=MATERIAL),
        "differing": mf.Surface.square_lattice(0.1, (2, 2), radius=[0.2, 0.3, 0.4, 0.5], material=MATERIAL),
    }[kind]
    assert shape_figure(_design(surface)).axes


def test_open_summits_are_rings_and_contacts_are_discs():
    surface = mf.Surface.square_lattice([0.1, 0.1, 0.2, 0.2], (2, 2), radius=0.526, material=MATERIAL)
    first, _, last = contact_figure(_design(surface)).axes
    for ax, rings in ((first, 2), (last, 0)):
        hollow, filled = (part for part in ax.collections if isinstance(part, EllipseCollection))
        assert (len(hollow.get_offsets()), len(filled.get_offsets())) == (rings, 4 - rings)
        assert not hollow.get_facecolor().size
        assert filled.get_facecolor().size


def test_the_picture_shows_the_whole_block():
    lattice = {"radius": 0.526, "material": MATERIAL, "block": mf.Block(20.0, 18.0, 7.2)}
    few, many = (mf.Surface.square_lattice(0.1, (n, n), pitch=0.6, **lattice) for n in (8, 21))
    words = [[text.get_text() for text in shape_figure(_design(each)).axes[0].texts] for each in (few, many)]
    assert words[0] == ["x: 20 mm", "y: 18 mm"]
    assert words[1] == ["x: 12 mm", "y: 12 mm"]  # an excerpt


def test_of_many_summits_the_surroundings_of_the_tallest_are_shown():
    height = np.full(900, 0.1)
    height[899] = 0.2
    surface = mf.Surface.square_lattice(height, (30, 30), radius=0.526, material=MATERIAL)
    ax = contact_figure(_design(surface, 0.3)).axes[0]
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    assert ((surface.position[899] > low) & (surface.position[899] < high)).all()
    shown = ((surface.position > low) & (surface.position < high)).all(axis=1).sum()
    assert 0.5 * MOST_SHAPED < shown < 1.3 * MOST_SHAPED
    assert "1 of 900 in contact" in ax.get_title()


def _design(surface, load=0.5):
    """Return a design whose surface is this one, its law drawn up to a load [N]."""
    lattice = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=MATERIAL)
    first = mf.design(mf.OperatingPoints([0.01], [0.1]), lattice)
    law = mf.friction_law(surface, load=[load])
    return replace(first, surface=surface, template=surface, sites=np.arange(surface.count), law=law)
