"""The state with which a page begins."""

import pytest
from click.testing import CliRunner

import metafem as mf
from metafem.cli import main
from metafem.errors import InvalidInput
from metafem.explorer.start import explore, first_state
from metafem.files import demo_text, save
from tests.explorer.scenes import SAMPLED, WANTED


def test_it_is_a_demo_by_default():
    assert first_state(None).text == demo_text("operating-points")


def test_a_specification_brings_its_tables(tmp_path):
    (tmp_path / "mine.toml").write_text(SAMPLED)
    (tmp_path / "wanted.csv").write_text(WANTED)
    state = first_state(tmp_path / "mine.toml")
    assert state.text == SAMPLED
    assert list(state.tables) == ["wanted.csv"]
    spec = mf.read_spec(tmp_path / "mine.toml")
    save(spec.design(), tmp_path / "made", specification=spec)
    assert first_state(tmp_path / "made") == state


def test_what_is_no_specification_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match=r"holds no spec\.toml; name a specification, or a folder of"):
        first_state(tmp_path)
    with pytest.raises(InvalidInput, match="no such file"):
        first_state(tmp_path / "gone.toml")
    (tmp_path / "bad.toml").write_text("[target]\n")
    with pytest.raises(InvalidInput, match=r"bad\.toml: "):
        first_state(tmp_path / "bad.toml")


@pytest.mark.parametrize("port", [0, 65536, -1, 1.5])
def test_a_port_outside_the_range_is_refused(port):
    with pytest.raises(InvalidInput, match=r"port = "):
        explore(port=port)


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setattr("metafem._extras.find_spec", lambda name: None)
    done = CliRunner().invoke(main, ["explore"])
    assert done.exit_code == 2
    assert "the explorer needs the extra explorer: pip install 'metafem[explorer]'" in done.output
