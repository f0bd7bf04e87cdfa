"""What figures show, and where: data on axes, and pictures in pages."""

import numpy as np
import pytest

import metafem as mf
from metafem import drawing
from metafem.drawing import calibration, contacts
from metafem.drawing.inline import drawn, themed

X = np.array([1.0, 2.0, 4.0])
PLACES = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]])


@pytest.fixture
def ax():
    return drawing.new_figure(5.0, 4.0).add_subplot()


def points(line):
    return np.column_stack(line.get_data()).tolist()


def labels(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def names(ax):
    return ax.get_xlabel(), ax.get_ylabel()


def bars(container):
    """Return the ends of error bars along x and y, or along y alone, (n, 2) each."""
    ends = container.lines[2]
    return [
        np.array(each.get_segments())[:, :, k] for k, each in zip((0, 1)[-len(ends) :], ends, strict=True)
    ]


def test_a_surface_is_drawn_at_its_places_and_heights(rough, ax):
    assert rough.plot(ax) is ax
    dots = ax.collections[0]
    np.testing.assert_array_equal(dots.get_offsets(), rough.position)
    np.testing.assert_allclose(dots.get_array(), 1e3 * rough.height, rtol=1e-15)
    np.testing.assert_allclose(dots.get_widths(), 0.8 * drawing.spacing(rough.position), rtol=1e-12)
    assert (ax.get_legend(), ax.get_aspect(), names(ax)) == (None, 1.0, ("x [mm]", "y [mm]"))
    (edge,) = ax.patches  # of the block
    assert (*edge.get_xy(), edge.get_width(), edge.get_height()) == (-10.0, -10.0, 20.0, 20.0)
    two = drawing.new_figure(5.0, 4.0).add_subplot()
    rough.replaced(radius=np.where(np.arange(64) % 2, 0.3, 0.6)).plot(two)
    size = two.collections[0].get_widths()
    assert size[1] / size[0] == pytest.approx(0.5, rel=1e-12)
    assert two.figure.axes[1].get_ylabel().endswith("R = 300 to 600 µm")
    assert drawing.spacing(PLACES) == pytest.approx(np.sqrt(3.0 / 4.0))
    assert (drawing.spacing(PLACES[:2]), drawing.spacing(PLACES[:1])) == (1.5, 1.0)


def test_a_law_is_drawn_rescaled_or_in_newtons(template, ax):
    law = mf.friction_law(template, load=[0.1, 0.2])
    law.plot(ax, label="rescaled")
    assert points(ax.lines[0]) == [[0.0, 0.0], *map(list, zip(law.rescaled_load, law.area, strict=True))]
    assert names(ax) == ("rescaled load  P/E* [mm²]", "rescaled friction  F/(σB) [mm²]")
    law.plot(ax, units="N")
    assert points(ax.lines[1]) == [[0.0, 0.0], *map(list, zip(law.load, law.friction_force, strict=True))]
    assert names(ax) == ("load  P [N]", "friction force  F [N]")
    bare = mf.friction_law(template.replaced(friction=None), load=[0.1])
    for wrong, units, value in ((bare, "N", "friction_force"), (law, "kN", "'kN'")):
        with pytest.raises(mf.InvalidInput, match=value):
            wrong.plot(ax, units=units)
    assert len(ax.lines) == 2


@pytest.mark.parametrize(("target", "words"), [
    (mf.OperatingPoints([0.1, 0.2, 0.4], [0.8, 1.5, 2.9]), ["achieved", "target"]),
    (mf.LinearLaw(7.5, load_range=(0.02, 0.1)), ["achieved", "target"]),
    (mf.LinearLaw(6.87), ["achieved", "law of the height density", "target slope"]),
], ids=["points", "line", "density"])  # fmt: skip
def test_a_design_is_drawn_beside_its_target(target, words, template, ax):
    design = mf.design(target, template, limits=mf.Limits(0.16, offset=0.084))
    assert design.plot(ax) is ax
    assert [label.split(",")[0] for label in labels(ax)] == words
    np.testing.assert_array_equal(ax.lines[0].get_ydata()[1:], design.law.area)
    np.testing.assert_array_equal(ax.lines[1].get_xdata(), design.target_law.load)
    difference = design.target_law.difference(design.target_area)
    if target != mf.LinearLaw(6.87):
        np.testing.assert_allclose(
            ax.lines[1].get_ydata() * (1.0 + difference), design.target_area, rtol=1e-9
        )


def test_marks_and_grids_are_drawn_to_scale(ax):
    drawing.rings(ax, PLACES, 0.5)
    (rings,) = ax.collections
    assert (rings.get_widths().tolist(), rings.get_facecolor().size) == ([0.5] * 4, 0)
    drawing.grids(ax, np.array([[1.0, 2.0]]), 0.5, [np.array([[0.0, 3.0], [1.0, 2.0], [4.0, 0.0]])], "p")
    (image,) = ax.images
    assert (image.get_extent(), image.get_clim()) == ([0.75, 2.25, 1.75, 2.75], (0.0, 4.0))
    assert image.get_array().tolist() == [[None, 1.0, 4.0], [3.0, 2.0, None]]
    forth, back = drawing.scaling(4.0)
    assert (forth(0.5), back(2.0)) == (2.0, 0.5)
    place = drawing.new_figure(10.0, 5.0, (1.0, 2.0, 0.5, 1.5)).subplotpars
    assert (place.left, place.right, place.bottom, place.top) == pytest.approx((0.1, 0.8, 0.1, 0.7))


def test_an_image_lies_in_its_frame():
    for rows, columns in ((40, 60), (2001, 3500)):
        image = np.zeros((rows, columns))
        image[: rows // 2] = 1.0  # the upper half is bright
        ax = contacts.picture_figure(columns, rows).add_subplot()
        contacts.picture(ax, image, 0.01)
        (shown,) = ax.images
        left, right, low, high = shown.get_extent()
        values = np.asarray(shown.get_array())
        assert (values[0, 0], values[-1, 0], ax.get_xlim()) == (1.0, 0.0, (0.0, 0.01 * columns))
        assert (left, high) == pytest.approx((0.0, 0.01 * rows))
        assert (right, low) == pytest.approx((0.01 * columns, 0.0), abs=0.03)
        assert (high - low) / values.shape[0] == pytest.approx((right - left) / values.shape[1])
        assert max(values.shape) <= 1600
        np.testing.assert_allclose(ax.figure.get_size_inches(), (8.0, 8.0 * rows / columns + 0.7))


def test_contacts_are_ellipses_to_scale(ax):
    contacts.heading(ax, "1.tif")  # matplotlib warns of an empty legend
    assert (ax.get_legend(), ax.get_title(loc="left")) == (None, "1.tif")
    centre, axes = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[0.3, 0.2], [0.1, 0.1]])
    contacts.outlines(ax, centre, axes, np.array([0.5, 0.0]), contacts.COLOURS["measured"], "measured")
    (shown,) = ax.collections
    np.testing.assert_array_equal(shown.get_offsets(), centre)
    np.testing.assert_allclose(shown.get_widths(), 2.0 * axes[:, 0])
    np.testing.assert_allclose(shown.get_heights(), 2.0 * axes[:, 1])
    np.testing.assert_allclose(shown.get_angles(), np.degrees([0.5, 0.0]))
    contacts.crosses(ax, centre, "open")
    contacts.numbers(ax, centre, ["7", "8"], contacts.OPEN)
    contacts.heading(ax, "1.tif")
    assert (labels(ax), points(ax.lines[-1])) == (["2 measured", "2 open"], centre.tolist())
    assert [(text.get_text(), text.xy) for text in ax.texts] == [("7", (1.0, 2.0)), ("8", (3.0, 4.0))]
    contacts.outlines(ax, centre[:0], axes[:0], np.zeros(0), contacts.COLOURS["of no site"], "of no site")
    contacts.crosses(ax, centre[:0], "open")
    assert (len(ax.collections), len(ax.lines)) == (1, 2)


