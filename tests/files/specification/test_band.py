"""Bands in a specification."""

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.text.handles import scene_of
from metafem.files import demo_text, parsed


def spec(keys):
    text = demo_text("operating-points")
    start = text.index("[target]")
    end = text.index("\n[", start + 8) + 1
    return text[:start] + f'[target]\nkind = "band"\n{keys}\n' + text[end:]


RESCALED = 'rescaled_load = ["0.1 mm^2", "0.2 mm^2"]\nlowest = ["0.8 mm^2", "1.4 mm^2"]\n'


def test_a_band_is_read_designed_drawn_and_saved(tmp_path):
    text = spec(RESCALED + 'highest = ["0.9 mm^2", "1.6 mm^2"]')
    found = parsed(text)
    assert isinstance(found.target, mf.Band)
    np.testing.assert_allclose(found.target.highest, [0.9, 1.6], rtol=1e-12)
    design = found.design()
    assert design.misfit == 0.0
    scene = scene_of(text, found, design)
    assert scene.handles() == ()
    assert int(np.isnan(scene.shape().load).sum()) == 1
    mf.save(design, tmp_path / "band")
    again = mf.load(tmp_path / "band")
    assert again.target == found.target
    np.testing.assert_array_equal(again.target_law.ends, design.target_law.ends)


def test_a_missing_curve_is_named():
    with pytest.raises(mf.InvalidInput, match="highest"):
        parsed(spec(RESCALED))
