"""Seconds until each page of the site is drawn in a browser, and its size."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import click

from validation.scenes.browser import browser_path, opened, seconds
from validation.timing import Row

# Largest time [s] and size [MB] of a page.
SECONDS, MEGABYTES = 2.0, 3.0

# A folder with the whole site, which is otherwise written for this measurement by a quick run.
FOLDER = "METAFEM_SITE"

# Each page is opened so many times after once, which fills the caches of files.
REPEATS = 3


def rows() -> list[Row]:
    """Measure the slowest and the largest page."""
    if browser_path() is None:
        raise click.ClickException("no chromium is installed, in which the pages could be opened")
    if FOLDER in os.environ:
        return _measured(Path(os.environ[FOLDER]))
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "validation", "--quick", "--site", "-o", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return _measured(Path(folder))


def _measured(folder: Path) -> list[Row]:
    """Measure all pages of a folder."""
    pages = sorted(folder.rglob("*.html"))
    if not pages:
        raise click.ClickException(f"{FOLDER} = {folder} holds no page")
    with opened() as browser:
        times = {page: min(seconds(browser, page) for _ in range(1 + REPEATS)) for page in pages}
    slowest = max(pages, key=lambda page: times[page])
    largest = max(pages, key=lambda page: page.stat().st_size)
    return [
        Row(f"slowest of {len(pages)} pages, {_name(slowest, folder)}", SECONDS, times[slowest], "s"),
        Row(f"largest page, {_name(largest, folder)}", MEGABYTES, largest.stat().st_size / 1e6, "MB"),
    ]


def _name(page: Path, folder: Path) -> str:
    """Return the address of a page in its site."""
    return page.relative_to(folder).as_posix()
