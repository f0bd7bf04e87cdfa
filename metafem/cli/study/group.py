"""The group of all studies, and the parts that their commands share."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem import _caches
from metafem.cli.group import Name, force_option, json_option, main, option_names
from metafem.cli.progress import progress
from metafem.cli.signals import report_stop
from metafem.cli.terminal import loaded, print_json, print_study
from metafem.errors import named
from metafem.progress import message

if TYPE_CHECKING:
    from xarray import Dataset


# Options that do not affect the results.
PLACES = ("workers", "scheduler")


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
        still = mf.files.same_design(folder)
        with progress():
            design = loaded(folder)
        with progress(), named(option_names()), ExitStack() as stack:
            if "workers" in options:  # the study runs in batches
                options["kept"] = stack.enter_context(kept_batches(name, folder, options))
            dataset = compute(design, **options)
            mf.files.write_study(dataset, path, force=force, still=still)
        if as_json:
            print_json({"file": str(path), **mf.files.study_data(dataset)})
        else:
            print_study(dataset, path)

    return command


@contextmanager
def kept_batches(name: str, folder: Path, options: Mapping[str, Any]) -> Iterator[Path | None]:
    """Yield the folder for the batches of a study, and remove it at the end; yield None without a cache.

    The folder depends only on the design and the options. If the body is stopped or fails after the first
    batch, the folder is not removed, and the next run continues from its batches.
    """
    kept = _folder(name, folder, options)
    left = "nothing was written" if kept is None else "the same command continues from the finished batches"
    done = False
    with report_stop(left):
        try:
            yield kept
            done = True
        finally:
            if kept is not None and (done or not any(kept.glob("batch-*"))):
                _caches.remove([kept])


def _folder(name: str, folder: Path, options: Mapping[str, Any]) -> Path | None:
    """Return the folder for the batches of a study with these options, or None if it cannot be created."""
    from metafem.files.atomic import digest
    from metafem.studies.sampling.store import inputs_hash, own_version

    numbers = {
        option: digest(value) if isinstance(value, Path) and value.is_file() else value
        for option, value in options.items()
        if option not in PLACES
    }
    inputs = inputs_hash((name, own_version(), digest(folder / "design.json"), numbers))
    try:
        found = _caches.study_folder() / inputs
        found.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message(f"a stopped study will begin again: its batches cannot be kept ({error})")
        return None
    return found
