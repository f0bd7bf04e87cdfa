"""Commands and scripts that give the same result as the page."""

from __future__ import annotations

from metafem.explorer.session import State

FOLDER = "surface"


def command_of(state: State) -> str:
    """Return the command that makes the result folder from the specification that was downloaded."""
    unpack = "unzip specification.zip && " if state.tables else ""
    return f"{unpack}metafem design spec.toml -o {FOLDER}"


def script_of() -> str:
    """Return a script that gives the design from the specification that was downloaded."""
    return 'import metafem as mf\n\nspec = mf.read_spec("spec.toml")\nprint(spec.design())\n'
