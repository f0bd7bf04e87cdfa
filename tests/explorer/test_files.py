"""All files that the page hands out are those of ``metafem design``."""

from metafem.explorer.answer import answered
from metafem.explorer.files import made_files
from tests.core.explorer.test_files import STATE, files_of_command


def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    made = made_files(answered(STATE, 1))
    assert made == files_of_command(tmp_path, monkeypatch)
    assert {"report.html", "spec.toml", "wanted.csv"} <= made.keys()
