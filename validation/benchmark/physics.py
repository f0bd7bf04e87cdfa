"""Speeds of the models beside those of an earlier commit, errors of random scenes, and sizes of the core."""

from __future__ import annotations

import importlib.util
import os
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from unittest import mock

import numpy as np

import metafem as mf
from metafem.models.interacting import elastic
from validation.methods.contact_equations import coupled, influence
from validation.scenes import timed
from validation.scenes.ladder import Choice, choices
from validation.timing import Row, spent, took

ROOT = Path(__file__).parents[2]

# Times of each work in each process, which take turns; the quickest counts, as others share the processor.
ROUNDS = 4

# Works paired with the earlier commit, and the largest ratio of the times.
PAIRED = {
    "each of 100 loads, order 3, 64 asperities": ("order_3", 0.4),
    "equilibrium, order 3, 64 asperities, new heights": ("new_heights", 0.55),
    "equilibrium, order 3, 64 asperities, new sites": ("new_sites", 0.65),
}

# Works paired with another work of this commit, and the largest ratio.
RATIOS = {
    "a surface of a batch of 1,000 under 25 loads, over one at a time": ("batch", "single", 0.5),
    "Automatic(1e-3), pitch 200 mm, over Independent()": ("automatic 200", "independent 200", 1.5),
    "Automatic(1e-3), pitch 100 mm, over Independent()": ("automatic 100", "independent 100", 1.5),
    "the same, pitch 50 mm, where loads need order 3": ("automatic 50", "independent 50", float("inf")),
}

# Largest time [s] of each of 20 loads of order 3 on the layer, by the number of asperities on a side.
LAYER = {20: 1.1e-3, 40: 5e-3, 100: 40e-3}

# Largest ratio of the processor times of compiling all kernels.
COMPILED = 0.47

# Random scenes, and the largest ratio of an estimated and a true error above the least error that counts.
SCENES, FACTOR, LEAST = 60, 3.0, 1e-4

# The core, and the largest numbers of its code lines, files and module constants.
CORE = "contact substrate _kernels models fe reference.py surface.py caps material.py"
SIZES = {"code lines": 6700, "files": 65, "module constants": 120}

# Order 1 on a million sites: largest numbers of products, seconds and memory [GiB].
MILLION = {"a lattice": (60, 80.0, 3.0), "jittered sites": (120, 80.0, 3.0)}


def rows(commit: str = "837c6d6a", long: bool = False) -> Iterator[Row]:
    """Time the models beside those of `commit`; count products on a million sites if `long`."""
    paired = [work for work, _ in PAIRED.values()]
    layers = [f"layer {side}" for side in LAYER]
    alone = [work for *pair, _ in RATIOS.values() for work in pair]
    with checked_out(commit) as earlier:
        rounds = [
            (seconds(ROOT, [*paired, *alone, *layers]), seconds(earlier, paired)) for _ in range(ROUNDS)
        ]
        compiled = compiling(ROOT), compiling(earlier)
    own, other = (
        {work: min(each[work] for each in tree) for work in tree[0]} for tree in zip(*rounds, strict=True)
    )
    for what, (work, allowed) in PAIRED.items():
        yield Row(what, float("inf"), 1e6 * own[work], "µs")
        yield Row(f"{what}, over {commit}", allowed, own[work] / other[work])
    for what, (work, beside, allowed) in RATIOS.items():
        yield Row(what, allowed, own[work] / own[beside])
    for work, (side, most) in zip(layers, LAYER.items(), strict=True):
        yield Row(f"each of 20 loads, order 3, layer, {side**2:,} sites", 1e3 * most, 1e3 * own[work], "ms")
    yield Row(
        "order 1 by plain numpy, over order 3 at each of 100 loads", float("inf"), by_numpy() / own["order_3"]
    )
    yield Row("kernels compiled from nothing", float("inf"), compiled[0], "s")
    yield Row(f"kernels compiled from nothing, over {commit}", COMPILED, compiled[0] / compiled[1])
    yield from random_scenes()
    yield from sizes()
    if long:
        yield from million()


