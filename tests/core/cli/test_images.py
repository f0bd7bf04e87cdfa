"""`metafem images` on synthetic pictures of a lattice of 9 contacts."""

from pathlib import Path

import numpy as np
import pytest
import tifffile

from metafem.calibration.contact_table import by_image
from metafem.files import read_contacts
from validation.scenes.lattice_views import lattice, seen
from validation.scenes.pictures import picture

PIXEL = 0.02
SITES = lattice((3, 3))
RADIUS = np.array([0.30, 0.28, 0.36, 0.32, 0.26, 0.34, 0.22, 0.40, 0.24])
LOADS = (10, 20, 40)


def radii(number):
    """Return the radii [mm] in one image; all contacts are closed in the last."""
    return np.maximum(RADIUS - 0.08 * (2 - number), 0.0) * ((0.31, 0.25, 0.2)[number] < RADIUS)


def shot(number, ratio=1.0, mirrored=False, shift=0.0):
    """Return one image of 8 bits."""
    closed = radii(number) > 0.0
    centre = seen(SITES, turn=0.03, shift=(2.3 + shift, 2.2), mirrored=mirrored)[closed]
    axes = np.column_stack([ratio * radii(number), radii(number)])[closed]
    return picture((220, 230), centre / PIXEL, axes / PIXEL, 0.0, noise=0.02, bits=8, rng=number)


@pytest.fixture
def pictures(tmp_path):
    """Write images of a loading, each before shear and at its peak, the forces and the heights."""
    folder = tmp_path / "pictures"
    folder.mkdir()
    lines = ["image,load_mN,friction_force_mN,sheared_image"]
    for i, load in enumerate(LOADS):
        # 9, 10, 11: in natural order
        for name, image in ((f"{9 + i}.tif", shot(i)), (f"s{9 + i}.tif", shot(i, 0.85, shift=0.1))):
            tifffile.imwrite(folder / name, image)
        lines.append(f"{9 + i}.tif,{load},{2 * load},s{9 + i}.tif")
    (tmp_path / "forces.csv").write_text("\n".join(lines), encoding="utf-8")
    rows = "\n".join(f"{i},{x},{y},0.1" for i, (x, y) in enumerate(SITES, 1))
    (tmp_path / "heights.csv").write_text(f"site,x_mm,y_mm,height_mm\n{rows}\n", encoding="utf-8")
    return folder


def test_images_become_a_table_of_contacts(run, pictures):
    arguments = ("images", "pictures", "--pixel", "20 um", "--forces", "forces.csv", "--sites", "heights.csv")
    text = run(*arguments, "-o", "contacts.csv", "--picture", "found.png").told
    table = read_contacts("contacts.csv")
    images, areas = by_image(table)
    assert images["image"].tolist() == ["9.tif", "10.tif", "11.tif"]
    assert images["load"].tolist() == [0.01, 0.02, 0.04]
    assert images["friction_force"].tolist() == [0.02, 0.04, 0.08]
    assert table["site"].notna().all()
    exact = np.pi * np.array([radii(i) for i in range(3)]) ** 2
    # contacts of a few pixels, 0.02 of noise
    np.testing.assert_allclose(areas["area"], exact, rtol=0.02)
    np.testing.assert_allclose(areas["sheared_area"], 0.85 * exact, rtol=0.02)
    assert "11.tif 9 glass 1.7" in " ".join(text.split())
    assert text.endswith("wrote contacts.csv wrote found.png")
    assert Path("found.png").read_bytes().startswith(b"\x89PNG")
    # the error of a sum is that of the closed contacts
    rows = run(*arguments, "--json").data["images"]
    pairs = zip(areas["area_error"], areas["area"], strict=True)
    errors = [np.sqrt(np.sum(error[area > 0.0] ** 2)) for error, area in pairs]
    np.testing.assert_allclose([row["area_error_mm2"] for row in rows], errors, rtol=1e-6)
    assert rows[0]["open"] > 0


def test_through_the_block(run, pictures):
    for i in range(3):
        tifffile.imwrite(pictures / f"{9 + i}.tif", shot(i, mirrored=True))
    arguments = ["images", *(f"pictures/{9 + i}.tif" for i in range(3)), "--pixel", "20 um"]
    arguments += ["--sites", "heights.csv", "--viewed-from", "block", "--json"]
    data = run(*arguments).data
    assert data["match"]["viewed_from"] == "block"
    assert data["images"][2]["area_mm2"] == pytest.approx(np.pi * (radii(2) ** 2).sum(), rel=0.02)
    assert data["images"][0]["load_N"] is None


def test_a_broken_image_is_named_and_the_others_are_measured(run, pictures):
    whole = (pictures / "10.tif").read_bytes()
    (pictures / "10.tif").write_bytes(whole[: len(whole) // 2])
    arguments = ("images", "pictures", "--forces", "forces.csv", "--pixel", "20 um")
    assert (
        "10.tif is not measured: 10.tif cannot be read"
        in run(*arguments, "-o", "contacts.csv").ended(1).words
    )
    images, areas = by_image(read_contacts("contacts.csv"))
    assert np.isnan(areas["area"][1]).all()
    assert images["load"][1] == 0.02
    assert np.isfinite(areas["area"][[0, 2]]).all()
    # its image under shear is measured
    assert np.nansum(areas["sheared_area"][1]) > 0.0
    assert run(*arguments, "--json").missed["failed"] == ["10.tif"]


@pytest.mark.slow
def test_a_stack_without_forces(run, tmp_path):
    tifffile.imwrite(tmp_path / "stack.tif", np.stack([shot(i) for i in range(3)]), photometric="minisblack")
    picture = ("--picture", "one.svg")
    text = run("images", "stack.tif", "--pixel", "20 um", *picture).told
    assert "stack.tif:3 9" in " ".join(text.split())
    assert "stack.tif:3" in Path("one.svg").read_text(encoding="utf-8")
