"""Whole pages: those of the demos, of many summits and of crowded surfaces."""

import re

import pytest

import metafem as mf
from metafem.files import DEMOS
from metafem.report.page import page
from tests.core.report.test_page import words_of


@pytest.mark.parametrize("kind", DEMOS)
def test_the_page_of_a_demo_is_reproducible(demo_results, kind):
    folder, _ = demo_results(kind)
    design, text = mf.load(folder / kind), (folder / kind / "report.html").read_text("utf-8")
    assert text == page(design)
    assert not re.findall("use the model (layer|half-space|resolved)|base plane would touch", text)


def test_a_page_of_thousands_of_summits_is_small():
    template = mf.Surface.square_lattice(0.12, (40, 40), radius=0.526, material=mf.Material(1.36))
    text = page(mf.design(mf.LinearLaw(6.87), template))
    assert len(text) < 1.5e6  # the 2.8 MB of marks and rows grew with the number of summits


def test_a_crowded_surface_is_warned_of(template):
    crowded = template.replaced(position=0.2 / 1.5 * template.position, block=None)
    design = mf.design(mf.LinearLaw(6.87), crowded, limits=mf.Limits(0.12, offset=0.084))
    text = words_of(design)
    assert "the half-space is left out: " in text
    assert 'class="before warned"' in text