def test_measured_points_have_their_bars(ax):
    calibration.measured(ax, X, 2.0 * X, 0.1 * X, 0.2 * X, "points")
    across, up = bars(ax.containers[0])
    np.testing.assert_allclose(across, np.column_stack([0.9 * X, 1.1 * X]))
    np.testing.assert_allclose(up, np.column_stack([1.8 * X, 2.2 * X]))
    calibration.residuals(ax, X, X - 2.0)
    assert points(ax.lines[-1]) == np.column_stack([X, X - 2.0]).tolist()


def test_pictures_of_pages_are_equal_small_and_in_the_colours_of_the_page(ax):
    ax.plot([0.0, 1.0 / 3.0], [1.0, 2.0], "o-", color=drawing.ACHIEVED, label='a "name" at 1.23456 & #5')
    drawing.finished(ax.figure)
    assert not ax.spines["top"].get_visible()
    plain = drawing.svg(ax.figure, "heights & <places>")
    assert plain == drawing.svg(ax.figure, "heights & <places>")
    assert plain.startswith("<svg")
    assert "<title>heights &amp; &lt;places&gt;</title>" in plain
    text = themed(plain)
    assert len(text) < 0.9 * len(plain)
    assert "at 1.23456 &amp; #5" in text  # digits of words stay
    assert text.count("<use") == plain.count("<use") > 0
    for reference in {part.split('"')[0] for part in text.split('href="#')[1:]}:
        assert f'id="{reference}"' in text
    for colour, name in (("#000000", "--ink"), ("#ffffff", "--paper"), (drawing.ACHIEVED, "--achieved")):
        assert 0 < text.count(colour) == text.count(f"var({name}, {colour})")
    assert drawn(ax.figure, "A law: µ / 2", "See").caption == "See"


def test_no_picture_hangs_on_the_last_digits_of_its_data():
    def picture(factor):
        ax = drawing.new_figure(5.0, 4.0, drawing.MARGINS).add_subplot()
        ax.plot(factor * X, factor * X**1.3, "o-")
        ax.set_xlim(0.0, 1.08 * factor * X[-1])
        return themed(drawing.svg(ax.figure, "law"))

    assert {picture(1.0 + k * 1e-9) for k in range(6)} == {picture(1.0)}


def test_without_axes_pyplot_shows_the_picture(template):
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    figure = template.plot().figure
    assert set(pyplot.get_fignums()) - set(before) == {figure.number}
    pyplot.close(figure)
