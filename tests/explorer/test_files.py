"""All files that the page hands out are those of ``metafem design``."""

import io
import zipfile

from click.testing import CliRunner

from metafem.cli import main
from metafem.explorer.session import State
from metafem.explorer.take.files import command_of, made_files, specification_file
from tests.explorer.scenes import SAMPLED, WANTED

STATE = State(SAMPLED, {"wanted.csv": WANTED})


def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    zipfile.ZipFile(io.BytesIO(specification_file(STATE)[1])).extractall(tmp_path)
    words = command_of(STATE).split(" && ")[-1].split()[1:]
    done = CliRunner().invoke(main, [*words[:-1], str(tmp_path / words[-1])])
    assert done.exit_code in (0, 1), done.output
    made = made_files(STATE)
    assert made == {path.name: path.read_bytes() for path in (tmp_path / words[-1]).iterdir()}
    assert {"report.html", "spec.toml", "wanted.csv", ".metafem-files"} <= made.keys()
