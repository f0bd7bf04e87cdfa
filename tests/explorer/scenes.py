"""Targets of every kind, a specification with a table, and a page without a browser."""

import asyncio
import threading
from dataclasses import replace

import numpy as np
from nicegui import Client
from nicegui.page import page as page_of

from metafem.explorer.control import Control
from metafem.explorer.history import State
from metafem.files import demo_text
from metafem.progress import doing

# Time after which a scene fails that waits for what never comes [s].
LONGEST = 60.0

# A specification of a sampled law, and its table.
SAMPLED = """
[target]
kind = "sampled"
file = "wanted.csv"
[material]
composite_modulus = "1.36 MPa"
[lattice]
shape = [3, 3]
pitch = "1.5 mm"
radius = "526 um"
[limits]
max_height = "120 um"
"""
WANTED = "rescaled_load_mm2,rescaled_friction_mm2\n0.01,0.1\n0.03,0.25\n0.05,0.4\n"

FORCES = 'load = ["0.2 N", "450mN", "0.88 N"]\nfriction_force = ["0.26 N", "0.52 N", "1.29 N"]'
TARGETS = {
    "points": 'kind = "operating-points"\nrescaled_load = ["0.144 mm^2", "0.336 mm^2", "649e3 um^2"]\n'
    'rescaled_friction = ["0.84 mm^2", "1.68 mm^2", "4.12 mm²"]',
    "forces": f'kind = "operating-points"\n{FORCES}',
    "one": 'kind = "operating-points"\nload = ["0.2 N"]\nfriction_force = ["0.26 N"]',
    "samples": f'kind = "sampled"\n{FORCES}\nweight = [1.0, 2.0, 3.0]',
    "table": 'kind = "sampled"\nfile = "wanted.csv"',
    "linear": 'kind = "linear"\nslope = 6.87',
    "coefficient": 'kind = "linear"\nfriction_coefficient = 1.55',
    "line": 'kind = "linear"\nslope = 7\nload_range = ["0.1 N", "0.4 N"]',
    "bilinear": 'kind = "bilinear"\nslopes = [7.15, 12.52]\ncrossover_load = "0.0380 mm^2"',
    "lines": 'kind = "bilinear"\nfriction_coefficients = [1.6, 2.7]\ncrossover_load = "50 mN"\n'
    'load_range = ["0.035 N", "0.18 N"]',
    "power": 'kind = "power"\nexponent = 0.9\nload_range = ["0.1 mm^2", "0.4 mm^2"]',
    "prefactor": 'kind = "power"\nexponent = 0.9\nload_range = ["0.1 N", "0.4 N"]\nprefactor = 7',
    "multilinear": 'kind = "multilinear"\nslopes = [9.5, 8.0, 7.0]\nload_range = ["40 mN", "0.36 N"]\n'
    'crossover_loads = ["0.07 mm^2", ["0.15 mm^2", "0.24 N"]]',
}
TABLE = "load_mN,friction_force_N,weight,remark\n100,0.17,1,a\n200,0.31,2,b\n300,0.5,1,c\n"
TABLES = {"wanted.csv": TABLE.encode()}


def text_of(target):
    """Return a specification of a target; the rest is that of a demo without steps of height."""
    rest = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")
    return f"[target]\n{TARGETS.get(target, target)}\n[material]{rest}"


def files(**texts):
    """Return the texts of files by their names, of which the last underscore is the point."""
    return {".".join(name.rsplit("_", 1)): text for name, text in texts.items()}


def changed(text, change, *given):
    """Return a text after a change of its table."""
    state = State(text)
    return state.edited(change(state.table, *given)).text


def on_page(scene, *panels, state=None):
    """Return what a scene returns on a page whose browser does not answer, with some panels."""

    async def begun():
        client = Client(page_of("/"))
        client.run_javascript = lambda code, **how: None
        with client:
            page = Control(state or State(demo_text("operating-points")))
            made = [kind(page) for kind in panels]
        try:
            return await asyncio.wait_for(scene(page, *made), LONGEST)
        finally:
            client.delete()

    return asyncio.run(begun())


async def shown(page):
    """Wait until all answers are shown."""
    while page.queue.running:
        await asyncio.wait([page.queue.task])


def held(page):
    """Let the computations of a page wait until they are stopped; return the event of their begin."""
    begun, work = threading.Event(), page.queue.work

    def delayed(request):
        begun.set()
        while not request.stopped:
            with doing("waiting"):
                threading.Event().wait(0.001)
        return work(request)

    page.queue.work = delayed
    return begun


def calls_of(widget):
    """Return the list in which the calls of a widget in the browser are kept from now on."""
    sent = []
    widget.call = lambda *given: sent.append(given)
    return sent


def with_height(answer, asperity, height):
    """Return an answer in which an asperity has another height."""
    surface = answer.design.surface
    heights = np.where(np.arange(surface.count) == asperity, height, surface.height)
    return replace(answer, design=replace(answer.design, surface=surface.replaced(height=heights)))
