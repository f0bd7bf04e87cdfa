"""The group of all studies, and the parts that their commands share."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import Name, force_option, json_option, main, option_names
from metafem.cli.progress import progress
from metafem.cli.terminal import loaded, print_json, print_study
from metafem.errors import named

if TYPE_CHECKING:
    from xarray import Dataset


@main.group(short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design in the result folder DIR, and write the dataset NAME.nc (NetCDF) into the folder.

    `metafem study NAME --help` lists the options of a study. `metafem report DIR` adds the results of the
    studies to the report.
    """


def of_design(compute: Callable[..., Dataset]) -> Callable[..., None]:
    """Return the command of a study; `compute` returns the dataset for a design and the options.

    The study has the name of this function. The command writes the dataset into the folder and prints its
    summary.
    """
    name = compute.__name__

    @click.argument("folder", type=Name(), metavar="DIR")
    @force_option
    @json_option
    @functools.wraps(compute)
    def command(folder: Path, force: bool, as_json: bool, **options: Any) -> None:
        if options.get("calibration") is not None:  # report a wrong file before the study runs
            mf.files.read_parameters(options["calibration"])
        path = mf.files.study_path(folder, name, force)
        with progress():
            design = loaded(folder)
        workers = options.pop("workers", 1)
        from joblib import parallel_config

        with progress(), named(option_names()), parallel_config(n_jobs=workers):
            dataset = compute(design, **options)
            mf.files.write_study(dataset, path, force=force)
        if as_json:
            print_json({"file": str(path), **mf.files.study_data(dataset)})
        else:
            print_study(dataset, path)

    return command
