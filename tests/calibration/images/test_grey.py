"""Grey values of images in many types, and their ends of the scale."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration.images.grey import clipped, grey_values

IMAGE = np.arange(400).reshape(20, 20)


@pytest.mark.parametrize(
    "image",
    [
        IMAGE,
        IMAGE.tolist(),
        IMAGE.astype(np.uint16),
        IMAGE.astype(np.float32),
        IMAGE[..., None],
        np.repeat(IMAGE[..., None], 3, axis=2),
        np.concatenate([np.repeat(IMAGE[..., None], 3, axis=2), np.full((20, 20, 1), 255)], axis=2),
        np.ma.masked_array(IMAGE, mask=False),
    ],
)
def test_grey_values_of_any_type(image):
    assert np.array_equal(grey_values(image), IMAGE)


def test_masked_pixels_and_huge_values_are_refused():
    with pytest.raises(mf.InvalidInput, match="without mask"):
        grey_values(np.ma.masked_equal(IMAGE, 7))
    with pytest.raises(mf.InvalidInput, match="too large"):
        grey_values(IMAGE * 1e36)


@pytest.mark.parametrize(
    ("largest", "kind", "full"),
    [(255, np.uint8, True), (4095, np.uint16, True), (4000, np.uint16, False), (255.0, np.float64, False)],
)
def test_pixels_at_the_ends_of_the_scale(largest, kind, full):
    image = np.linspace(0, largest, 400).reshape(20, 20).astype(kind)
    low, high = clipped(image)
    assert (high is not None) == full
    assert (low is not None) == np.issubdtype(kind, np.integer)
    if full:
        assert high.sum() == (image == largest).sum()