def seconds(tree: Path, works: list[str]) -> dict[str, float]:
    """Return the seconds of works in a process that uses the package of a tree."""
    command = [sys.executable, str(ROOT / "validation/scenes/timed.py"), *works]
    said = subprocess.run(
        command, env=environment(tree), stdout=subprocess.PIPE, text=True, check=True
    ).stdout
    return dict(zip(works, map(float, said.split()), strict=True))


def environment(tree: Path) -> dict[str, str]:
    """Return the environment in which a process uses the package of a tree."""
    return os.environ | {"PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """Check a commit out into a temporary folder."""
    with tempfile.TemporaryDirectory() as parent:
        tree = Path(parent, "tree")
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), commit], check=True)
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def by_numpy() -> float:
    """Return the seconds of each of 100 loads of order 1 by plain numpy."""
    surface, load = timed.lattice(8), timed.loads(64, 100)
    matrix = influence(surface, "half-space")
    works = [lambda: [coupled(surface.height, 0.526, matrix, each) for each in load]] * 3
    return timed.quickest(works) / len(load)


def compiling(tree: Path) -> float:
    """Return the processor seconds that the kernels of a tree take to compile and to run once."""
    code = "from tests.kernels import PARTS; [part() for part in PARTS]"
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with tempfile.TemporaryDirectory() as cache:
        where = environment(tree) | {"METAFEM_CACHE_DIR": cache}
        spent([sys.executable, "-c", code], cwd=tree, env=where)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def random_scenes() -> Iterator[Row]:
    """Judge what `Automatic` chooses on random scenes."""
    found = Choice(*np.array(choices(SCENES)).T)
    large = (found.error > LEAST) & (found.chosen < 1)
    ratio = found.estimate[large] / found.error[large]
    wrong = {
        "the tolerance": found.error > found.tolerance,
        "the tolerance along a curve": found.along > found.tolerance,
        f"a factor of {FACTOR:g} of the estimate": (ratio < 1.0 / FACTOR) | (ratio > FACTOR),
    }
    for what, beyond in wrong.items():
        yield Row(f"of {len(beyond):,} choices on {SCENES} scenes, beyond {what}", 0.0, float(beyond.sum()))


def sizes() -> Iterator[Row]:
    """Count the lines, files and constants of the core."""
    spec = importlib.util.spec_from_file_location("count", ROOT / ".ci/count.py")
    counting = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(counting)
    places = [ROOT / "metafem" / name for name in CORE.split()]
    files = [file for place in places for file in (place.rglob("*.py") if place.is_dir() else [place])]
    texts = [file.read_text("utf-8") for file in files]
    names = [re.findall(r"^(?:[A-Z][A-Z0-9_]+(?:, )?)+(?=(?:: .*)? = )", text, re.M) for text in texts]
    constants = sum(len(each.split(",")) for found in names for each in found)
    lines = sum(counting.python(text)[0] for text in texts)
    for (what, most), measured in zip(SIZES.items(), (lines, len(files), constants), strict=True):
        yield Row(f"{what} of the core", most, measured)


def million() -> Iterator[Row]:
    """Solve order 1 on a million sites, each kind in a process of its own."""
    for kind, limits in MILLION.items():
        with ProcessPoolExecutor(1, get_context("spawn")) as pool:
            measured = pool.submit(_million, kind).result()
        for unit, most, value in zip(("products", "s", "GiB"), limits, measured, strict=True):
            yield Row(f"order 1, a million asperities, {kind}", most, value, unit)


def _million(kind: str) -> tuple[float, float, float]:
    """Return products of the influence, seconds, and peak memory [GiB] of one load."""
    surface, kept = timed.lattice(1000), []
    if kind != "a lattice":
        shift = np.random.default_rng(1).uniform(-0.4, 0.4, surface.position.shape)
        surface = surface.replaced(position=surface.position + shift)
    build = elastic.large_scene
    with mock.patch.object(elastic, "large_scene", lambda *given: kept.append(build(*given)) or kept[-1]):
        seconds, _ = took(lambda: mf.Interacting(order=1).curve(surface, timed.loads(10**6, 1)).checked())
    return kept[0][0].products, seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
