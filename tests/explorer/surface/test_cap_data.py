"""The shapes of caps for the pictures, and what the mould has besides."""

import csv
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.caps import Caps
from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.surface.cap_data import (
    DECIMALS,
    NO_BLOCK,
    NO_SURFACE,
    cap_data,
    kind_of_cap,
    mould_data,
)
from metafem.explorer.surface.surface_data import layout_data, site_data
from metafem.explorer.text.document import Document
from metafem.files import demo_text, result_tables

TEXT = demo_text("operating-points")

CAPS = {
    "sphere": mf.Sphere(),
    "paraboloid": mf.Paraboloid(),
    "power": mf.Power(4.0),
    "profile": mf.Profile([[0.0, 0.2, 0.5], [0.0, 0.03, 0.3]]),
}


def surface_of(cap, radius=0.5):
    return mf.Surface([[0.0, 0.0], [2.0, 0.0]], [0.1, 0.12], radius, mf.Material(1.36), cap=cap)


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


def answer_to(**values):
    return answered(
        State(Document(TEXT).with_values({k.replace("__", "."): v for k, v in values.items()})), 1
    )


@pytest.mark.parametrize("cap", CAPS.values(), ids=CAPS)
def test_a_meridian_lies_on_the_cap_down_to_the_height(cap):
    (data,) = cap_data(surface_of(cap), 0.12)
    scale = 0.5 if data["scaled"] else 1.0
    across, depth = scale * np.array(data["across"]), scale * np.array(data["depth"])
    assert across[0] == depth[0] == 0.0
    assert depth[-1] == pytest.approx(0.12, rel=1e-5)
    # half of the last decimal that is sent, of both lengths; no cap here is steeper than 45 degrees
    np.testing.assert_allclose(cap.depth_at(across, 0.5), depth, atol=2.0 * 0.5 * 10.0**-DECIMALS)


def test_a_meridian_ends_where_the_cap_ends():
    (data,) = cap_data(surface_of(mf.Sphere()), 0.9)
    assert (data["across"][-1], data["depth"][-1]) == (1.0, 1.0)


def test_a_surface_below_its_base_plane_has_shapes():
    (data,) = cap_data(surface_of(mf.Sphere()), -0.1)
    assert data["depth"][-1] > 0.0


def test_each_kind_of_cap_has_its_meridian():
    surface = surface_of(Caps.of([mf.Power(4.0), mf.Sphere()]), [0.5, 0.2])
    kinds = kind_of_cap(surface)
    data = cap_data(surface, 0.12)
    assert kinds.tolist() == [0, 1]
    # over the radius of each kind
    assert [each["depth"][-1] for each in data] == pytest.approx([0.12 / 0.5, 0.12 / 0.2])


def test_the_mould_of_the_picture_is_that_of_its_table(answer):
    layout, surface, mould = layout_data(answer.design), site_data(answer), mould_data(answer)
    filled = sorted(answer.design.sites)
    shown = [(layout["x"][i], layout["y"][i], surface["height"][i], surface["radius"]) for i in filled]
    shown += [(each["x"], each["y"], each["height"], each["radius"]) for each in mould["alignment"]]
    table = result_tables(answer.design, answer.specification.part)["mould.csv"]
    rows = list(csv.DictReader(table.splitlines()))
    assert [row["kind"] for row in rows[-4:]] == ["alignment"] * 4
    rows[:-4] = sorted(rows[:-4], key=lambda row: int(row["site"]))
    names = ("x_mm", "y_mm", "depth_mm", "tool_radius_mm")
    # the picture turns the part over: x is mirrored
    expected = [[float(row[name]) for name in names] for row in rows] * np.array([-1.0, 1.0, 1e3, 1.0])
    # half of the last decimals that are sent
    np.testing.assert_allclose(shown, expected, atol=0.005)
    block = answer.specification.template.block
    assert mould["thickness"] == pytest.approx(block.thickness + expected[:, 2].max() / 1e3, rel=1e-12)
    assert surface["mould"] == mould


def test_a_mould_that_cannot_be_made_says_why(answer):
    without = answer_to(block=None, part=None)
    assert mould_data(without) == {"problem": NO_BLOCK}
    height = np.array(answer.design.surface.height)
    height[7] = 0.0
    surface = answer.design.surface.replaced(height=height)
    low = replace(answer, design=replace(answer.design, surface=surface))
    assert mould_data(low) == {"problem": low.no_part}
    tall = answer_to(limits__max_height="450 um")
    assert "must exceed the tallest summit" in mould_data(tall)["problem"]
    assert mould_data(replace(tall, problems={})) == {"problem": NO_SURFACE}


def test_a_draft_has_shapes_but_no_mould():
    data = site_data(answered(State(TEXT), 1, draft=True))
    assert "mould" not in data
    assert len(data["caps"]) == 1
    assert data["cap"] is None
