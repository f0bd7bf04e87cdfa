"""Drawings of fits with error bars and residuals."""

import numpy as np
import pytest

from metafem.drawing.calibration import fitted, measured, residuals, with_residuals


@pytest.mark.parametrize("columns", [1, 3])
def test_each_fit_has_its_residuals_below(columns):
    x = np.arange(1.0, 5.0)
    figure, places = with_residuals(columns)
    assert len(places) == columns
    assert len(figure.axes) == 2 * columns
    for law, below in places:
        measured(law, x, 2.0 * x, 0.1 * x, 0.2 * x, "points")
        fitted(law, x, 2.0 * x, "law")
        residuals(below, x, np.array([0.5, -1.0, 2.5, 0.0]))
        bars = law.containers[0].lines[2]
        assert len(bars) == 2  # along both axes
        assert [text.get_text() for text in law.legend().get_texts()] == ["law", "points"]
        assert below.lines[-1].get_ydata().max() == 2.5
        assert law.get_shared_x_axes().joined(law, below)
    assert figure.get_size_inches()[0] == pytest.approx(4.6 * columns)
