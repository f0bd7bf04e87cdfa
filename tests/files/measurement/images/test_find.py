import tracemalloc
from contextlib import suppress

import numpy as np
import pytest
import tifffile
from PIL import Image

from metafem.errors import InvalidInput
from metafem.files.measurement.images.find import Images, find_images, natural, read_image
from metafem.progress import listening


def names(*sources):
    return [image.name for image in find_images(sources)]


def only(path):
    (image,) = find_images([path])
    return image


def test_natural_order():
    assert sorted(["a10", "a2", "A1", "b", "a", "a02x"], key=natural) == ["a", "A1", "a2", "a02x", "a10", "b"]
    assert sorted(["10.tif", "9.tif", "x.tif"], key=natural) == ["9.tif", "10.tif", "x.tif"]


def test_a_folder_in_natural_order(tmp_path, grey):
    for name in ("10.tif", "2.TIFF", "1.png", "._1.png"):
        Image.fromarray(grey[0]).save(tmp_path / name, format="PNG" if "png" in name else "TIFF")
    (tmp_path / "notes.txt").write_text("not an image")
    (tmp_path / "3.jpg").write_bytes(b"x")
    heard = []
    with listening(lambda step, done: None, heard.append):
        assert names(tmp_path) == ["1.png", "2.TIFF", "10.tif"]
    assert heard == [f"{tmp_path}: not read, because they are no TIFF or PNG: 3.jpg"]
    assert names(tmp_path / "10.tif", tmp_path) == ["10.tif", "1.png", "2.TIFF"]


