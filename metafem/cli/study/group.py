"""The group of all studies, and the common parts of their commands."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.progress import progress
from metafem.cli.study.kept import kept_batches
from metafem.cli.terminal import loaded, print_json, print_study
from metafem.errors import named

if TYPE_CHECKING:
    from xarray import Dataset


@main.group(short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design of the result folder DIR and write the dataset NAME.nc (NetCDF) into it.

    `metafem study NAME --help` lists the options of a study. `metafem report DIR` adds what the studies of
    the folder answer to its report.
    """


def of_design(compute: Callable[..., Dataset]) -> Callable[..., None]:
    """Return the command of a study, from the function that computes it for a design and the options.

    The command has the name of the study. It writes the dataset into the folder and prints its summary.
    """
    name = compute.__name__

    @click.argument("folder", type=Name(), metavar="DIR")
    @force_option
    @json_option
    @functools.wraps(compute)
    def command(folder: Path, force: bool, as_json: bool, **options: Any) -> None:

        if options.get("calibration") is not None:  # a wrong file is reported before the study runs
            mf.files.read_parameters(options["calibration"])
        path = mf.files.study_path(folder, name, force)
        still = mf.files.same_design(folder)
        with progress():
            design = loaded(folder)
        with progress(), named(mf.files.option_names(_first_texts(options))), ExitStack() as stack:
            if "workers" in options:  # a study in batches
                options["kept"] = stack.enter_context(kept_batches(name, folder, options))
            dataset = compute(design, **options)
            mf.files.write_study(dataset, path, force=force, still=still)
        if as_json:
            print_json({"file": str(path), **mf.files.study_data(dataset)})
        else:
            print_study(dataset, path)

    return command


def _first_texts(options: Mapping[str, Any]) -> dict[str, str | None]:
    """Return the text of each option, None without one; of several the first: errors use its unit."""
    texts: dict[str, str | None] = {}
    for name, value in options.items():
        first = next(iter(value), None) if isinstance(value, tuple) else value
        texts[name] = first.partition(",")[0] if isinstance(first, str) else None
    return texts
