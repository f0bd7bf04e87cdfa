import numpy as np
import pytest
import tifffile
from PIL import Image

from metafem.errors import InvalidInput
from metafem.files.measurement.images.find import find_images
from metafem.files.measurement.images.pixel_size import pixel_size

PIXEL = 5.3e-3


def tiff(path, grey, **options):
    tifffile.imwrite(path, grey, **options)
    return find_images([path])


@pytest.mark.parametrize("options", [
    {"resolution": (1 / PIXEL, 1 / PIXEL), "resolutionunit": "MILLIMETER"},
    {"resolution": (10 / PIXEL, 10 / PIXEL), "resolutionunit": "CENTIMETER"},
    {"resolution": (25.4 / PIXEL, 25.4 / PIXEL), "resolutionunit": "INCH"},
    {"imagej": True, "resolution": (1 / 5.3, 1 / 5.3), "metadata": {"unit": "um"}},
    {"imagej": True, "resolution": (1 / 5.3, 1 / 5.3), "metadata": {"unit": "micron"}},
    {"imagej": True, "resolution": (1 / PIXEL, 1 / PIXEL), "metadata": {"unit": "mm"}},
    {"ome": True, "metadata": {"PhysicalSizeX": 5.3, "PhysicalSizeY": 5.3}},
    {"ome": True, "metadata": {"PhysicalSizeX": 5300.0, "PhysicalSizeXUnit": "nm", "PhysicalSizeY": 5.3}},
])  # fmt: skip
def test_the_size_that_a_file_states(tmp_path, grey, options):
    if options.get("resolutionunit") == "MILLIMETER":  # not a unit of the tag
        options = {"resolution": (10 / PIXEL, 10 / PIXEL), "resolutionunit": 3}
    size, notes = pixel_size(tiff(tmp_path / "1.tif", grey[0], **options))
    # the tags are ratios of two integers of 32 bits
    assert size == pytest.approx(PIXEL, rel=1e-5)
    assert str(notes[0]).startswith("pixels of 5.3 um, as 1.tif states by")


def test_the_size_that_a_png_states(tmp_path, grey):
    Image.fromarray(grey[0]).save(tmp_path / "1.png", dpi=(25.4 / PIXEL, 25.4 / PIXEL))
    size, _ = pixel_size(find_images([tmp_path / "1.png"]))
    assert size == pytest.approx(PIXEL, rel=1e-4)  # whole pixels per metre


@pytest.mark.parametrize("options", [
    {},
    {"resolution": (72, 72), "resolutionunit": "INCH"},
    {"resolution": (1 / 5.3, 1 / 5.3), "resolutionunit": "NONE"},
    {"imagej": True, "resolution": (1.0, 1.0), "metadata": {"unit": "pixel"}},
    {"ome": True},
])  # fmt: skip
def test_pixels_are_never_lengths_by_themselves(tmp_path, grey, options):
    images = tiff(tmp_path / "1.tif", grey[0], **options)
    with pytest.raises(InvalidInput, match=r'1\.tif states no size of the pixels; .*--pixel "5\.3 um"'):
        pixel_size(images)
    assert pixel_size(images, PIXEL) == (PIXEL, [])


def test_a_given_size_that_differs_is_used_with_a_warning(tmp_path, grey):
    images = tiff(tmp_path / "1.tif", grey[0], resolution=(10 / PIXEL, 10 / PIXEL), resolutionunit=3)
    assert pixel_size(images, PIXEL * 1.0001) == (PIXEL * 1.0001, [])
    size, (note,) = pixel_size(images, 0.01)
    assert size == 0.01
    assert note.warns
    assert str(note) == (
        "1.tif states pixels of 5.3 um by its resolution tags, and --pixel 10 um is used: areas change by "
        "+256 %"
    )


def test_images_that_differ_and_oblong_pixels(tmp_path, grey):
    first = tiff(tmp_path / "1.tif", grey[0], resolution=(10 / PIXEL, 10 / PIXEL), resolutionunit=3)
    second = tiff(tmp_path / "2.tif", grey[0], resolution=(1000, 1000), resolutionunit=3)
    with pytest.raises(InvalidInput, match=r"1\.tif states pixels of 5\.3 um, and 2\.tif of 10 um"):
        pixel_size([*first, *second])
    oblong = tiff(tmp_path / "3.tif", grey[0], resolution=(1000, 2000), resolutionunit=3)
    with pytest.raises(InvalidInput, match=r"3\.tif states oblong pixels, 10 um x 5 um, by its resolution"):
        pixel_size(oblong)
    _, (note,) = pixel_size(oblong, 0.01)
    assert "pixels of 10 um x 5 um" in str(note)


def test_no_image_can_be_read(tmp_path):
    (tmp_path / "1.tif").write_bytes(b"")
    with pytest.raises(InvalidInput, match=r"none of the images can be read: 1\.tif: cannot be read"):
        pixel_size(find_images([tmp_path]))


def test_broken_images_need_no_size(tmp_path, grey):
    (tmp_path / "1.tif").write_bytes(b"")
    np.testing.assert_allclose(
        pixel_size([*find_images([tmp_path]), *tiff(tmp_path / "2.tif", grey[0])], 0.1)[0], 0.1
    )
