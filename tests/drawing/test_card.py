"""What a notebook shows: facts and a picture as HTML without scripts, requests or colours of its own."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import metafem as mf
from metafem.drawing import card


@pytest.fixture(scope="module")
def results():
    material, friction = mf.Material(1.36), mf.Friction(0.358, 0.85)
    heights = 0.1 + 0.02 * np.random.default_rng(0).random((4, 4))
    surface = mf.Surface.square_lattice(
        heights, (4, 4), radius=0.526, material=material, friction=friction, block=mf.Block(9.0, 9.0, 7.2)
    )
    pair = mf.Surface([[0.0, 0.0], [1.0, 0.0]], [0.1, 0.11], 0.526, material)
    target = mf.OperatingPoints([0.02, 0.06], [0.2, 0.45])
    return {
        "Surface": surface,
        "Friction law": mf.friction_law(surface),
        "Friction law without friction": mf.friction_law(pair),
        "Contact state": mf.equilibrium(surface, load=0.1),
        "Contact state of two": mf.equilibrium(pair, load=0.1),
        "Contact state with cells": mf.equilibrium(pair, mf.BoundaryElements(0.02), load=0.1),
        "Design": mf.design(target, surface, limits=mf.Limits(0.16)),
    }


@pytest.mark.parametrize(
    "name",
    [
        *("Surface", "Friction law", "Friction law without friction", "Contact state"),
        *("Contact state of two", "Contact state with cells", "Design"),
    ],
)
def test_results_show_their_facts_in_a_notebook(results, name):
    """Well-formed elements without scripts or requests, in the colours of the notebook."""
    value = results[name]
    text = value._repr_html_()
    root = ElementTree.fromstring(text)
    words = " ".join(" ".join(root.itertext()).split())
    for fact in value._facts().values():
        assert " ".join(fact.split()).replace("mm^2", "mm²") in words
    names = {element.tag.rpartition("}")[2] for element in root.iter()}
    assert ("svg" in names) == (name != "Contact state of two")
    assert "script" not in names
    assert not re.findall(r"(?:src|href)=\"(?!#|data:)", text)
    assert len(value._facts()) <= 9
    assert "--ink: currentColor" in text
    assert not re.findall(r"(?<!, )#000000", text)


def test_few_points_of_a_long_line_are_kept_with_its_ends():
    x = np.arange(12_345.0)
    kept, same = card.thinned(x, 2.0 * x)
    assert (kept[0], kept[-1]) == (x[0], x[-1])
    assert len(kept) == card.MOST_POINTS
    assert np.array_equal(same, 2.0 * kept)
    assert len(card.thinned(x[:7])[0]) == 7


def test_texts_are_escaped():
    assert "&lt;b&gt;" in card.card("<b>", {"a": "<b>"})


def test_a_law_that_did_not_converge_is_still_printed(results):
    law = results["Friction law"]
    failed = replace(law, status=mf.Status.NOT_CONVERGED, area=np.full_like(law.area, np.nan))
    assert "nan" in repr(failed)
