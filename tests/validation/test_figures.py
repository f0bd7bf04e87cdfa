"""Figures of claims: axes without frames and with legends, and captions with numbers."""

import warnings
from functools import partial

import numpy as np

from validation.check import Picture
from validation.figures import panels


@panels(6.0, 3.0, columns=3, sharey=True)
def named(slope, first, second, third):
    """Lines of the slope {slope:g}.

    And an {{image}}
    of a mesh.
    """
    first.plot([0.0, 1.0], [0.0, slope], label="a line")
    second.errorbar([1.0], [1.0], [0.1], fmt="o")
    third.pcolormesh(np.eye(2), label="a mesh")


@panels(3.0, 2.0, rows=2)
def chosen(first, second):
    """Two lines."""
    for ax in (first, second):
        ax.plot([0.0, 1.0], label="a line")
    second.legend(["another"])


def test_lines_with_names_have_a_legend_unless_there_is_one():
    with warnings.catch_warnings(action="error"):
        figures = named(2.0), chosen()
    legends = [[ax.get_legend() for ax in figure.axes] for figure in figures]
    assert [[each is not None for each in one] for one in legends] == [[True, False, False], [False, True]]
    assert not any(ax.spines["top"].get_visible() for figure in figures for ax in figure.axes)


def test_the_caption_is_the_docstring_with_its_values():
    picture = Picture(partial(named, 2.0), {"slope": 2.0})
    assert picture.caption == "Lines of the slope 2.\n\nAnd an {image} of a mesh."
    assert tuple(picture.draw().get_size_inches()) == (6.0, 3.0)
