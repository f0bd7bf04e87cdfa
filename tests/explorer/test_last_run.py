"""Token and port that an explorer has again."""

import socket

import pytest

from metafem.errors import InvalidInput
from metafem.explorer import last_run
from metafem.explorer.last_run import HOST


def ended():
    """End all runs: their locks are free again."""
    while last_run._HELD:
        last_run._HELD.pop().release()


def token_and_port(wanted):
    """Those of a run after all others have ended, which then ends as well."""
    ended()
    found = last_run.token_and_port(wanted)
    ended()
    return found


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A cache folder of its own."""
    monkeypatch.setenv("METAFEM_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_the_next_run_has_the_token_and_the_port_of_the_last(folder):
    token, port = token_and_port(None)
    assert len(token) == 32
    assert token_and_port(None) == (token, port)
    assert (folder / "explorer.json").stat().st_mode & 0o777 == 0o600
    assert {each.name for each in folder.iterdir()} - {"explorer.lock"} == {"explorer.json"}


def test_of_runs_at_the_same_time_the_first_alone_keeps_its_port():
    token, port = token_and_port(None)
    assert last_run.token_and_port(None) == (token, port)
    others = [last_run.token_and_port(None) for _ in range(3)]
    assert {each for each, _ in others} == {token}
    assert port not in [free for _, free in others]
    ended()
    assert token_and_port(None) == (token, port)


def test_a_port_in_use_is_left_to_its_owner():
    token, port = token_and_port(None)
    with socket.socket() as other:
        other.bind((HOST, port))
        other.listen()
        again, free = token_and_port(None)
        assert again == token
        assert free != port
        with pytest.raises(InvalidInput, match=rf"port = {port} cannot be used: .*in use; omit it"):
            token_and_port(port)


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "{}", '{"token": "", "port": 1}', '{"token": 7, "port": []}']
)
def test_a_damaged_file_is_replaced(folder, text):
    folder.mkdir()
    (folder / "explorer.json").write_text(text)
    assert token_and_port(None) == token_and_port(None)


def test_without_a_cache_folder_they_are_new(folder):
    folder.write_text("a file")
    assert token_and_port(None)[0] != token_and_port(None)[0]
