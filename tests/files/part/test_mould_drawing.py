from xml.etree import ElementTree

import numpy as np
import pytest

import metafem as mf
from metafem.files import PartOptions, planned
from metafem.files.part.mould_drawing import mould_drawing

SVG = "{http://www.w3.org/2000/svg}"


def drawn(rows, alignment=0.4, radius=0.526):
    side = 1.5 * (rows + 2) + 2.0
    surface = mf.Surface.square_lattice(
        np.random.default_rng(0).uniform(0.05, 0.2, rows**2), (rows, rows), radius=radius,
        material=mf.Material(1.36), block=mf.Block(side, side, 7.2),
    )  # fmt: skip
    part = planned(surface, surface, PartOptions(alignment))
    return part, mould_drawing(part.surface, part.asperities, part.block)


def circles(text):
    return [c.attrib for g in ElementTree.fromstring(text).iter(f"{SVG}g") for c in g.findall(f"{SVG}circle")]


def test_each_hole_is_drawn_to_scale_and_mirrored():
    part, text = drawn(3)
    root = ElementTree.fromstring(text)
    outline = next(g.find(f"{SVG}rect") for g in root.iter(f"{SVG}g") if g.find(f"{SVG}rect") is not None)
    scale = float(outline.attrib["width"]) / part.block.width
    middle = float(outline.attrib["x"]) + 0.5 * float(outline.attrib["width"])
    holes = circles(text)
    assert len(holes) == part.surface.count == 13
    found = sorted((middle - float(hole["cx"])) / scale for hole in holes)
    np.testing.assert_allclose(found, np.sort(part.surface.position[:, 0]), atol=1e-3)
    rims = sorted(float(hole["r"]) / scale for hole in holes)
    h, R = part.surface.height, part.surface.radius
    np.testing.assert_allclose(rims, np.sort(np.sqrt(h * (2.0 * R - h))), rtol=5e-3)


def test_dimensions_are_stated():
    part, text = drawn(3)
    words = [element.text for element in ElementTree.fromstring(text).iter(f"{SVG}text")]
    assert words.count(f"{part.block.width:g}") == 2
    assert words.count("pitch 1.5") == 2
    assert {str(row + 1) for row in range(13)} <= set(words)
    assert any("x is mirrored" in word for word in words)
    assert any("Scale 20:1" in word or "Scale 10:1" in word for word in words)


def test_each_tool_has_its_line():
    _, text = drawn(2, alignment=None, radius=np.array([0.3, 0.3, 0.5, 0.5]))
    assert "2 holes, tool radius R 0.3" in text
    assert "2 holes, tool radius R 0.5" in text


@pytest.mark.slow
@pytest.mark.parametrize("rows", [100])
def test_ten_thousand_holes_stay_below_a_megabyte(rows):
    _, text = drawn(rows)
    assert len(circles(text)) == rows**2 + 4
    assert len(text) < 1e6


def test_scattered_holes_have_no_pitch():
    surface = mf.Surface([[0, 0], [1.3, 0.2], [3.1, 1.7]], 0.1 * np.ones(3), 0.5, mf.Material(1.0))
    assert "pitch" not in mould_drawing(surface, 3, mf.Block(10.0, 10.0, 3.0))


def test_holes_of_another_profile_are_drawn_by_their_own_rims():
    surface = mf.Surface([[0, 0], [3, 0]], [0.1, 0.1], 0.5, mf.Material(1.0))
    block = mf.Block(10.0, 10.0, 3.0)
    sphere, quartic = (
        mould_drawing(surface.replaced(cap=cap), 2, block) for cap in (mf.Sphere(), mf.Power(4))
    )
    rims = [{float(c["r"]) for c in circles(text) if float(c["r"]) != 1.6} for text in (sphere, quartic)]
    # feet sqrt(h (2 R - h)) and R (2 h/R)^(1/4), drawn at 20:1
    assert [sorted(found) for found in rims] == [[6.0], [7.95]]
    words = "Profile of the holes: Power(exponent=4.0, coefficient=0.5)."
    assert words in quartic
    assert "Profile" not in sphere
