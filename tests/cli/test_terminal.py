"""Tables on terminals of any width."""

import io

import pytest
from rich.console import Console

from metafem.cli.terminal import print_table


@pytest.mark.parametrize("width", [40, 80, 200])
def test_no_number_of_a_table_is_truncated(width):
    console = Console(width=width, file=io.StringIO())
    numbers = [f"{i}.{i}{i}{i}{i}{i}" for i in range(9)]
    print_table(console, ["a long heading [mm]"] * 9, [numbers])
    assert all(number in console.file.getvalue() for number in numbers)
    assert "heading" in console.file.getvalue()
    assert "…" not in console.file.getvalue()


def test_units_in_brackets_are_printed():
    console = Console(width=80, file=io.StringIO())
    print_table(console, ["quantity [mm]", "value"], [("energy [mJ/m²]", "9")])
    assert "energy [mJ/m²]" in console.file.getvalue()
