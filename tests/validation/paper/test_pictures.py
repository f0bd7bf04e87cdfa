"""Surfaces have the colours of their names, and those that are compared the same axes."""

import pytest

from metafem.drawing import ACHIEVED, TARGET
from validation.paper import fig4_linear, fig5_bilinear
from validation.paper.pictures import INKS

FIGURES = {"Fig. 4": fig4_linear, "Fig. 5": fig5_bilinear}


@pytest.mark.parametrize("figure", FIGURES)
def test_laws_have_the_colour_of_their_surface_and_common_axes(figure):
    limits = []
    for colour in ("blue", "red"):
        axes = FIGURES[figure]._figure(colour).axes
        limits.append([(ax.get_xlim(), ax.get_ylim()) for ax in axes])
        colours = [line.get_color() for ax in axes for line in ax.lines]
        assert axes[0].lines[0].get_color() == INKS[f"{figure} {colour}"]
        assert not {ACHIEVED, TARGET} & set(colours)
    assert limits[0] == limits[1]
