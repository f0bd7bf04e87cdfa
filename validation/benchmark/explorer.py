"""The explorer in a browser: from a drag to the law on the screen, start, memory, size, and two pages."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from metafem.files import demo_text
from validation.scenes.browser import opened
from validation.scenes.explorer import Visit, latencies, releases, served, updates, visited
from validation.timing import Row

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# Longest time from a drag to the law and the heights on the screen, 95th percentile [ms]: for 64 sites, for a
# line over a range, and for 400 sites.
LATENCY, RANGED = {"independent": 60.0, "layer": 90.0}, 90.0
LARGE = {"independent": 100.0, "layer": 200.0}

# Longest time from the release of a handle to the whole design on the screen, 95th percentile [ms]: the draft
# of the same law is shown meanwhile, and what is shown changes a little. Releases of each law.
RELEASE, RELEASES = {"independent": 200.0, "layer": 500.0}, 16

# Moves of each law, and how far they lie from the first place of their handle [pixels].
MOVES, REACH = 100, 10.0

# Moves over which the memory is compared, and those of each release.
UPDATES, HELD = 2000, 100

# Starts of the command, of which the quickest counts: the first fills the file cache.
STARTS = 3

# An eight-point law whose design uses the limits of the linear demo.
SAMPLES = np.linspace(0.08, 0.6, 8)


def specifications() -> dict[str, str]:
    """Return specifications of 64 sites, by the kind of their law."""
    linear = demo_text("linear")
    areas = {"load": SAMPLES, "friction": 6.87 * SAMPLES}
    keys = [f"rescaled_{key} = {[f'{value:.4g} mm^2' for value in areas[key]]}" for key in areas]
    section = "\n".join(["[target]", 'kind = "sampled"', *keys, "", ""]).replace("'", '"')
    return {
        "operating points": demo_text("operating-points"),
        "eight samples": re.sub(r"\[target\].*?(?=\[material\])", section, linear, flags=re.DOTALL),
        "linear": linear,
        "line over a range": linear.replace("# load_range", "load_range"),
        "bilinear": demo_text("bilinear"),
    }


def large() -> str:
    """Return the demo of operating points with 400 sites, and so with 6.25 times the forces."""
    text = demo_text("operating-points").replace("[8, 8]", "[20, 20]")
    text = re.sub(r"\[block\][^\[]*", "", text)
    return re.sub(r'"([\d.]+) mm\^2"', lambda found: f'"{6.25 * float(found[1]):.6g} mm^2"', text)


def rows() -> list[Row]:
    """Measure the latencies of each law and model, the start, the size of the page, and two pages."""
    with opened() as browser, tempfile.TemporaryDirectory() as folder:
        measured = []
        for law, text in specifications().items():
            for model, allowed in LATENCY.items():
                with served(_written(folder, text, model)) as server, visited(browser, server) as visit:
                    times = dragged(visit, MOVES)
                    whole = dragged(visit, RELEASES, releases)
                what = f"to law and heights on the screen, {law}, {model}"
                most = RANGED if "range" in law else allowed
                measured += _percentiles(f"from a drag {what}", most, times)
                measured += _percentiles(f"from a release {what}", RELEASE[model], whole)
        for model, allowed in LARGE.items():
            with served(_written(folder, large(), model)) as server, visited(browser, server) as visit:
                what = f"from a drag to law and heights on the screen, 400 sites, {model}"
                measured += _percentiles(what, allowed, dragged(visit, MOVES))
        starts, first = [], []
        for _ in range(STARTS):
            with served() as server, visited(browser, server) as visit:
                visit.page.wait_for_load_state("networkidle")
                starts.append(server.seconds + visit.seconds)
                first.append(visit.seconds)
                foreign = [each for each in visit.requests if not each.startswith(server.origin)]
                size, count = visit.size, len(visit.requests)
        measured += [
            Row("from `metafem explore` to the first law, quickest of three", 3.0, min(starts), "s"),
            Row("from the first page to the first law, quickest of three", 1.5, min(first), "s"),
            Row("size of the page", 0.8, size / 1e6, "MB"),
            Row("requests of the page", 30.0, count),
            Row("requests that leave the machine", 0.0, len(foreign)),
            Row("two pages at once: changes of one by drags in the other", 0.0, disturbed(browser)),
        ]
    return measured


def long_rows() -> list[Row]:
    """Measure how the memory of the server grows over many updates."""
    with opened() as browser, served() as server, visited(browser, server) as visit:
        many(visit, UPDATES // 10)
        before = server.memory
        many(visit, UPDATES)
        what = f"memory of the server over {UPDATES} updates, a release after each {HELD}: growth"
        return [Row(what, 50.0, server.memory - before, "MiB")]


def _written(folder: str, text: str, model: str) -> Path:
    """Return the file of a specification under another model."""
    path = Path(folder, "spec.toml")
    path.write_text(text.replace('kind = "independent"', f'kind = "{model}"'), "utf-8")
    return path


def _percentiles(what: str, allowed: float, times: list[float]) -> list[Row]:
    """Return rows of the median and the 95th percentile."""
    percents = ((50, "median"), (95, "95th percentile"))
    return [Row(f"{what}: {name}", allowed, float(np.percentile(times, at)), "ms") for at, name in percents]


def dragged(
    visit: Visit,
    count: int,
    timed: Callable[[Visit, str, list[tuple[float, float]]], list[float]] = latencies,
) -> list[float]:
    """Drag each handle a few times, the first drag not timed, and return the times of all moves [ms]."""
    handles = visit.handles()
    rng = np.random.default_rng(0)
    latencies(visit, handles[0], [(3.0, 3.0), (0.0, 0.0)])
    times: list[float] = []
    for handle in handles:
        moves = rng.uniform(-REACH, REACH, (-(-count // len(handles)), 2))
        times += timed(visit, handle, [(float(right), float(down)) for right, down in moves])
    return times


def many(visit: Visit, count: int) -> None:
    """Drag the first handle by a script, and release it now and then."""
    for _ in range(count // HELD):
        updates(visit, visit.handles()[0], HELD)


def disturbed(browser: Browser) -> float:
    """Drag on one of two pages, and count what has changed on the other."""
    with served() as server, visited(browser, server) as first, visited(browser, server) as second:
        before = second.history
        for _ in range(5):
            updates(first, first.handles()[0], 20)
        return float((second.history != before) + (first.text == second.text) + (second.asked != 1))
