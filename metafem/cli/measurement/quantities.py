"""Options that are quantities, declared by name: unit, example and help."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import click

import metafem as mf
from metafem._given import Names
from metafem.cli.study.options import Options, option_name, with_options

Declared = Mapping[str, tuple[str, str, str]]

# The placeholders of quantities in `--help`, by their unit.
PLACEHOLDERS = {"mm": "LENGTH", "N": "FORCE", "rad": "ANGLE", "%": "PERCENT"}


def quantity_options(declared: Declared) -> Options:
    """Return the options of quantities; `{}` in a help text is the example."""
    return with_options(
        *(
            click.option(option_name(name), metavar=PLACEHOLDERS[unit], help=text.format(example))
            for name, (unit, example, text) in declared.items()
        )
    )


def quantities(declared: Declared, options: Mapping[str, Any]) -> dict[str, float | None]:
    """Return the quantities of options in the package's units, None where an option is not given."""
    return {
        name: None
        if options[name] is None
        else mf.files.quantity(option_name(name), options[name], unit, example)
        for name, (unit, example, _) in declared.items()
    }


def names_of(options: Mapping[str, Any], arguments: Iterable[str] = ()) -> Names:
    """Return the names of options and the written units, for errors; `arguments` are other options."""
    names = mf.files.option_names({name: value for name, value in options.items() if isinstance(value, str)})
    others = {name: option_name(name) for name in arguments}
    # with a unit in the list, numbers of options in other units are printed with theirs
    return replace(names, units={**names.units, "": ("", 1.0)}, names={**names.names, **others})
