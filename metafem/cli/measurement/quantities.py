"""Options that are quantities; each is declared by its name, unit, example and help text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import click

import metafem as mf
from metafem._given import Names
from metafem.cli.study.options import Options, option_name, with_options

Declared = Mapping[str, tuple[str, str, str]]

# Placeholder of a quantity in `--help`, by its unit.
PLACEHOLDERS = {"mm": "LENGTH", "N": "FORCE", "rad": "ANGLE", "%": "PERCENT"}


def quantity_options(declared: Declared) -> Options:
    """Return a decorator that adds options of quantities; the example is inserted at `{}` in a help text."""
    return with_options(
        *(
            click.option(option_name(name), metavar=PLACEHOLDERS[unit], help=text.format(example))
            for name, (unit, example, text) in declared.items()
        )
    )


def quantities(declared: Declared, options: Mapping[str, Any]) -> dict[str, float | None]:
    """Return the values of the declared options in the package's units; None for an option that is absent."""
    return {
        name: None
        if options[name] is None
        else mf.files.quantity(option_name(name), options[name], unit, example)
        for name, (unit, example, _) in declared.items()
    }


def names_of(options: Mapping[str, Any], arguments: Iterable[str] = ()) -> Names:
    """Return how errors name options, and the units in which these were written.

    `options` holds the values of options. `arguments` are the names of further options.
    """
    names = mf.files.option_names({name: value for name, value in options.items() if isinstance(value, str)})
    others = {name: option_name(name) for name in arguments}
    # a list with at least one unit makes errors print all numbers with their units
    return replace(names, units={**names.units, "": ("", 1.0)}, names={**names.names, **others})
