"""Claims and benchmarks are found by walking the packages."""

from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import validation
from validation.__main__ import main
from validation.discovery import chosen, first_line, groups, module

FOLDER = Path(validation.__file__).parent


@pytest.mark.parametrize(("attribute", "definition"), [("claim", "def claim("), ("rows", "def rows(")])
def test_every_file_is_found_once(attribute, definition):
    files = sorted(
        path.stem for path in FOLDER.glob("*/*.py") if f"\n{definition}" in path.read_text("utf-8")
    )
    found = [name for names in groups(attribute).values() for name in names]
    assert sorted(found) == files
    assert len(set(found)) == len(found)


def test_names_select_claims_and_groups():
    assert chosen(("fig4_linear",), "claim") == ["fig4_linear"]
    assert chosen(("fidelity", "bounds"), "claim") == [*groups("claim")["fidelity"], "bounds"]
    assert module("fig4_linear", "claim").__name__ == "validation.paper.fig4_linear"
    with pytest.raises(click.BadParameter, match=r"'fig9' is none of .*fig4_linear"):
        chosen(("fig9",), "claim")


def test_help_lists_every_claim_with_one_line():
    text = CliRunner().invoke(main, ["--help"]).output
    for group, names in groups("claim").items():
        assert f"\n{group}" in text
        for name in names:
            assert f"\n  {name} " in text
            assert first_line(module(name, "claim")).endswith(".")
