"""Pictures of surfaces and laws: what they show, where, and what they refuse."""

import subprocess
import sys

import numpy as np
import pytest

import metafem as mf
from metafem import drawing


@pytest.fixture
def ax():
    return drawing.new_figure(5.0, 4.0).add_subplot()


def test_a_surface_is_drawn_at_its_places_and_heights(rough, ax):
    assert rough.plot(ax) is ax
    dots = ax.collections[0]
    np.testing.assert_array_equal(dots.get_offsets(), rough.position)
    np.testing.assert_allclose(dots.get_array(), 1e3 * rough.height, rtol=1e-15)
    assert ax.get_legend() is None
    assert ax.get_aspect() == 1.0


def test_markers_follow_radii_that_differ(template, ax):
    radius = np.where(np.arange(template.count) % 2, 0.3, 0.6)
    template.replaced(radius=radius).plot(ax)
    size = ax.collections[0].get_widths()
    assert size[1] / size[0] == pytest.approx(0.5, rel=1e-12)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["R = 300 µm", "R = 600 µm"]


def test_a_law_is_drawn_rescaled_or_in_newtons(template, ax):
    law = mf.friction_law(template, load=[0.1, 0.2])
    law.plot(ax, label="rescaled")
    np.testing.assert_array_equal(ax.lines[0].get_xdata()[1:], law.rescaled_load)
    assert "mm²" in ax.get_ylabel()
    law.plot(ax, units="N")
    np.testing.assert_array_equal(ax.lines[1].get_xdata()[1:], law.load)
    np.testing.assert_array_equal(ax.lines[1].get_ydata()[1:], law.friction_force)
    assert ax.get_ylabel() == "friction force  F [N]"


def test_without_axes_pyplot_shows_the_picture(template):
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    figure = template.plot().figure
    assert set(pyplot.get_fignums()) - set(before) == {figure.number}
    pyplot.close(figure)


def test_what_cannot_be_drawn_is_refused(template, ax):
    law = mf.friction_law(template.replaced(friction=None), load=[0.1])
    with pytest.raises(mf.InvalidInput, match="friction_force needs the surface's friction"):
        law.plot(ax, units="N")
    with pytest.raises(mf.InvalidInput, match=r'units = \'kN\' must be "mm\^2" \(rescaled\) or "N"'):
        law.plot(ax, units="kN")
    assert not ax.lines


def test_matplotlib_is_imported_when_something_is_drawn_and_not_before():
    code = (
        "import sys, metafem as mf; "
        "s = mf.Surface.square_lattice(0.1, radius=0.5, material=mf.Material(1.0)); mf.friction_law(s); "
        "mf.fe, mf.studies; print('matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_the_same_picture_is_the_same_text(rough):
    def text():
        figure = drawing.new_figure(5.0, 4.0)
        rough.plot(figure.add_subplot())
        return drawing.svg(figure, "heights & <places>")

    first = text()
    assert first == text()
    assert first.startswith("<svg")
    assert "<title>heights &amp; &lt;places&gt;</title>" in first


@pytest.mark.parametrize(
    ("target", "labels"),
    [
        (mf.OperatingPoints([0.1, 0.2, 0.4], [0.8, 1.5, 2.9]), ["achieved", "target"]),
        (mf.PowerLaw(1.1, (0.05, 0.2)), ["achieved", "target"]),
        (mf.LinearLaw(7.5, load_range=(0.02, 0.1)), ["achieved", "target"]),
        (mf.LinearLaw(6.87), ["achieved", "law of the height density", "target slope"]),
    ],
    ids=["points", "power", "line", "density"],
)
def test_a_design_is_drawn_beside_its_target(target, labels, template, ax):
    design = mf.design(target, template, limits=mf.Limits(0.16, offset=0.084))
    assert design.plot(ax) is ax
    assert [text.get_text().split(",")[0] for text in ax.get_legend().get_texts()] == labels
    np.testing.assert_array_equal(ax.lines[0].get_ydata()[1:], design.law.area)
    x, y = (np.array(values) for values in ax.lines[1].get_data())
    # what is drawn beside the law is what the misfit compares it with
    np.testing.assert_array_equal(x, design.target_law.load)
    achieved = np.interp(x, design.law.rescaled_load, design.law.area)
    # between the points of the drawn law A0 is interpolated, to half a percent here
    assert np.sqrt(np.mean((y / achieved - 1.0) ** 2)) < design.misfit + 5e-3
