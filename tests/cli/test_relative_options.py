"""Options for relative quantities: every one needs a percent sign, so that no number is read in two ways."""

from pathlib import Path

import click
import pytest

from metafem import cli

# What each command needs besides the option.
NEEDED = {
    "study manufacturing": ("linear", "--height-sd", "3um"),
    "study uncertainty": ("linear", "--sd", "radius=2um"),
    "study combined": ("linear", "--height-sd", "3um"),
    "calibrate": ("shear.csv",),
    "compare": ("linear", "measured.csv", "--explain"),
}

# Options of bare numbers: ratios that are no relative errors, and a port.
PLAIN = {"poisson-ratio", "area-ratio", "sliding-area-ratio", "port"}


def commands(group=cli.main, path=()):
    """Yield the words and the command of every command."""
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, (*path, name))
        else:
            yield " ".join((*path, name)), command


RELATIVE = [
    (words, option.opts[-1])
    for words, command in commands()
    for option in command.params
    if option.metavar == "PERCENT"
]


def test_all_relative_options_are_known():
    assert {option for _, option in RELATIVE} == {
        *("--misfit", "--probability", "--error", "--friction-relative-error"),
        *("--height-scale-sd", "--composite-modulus-sd", "--friction-sd", "--adhesion-root-sd"),
    }
    plain = {
        option.opts[-1].removeprefix("--")
        for _, command in commands()
        for option in command.params
        if option.metavar == "NUMBER" or option.type.name in ("float", "float range")
    }
    assert plain <= PLAIN


@pytest.mark.parametrize(("words", "option"), RELATIVE)
@pytest.mark.parametrize(
    ("text", "refusal"),
    [
        ("3", '= "3" needs a unit; write "3 %" or "300 %"'),
        ("0.03", '= "0.03" needs a unit; write "0.03 %" or "3 %"'),
        ("3 um", '= "3 um" has the unit "um", which does not measure in %'),
    ],
)
def test_a_bare_number_is_refused_with_both_readings(run, demo, words, option, text, refusal):
    demo("linear")
    table = "load_N,area_before_mm2,area_sheared_mm2,friction_force_N\n0.1,0.5,0.42,0.16\n0.2,0.8,0.68,0.26\n"
    Path("shear.csv").write_text(table, "utf-8")
    Path("measured.csv").write_text("load_N,friction_force_N\n0.1,0.2\n0.3,0.5\n", "utf-8")
    result = run(*words.split(), *NEEDED[words], option, text)
    assert (result.exit_code, f"{option} {refusal}" in result.output) == (2, True), result.output


def test_a_percentage_of_a_ratio_is_refused(run, demo):
    """The area ratio B = 0.85 with "1 %" could have the standard deviation 0.01 or 0.0085."""
    demo("linear")
    result = run("study", "uncertainty", "linear", "--sd", "area_ratio=1%")
    assert result.exit_code == 2
    assert 'area_ratio = "1%" has the unit "%", but is a number without unit' in result.output
