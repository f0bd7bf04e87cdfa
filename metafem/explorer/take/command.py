"""A command and a script that produce the same result as the page."""

from __future__ import annotations

from metafem.explorer.session import State

FOLDER = "surface"


def command_of(state: State) -> str:
    """Return the command that creates the result folder from the downloaded specification."""
    unpack = "unzip specification.zip && " if state.tables else ""
    return f"{unpack}metafem design spec.toml -o {FOLDER}"


def script_of() -> str:
    """Return a Python script that computes the design from the downloaded specification."""
    return 'import metafem as mf\n\nspec = mf.read_spec("spec.toml")\nprint(spec.design())\n'
