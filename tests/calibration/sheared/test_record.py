"""Records of shear tests with a known peak, a known plateau and frames at known instants."""

import numpy as np
import pytest

from metafem.calibration import shear_record
from metafem.errors import InvalidInput

# 0.1 mm/s, forces at 10 Hz: every 10 um, as in the paper.
X = np.linspace(0.0, 0.6, 61)


def force(x, peak=0.15, static=0.2, sliding=0.17):
    """Rise linearly to the peak, then fall to a plateau within 0.05 mm."""
    fallen = np.clip((x - peak) / 0.05, 0.0, 1.0)
    return np.where(x <= peak, static * x / peak, static + (sliding - static) * fallen)


def area(x, peak=0.15):
    """Fall with the square of the force to 85 %, then to 80 %."""
    return np.where(x <= peak, 0.5 - 0.075 * (x / peak) ** 2, np.maximum(0.425 - 0.5 * (x - peak), 0.4))


def test_peak_plateau_and_areas_of_an_exact_record():
    found = shear_record(X, force(X), area(X))
    assert (found.static_force, found.peak_displacement) == (pytest.approx(0.2), pytest.approx(0.15))
    assert found.sliding_force == pytest.approx(0.17)
    assert found.noise == pytest.approx(0.0, abs=1e-15)
    assert (found.area_before, found.static_area) == (0.5, pytest.approx(0.425))
    assert found.sliding_area == pytest.approx(0.4)
    assert found.notes == ()
    parts = area(X)[:, None] * np.array([0.3, 0.7])  # contacts are added
    assert shear_record(X, force(X), parts).static_area == pytest.approx(0.425)


def test_the_sliding_range_begins_and_ends_where_it_is_told():
    rising = force(X) + 0.05 * np.clip(X - 0.25, 0.0, None)
    found = shear_record(X, rising, sliding_range=(0.1, 0.2))
    assert found.sliding_force == pytest.approx(0.17 + 0.05 * 0.05)
    later = shear_record(X, rising, sliding_range=(0.2, 0.3))
    assert later.sliding_force == pytest.approx(0.17 + 0.05 * 0.15)


def test_areas_between_the_frames_are_not_needed():
    sparse = np.full_like(X, np.nan)
    sparse[::4] = area(X)[::4]  # no frame at the peak, entry 15
    found = shear_record(X, force(X), sparse)
    assert found.static_area == pytest.approx(0.25 * area(X)[12] + 0.75 * area(X)[16])
    assert found.sliding_area == pytest.approx(0.4)
    assert "interpolated between the frames at 0.12 and 0.16 mm" in str(found.notes[0])


def test_the_noise_is_that_of_the_plateau():
    rng = np.random.default_rng(0)
    x = np.linspace(0, 0.6, 6001)
    found = shear_record(x, force(x) + 1e-3 * rng.normal(size=6001))
    assert found.noise == pytest.approx(1e-3, rel=0.1)
    # the largest of many noisy values is above the peak by no more than is stated
    assert 0.2 < found.static_force < 0.2 + found.noise * np.sqrt(2.0 * np.log(6001))


def test_no_distinct_peak_and_a_first_frame_under_load_are_noted():
    flat = force(X, static=0.17) + 1e-3 * np.cos(50.0 * X)
    flat[20] = 0.1715
    assert "no distinct peak" in str(shear_record(X, flat).notes[0])
    late = area(X)
    late[:5] = np.nan
    found = shear_record(X, force(X), late)
    assert "first frame is 33 % of the peak" in str(found.notes[0])


def frames(*kept):
    """Return areas at some entries alone."""
    found = np.full_like(X, np.nan)
    found[list(kept)] = area(X)[list(kept)]
    return found


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((X[:31], force(X[:31])), "ends 0.15 after the peak at displacement 0.15; the sliding range needs"),
        ((X, X), "largest at the last entry .* no peak; shear farther"),
        ((X, 1.0 - X), "largest at the first entry"),
        ((X, -force(X)), "friction_force is at most -?0; forces that resist sliding are positive"),
        ((X[::-1], force(X)), r"displacement\[1\] = 0.59 is less than the one before"),
        ((X, force(X)[:9]), "friction_force has 9 numbers"),
        ((X, np.where(X == 0.3, np.nan, force(X))), "friction_force holds nan at entry 30"),
        ((X[::30], force(X[::30], peak=0.3)), "has 0 entries between 0.1 and 0.2"),
        ((X, force(X), area(X)[:9]), "area has 9 entries and displacement 61"),
        ((X, force(X), frames(0, 5, 10)), "no frame on both sides of the peak"),
        ((X, force(X), frames(0, 15, 50)), "no frame in sliding_range"),
    ],
)
def test_bad_records_are_named(arguments, message):
    with pytest.raises(InvalidInput, match=message):
        shear_record(*arguments)


@pytest.mark.parametrize("ends", [(0.2, 0.1), (-0.1, 0.2), (0.1, 0.1)])
def test_the_sliding_range_must_increase(ends):
    with pytest.raises(InvalidInput, match=r"sliding_range = .* must increase"):
        shear_record(X, force(X), sliding_range=ends)
