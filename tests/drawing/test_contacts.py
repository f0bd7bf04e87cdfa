import numpy as np
import pytest

from metafem import drawing
from metafem.drawing import contacts


@pytest.fixture
def ax():
    return drawing.new_figure(5.0, 4.0).add_subplot()


@pytest.mark.parametrize("shape", [(40, 60), (2001, 3500)])
def test_an_image_lies_in_its_frame(ax, shape):
    """Its mean grey levels stand where the pixels are, from the lower left corner of the frame."""
    image = np.zeros(shape)
    image[: shape[0] // 2] = 1.0  # the upper half is bright
    contacts.picture(ax, image, 0.01)
    (drawn,) = ax.images
    left, right, low, high = drawn.get_extent()
    values = np.asarray(drawn.get_array())
    assert values[0, 0] == 1.0
    assert values[-1, 0] == 0.0
    assert (left, high) == pytest.approx((0.0, 0.01 * shape[0]))
    assert (high - low) / values.shape[0] == pytest.approx((right - left) / values.shape[1])
    assert (0.01 * shape[1] - right, low) == pytest.approx((0.0, 0.0), abs=0.03)
    assert max(values.shape) <= contacts.MOST_DRAWN
    assert ax.get_xlim() == (0.0, 0.01 * shape[1])


def test_outlines_are_ellipses_to_scale(ax):
    centre, axes = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[0.3, 0.2], [0.1, 0.1]])
    contacts.outlines(ax, centre, axes, np.array([0.5, 0.0]), contacts.MEASURED, "measured")
    (drawn,) = ax.collections
    np.testing.assert_array_equal(drawn.get_offsets(), centre)
    np.testing.assert_allclose(drawn.get_widths(), 2.0 * axes[:, 0])
    np.testing.assert_allclose(drawn.get_angles(), np.degrees([0.5, 0.0]))
    contacts.crosses(ax, centre, "open")
    contacts.numbers(ax, centre, ["7", "8"], contacts.OPEN)
    contacts.heading(ax, "1.tif")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["2 measured", "2 open"]
    assert [text.get_text() for text in ax.texts] == ["7", "8"]
    contacts.outlines(ax, centre[:0], axes[:0], np.zeros(0), contacts.STRAY, "of no site")
    assert len(ax.collections) == 1


def test_an_image_without_contacts_has_no_legend(ax):
    contacts.heading(ax, "1.tif")  # matplotlib warns of an empty legend
    assert ax.get_legend() is None
    assert ax.get_title(loc="left") == "1.tif"