def test_a_file_that_is_named_twice_is_read_once(tmp_path, grey, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("1.png", "2.png"):
        Image.fromarray(grey[0]).save(tmp_path / name)
    assert names(tmp_path / "2.png", ".", "1.png", tmp_path) == ["2.png", "1.png"]


def test_files_of_one_name_are_named_with_their_folders(tmp_path, grey):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        Image.fromarray(grey[0]).save(tmp_path / folder / "1.png")
    assert names(tmp_path / "a", tmp_path / "b") == [str(tmp_path / f / "1.png") for f in ("a", "b")]


@pytest.mark.parametrize("options", [
    {}, {"imagej": True, "metadata": {"axes": "ZYX"}}, {"ome": True}, {"compression": "zlib"},
    {"bigtiff": True}, {"byteorder": ">"},
])  # fmt: skip
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_pages_of_a_stack(tmp_path, grey, options, dtype):
    if "ome" in options:
        options = {"metadata": {"axes": "ZYX"}}
        path = tmp_path / "stack.ome.tif"
    else:
        path = tmp_path / "stack.tif"
    tifffile.imwrite(path, grey.astype(dtype), **options)
    images = find_images([path])
    assert [image.name for image in images] == [f"{path.name}:{i}" for i in range(1, 6)]
    stack = Images(images)
    assert len(stack) == 5
    for i in (3, 0, 4):  # in any order
        np.testing.assert_array_equal(stack[i], grey[i])
        assert stack[i].dtype == dtype
    assert len(stack[1:3]) == 2


def test_a_stack_with_the_tags_of_its_first_page_alone(tmp_path, grey):
    path = tmp_path / "joined.tif"
    with tifffile.TiffWriter(path, imagej=True) as file:
        file.write(grey.astype(np.uint16), contiguous=True, truncate=True)
    stack = Images(find_images([path]))
    assert len(stack) == 5
    for i in range(5):
        np.testing.assert_array_equal(stack[i], grey[i])


def test_white_may_be_zero(tmp_path, grey):
    path = tmp_path / "white.tif"
    tifffile.imwrite(path, grey[0], photometric="miniswhite")
    np.testing.assert_array_equal(read_image(only(path))[0], 255 - grey[0])


@pytest.mark.parametrize("mode", ["L", "LA", "RGB", "RGBA", "P"])
@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_grey_levels_stored_in_colour(tmp_path, grey, mode, suffix):
    path = tmp_path / f"image.{suffix}"
    image = Image.fromarray(grey[0])
    image = image.convert("RGB").quantize(256, dither=0) if mode == "P" else image.convert(mode)
    image.save(path)
    values, coloured = read_image(only(path))
    assert not coloured
    found = values.astype(float) * (255.0 / 65535.0 if values.dtype == np.uint16 else 1.0)
    # quantisation to a palette may merge neighbouring levels
    np.testing.assert_allclose(found, grey[0], atol=4.0 if mode == "P" else 0.0)


def test_colours_become_their_luminance(tmp_path, grey):
    path = tmp_path / "image.png"
    colours = np.stack([grey[0], grey[1], grey[2]], axis=-1)
    Image.fromarray(colours).save(path)
    stack = Images([only(path)])
    expected = 0.2126 * colours[..., 0] + 0.7152 * colours[..., 1] + 0.0722 * colours[..., 2]
    np.testing.assert_allclose(stack[0], expected, atol=0.5)
    assert list(stack.coloured) == ["image.png"]


def test_compressions_that_tifffile_does_not_read(tmp_path, grey):
    path = tmp_path / "lzw.tif"
    first, *others = (Image.fromarray(page) for page in grey)
    first.save(path, compression="tiff_lzw", save_all=True, append_images=others)
    stack = Images(find_images([path]))
    for i in range(5):
        np.testing.assert_array_equal(stack[i], grey[i])


def test_16_bits_of_png(tmp_path, grey):
    path = tmp_path / "deep.png"
    deep = grey[0].astype(np.uint16) * 257
    Image.fromarray(deep).save(path)
    np.testing.assert_array_equal(read_image(only(path))[0], deep)


@pytest.mark.parametrize(("name", "kept", "message"), [
    ("plain.tif", 0.97, "plain.tif: is cut off: the file ends before the last row"),
    ("zlib.tif", 0.9, "zlib.tif: is cut off"),
    ("plain.tif", 0.001, "plain.tif: cannot be read"),
    ("plain.tif", 0.0, "plain.tif: cannot be read: it is no TIFF file, or damaged"),
    ("image.png", 0.5, "image.png: cannot be read: image file is truncated"),
    ("image.png", 0.0, "image.png: cannot be read: it is no image, or damaged"),
])  # fmt: skip
def test_truncated_files_are_named(tmp_path, grey, name, kept, message):
    path = tmp_path / name
    if name.endswith("png"):
        Image.fromarray(grey[0]).save(path)
    else:
        tifffile.imwrite(path, grey[0], compression="zlib" if "zlib" in name else None)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    with pytest.raises(InvalidInput) as caught:
        read_image(only(path))
    assert str(caught.value).startswith(message)


def test_the_whole_part_of_a_truncated_stack_is_read(tmp_path, grey):
    path = tmp_path / "stack.tif"
    with tifffile.TiffWriter(path) as file:
        for page in grey:
            file.write(page, contiguous=False)
    content = path.read_bytes()
    path.write_bytes(content[: int(0.55 * len(content))])
    images = find_images([path])
    assert [image.name for image in images][:2] == ["stack.tif:1", "stack.tif:2"]
    np.testing.assert_array_equal(read_image(images[1])[0], grey[1])
    with pytest.raises(InvalidInput, match=r"stack\.tif:\d: is (damaged or )?cut off"):
        read_image(images[-1])


def test_random_bytes_end_with_an_error_or_an_image(tmp_path, grey):
    path = tmp_path / "stack.tif"
    tifffile.imwrite(path, grey[:2, :20, :20])
    content, rng = bytearray(path.read_bytes()), np.random.default_rng(1)
    for _ in range(40):
        damaged = bytearray(content)
        for at in rng.integers(0, 400, 3):
            damaged[at] = rng.integers(256)
        path.write_bytes(damaged)
        for image in find_images([path]):
            with suppress(InvalidInput):
                assert read_image(image)[0].ndim == 2


@pytest.mark.parametrize(("write", "message"), [
    (lambda path, grey: Image.fromarray(grey > 99).save(path), "is black and white"),
    (lambda path, grey: Image.fromarray(grey).convert("CMYK").save(path), "is stored as SEPARATED"),
    (lambda path, grey: tifffile.imwrite(path, np.dstack([grey] * 7), planarconfig="contig"), "7 channels"),
])  # fmt: skip
def test_what_has_no_grey_levels_is_refused(tmp_path, grey, write, message):
    path = tmp_path / "image.tif"
    write(path, grey[0])
    with pytest.raises(InvalidInput, match=message):
        read_image(only(path))


@pytest.mark.parametrize(("name", "message"), [
    ("empty", "holds no TIFF or PNG image"),
    ("image.jpg", "no image that can be read; save it as TIFF or PNG; JPEG changes"),
    ("missing.tif", "no such file or folder"),
    ("missing", "missing: no such file or folder"),
    ("table.csv", "no image that can be read"),
])  # fmt: skip
def test_names_that_are_no_images(tmp_path, name, message):
    (tmp_path / "empty").mkdir()
    for other in ("image.jpg", "table.csv"):
        (tmp_path / other).write_bytes(b"")
    with pytest.raises(InvalidInput, match=message):
        find_images([tmp_path / name])


def test_images_are_read_one_by_one(tmp_path):
    path = tmp_path / "large.tif"
    tifffile.imwrite(path, np.zeros((20, 500, 500), dtype=np.uint16))
    stack = Images(find_images([path]))
    assert len(stack) == 20
    stack[0]
    tracemalloc.start()
    for image in stack:
        assert image.shape == (500, 500)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 3 * stack[0].nbytes + 10**6  # and what tifffile keeps of the tags


def test_one_page_of_a_stack_is_read_without_the_tags_of_the_others(tmp_path, grey, monkeypatch):
    with tifffile.TiffWriter(tmp_path / "stack.tif") as file:
        for picture in grey:
            file.write(picture, contiguous=False)
            file.write(picture[::4, ::4], contiguous=False, subfiletype=1)  # a reduced copy
    images = find_images([tmp_path])
    assert [image.name for image in images] == [f"stack.tif:{i}" for i in range(1, 6)]
    parsed = []
    original = tifffile.TiffPage.__init__

    def counted(page, parent, index, **given):
        parsed.append(index)
        original(page, parent, index, **given)

    monkeypatch.setattr(tifffile.TiffPage, "__init__", counted)
    values, _ = read_image(images[3])
    np.testing.assert_array_equal(values, grey[3])
    assert parsed == [0, 6]
