import numpy as np
import pytest

import metafem as mf
from metafem.files import PartOptions, part_notes, planned
from metafem.files.part.plan import FINE, MOST_BY_DEFAULT
from metafem.notes import Level


def lattice(rows, block=True):
    height = 0.084 + np.random.default_rng(0).uniform(0.0, 0.12, rows**2)
    side = 1.6 * rows
    return mf.Surface.square_lattice(
        height, (rows, rows), radius=0.526, material=mf.Material(1.36),
        block=mf.Block(side, side, 7.2) if block else None,
    )  # fmt: skip


def test_parts_of_few_asperities_are_as_fine_as_machining():
    part = planned(lattice(8), lattice(8), PartOptions())
    assert part.chord_error == pytest.approx(FINE * 0.526)
    assert part_notes(part) == ()


def test_parts_of_many_asperities_are_coarser_with_a_note():
    part = planned(lattice(100), lattice(100), PartOptions())
    assert 0.8 * MOST_BY_DEFAULT < part.triangles <= MOST_BY_DEFAULT
    # a cap of height h has about pi h/error triangles: 3.7 um here, where 3.0 would follow without rounding
    assert part.chord_error < 4e-3
    (note,) = part_notes(part)
    assert note.level is Level.INFORMATION
    assert "um below the spheres" in note.text


def test_the_size_is_known_before_the_part_is_made():
    part = planned(lattice(8), lattice(8), PartOptions(chord_error=1e-3, formats=("stl", "obj")))
    assert part.size() == (
        f"block.stl, mould.stl and block.obj, mould.obj: {part.triangles:,} triangles each, "
        f"{(84 + 50 * part.triangles) / 1e6:.3g} MB as STL, at most 1 um below the spheres"
    )


def test_without_a_block_no_part_is_made_and_a_note_states_it():
    surface = lattice(2, block=False)
    assert planned(surface, surface, PartOptions()) is None
    (note,) = part_notes(None)
    assert (note.level, note.text.partition(":")[0]) == (Level.INFORMATION, "no part was written")


def test_a_chord_error_of_gigabytes_is_refused():
    with pytest.raises(mf.InvalidInput, match=r"part\.chord_error = 0\.001 um needs .* triangles"):
        planned(lattice(8), lattice(8), PartOptions(chord_error=1e-6))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"chord_error": 0.0}, "chord_error"),
        ({"chord_error": float("nan")}, "chord_error"),
        ({"formats": "stl"}, "formats = 'stl' must be a list of stl, 3mf, obj"),
        ({"formats": ("step",)}, "formats"),
    ],
)
def test_options_are_checked(options, message):
    with pytest.raises(mf.InvalidInput, match=message):
        PartOptions(**options)
