"""The explorer in a browser: a server of its own process, and a visit that drags, waits and reads."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from metafem.explorer.history import from_link

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

# Seconds within which the server answers its first page, and a page any request.
PATIENCE = 30.0

# Rounds of at-rest questions that must agree, see `taken` of the script.
ROUNDS = 3

# Functions that are evaluated in the page, as members of `probe`.
SCRIPT = Path(__file__).with_suffix(".js")


@dataclass
class Server:
    """A running explorer, and the time that it needed to start [s]."""

    process: subprocess.Popen[str]
    address: str
    log: Path
    seconds: float

    @property
    def origin(self) -> str:
        """The address without its path and token."""
        return "/".join(self.address.split("/")[:3]) + "/"

    @property
    def said(self) -> str:
        """What it has printed to the standard error."""
        return self.log.read_text("utf-8")


@contextmanager
def served(
    path: Path | None = None, *options: str, program: tuple[str, str] = ("-m", "metafem")
) -> Iterator[Server]:
    """Start `metafem explore` and end it afterwards; another program must do the same."""
    command = [sys.executable, *program, "explore", *([] if path is None else [str(path)])]
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "log.txt")
        with log.open("w", encoding="utf-8") as written:
            # within a test, NiceGUI would serve at a port for tests of its own
            own = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
            command += ["--no-browser", *options]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=written, text=True, env=own)
        try:
            yield Server(process, _address(process, log), log, time.perf_counter() - start)
        finally:
            process.terminate()
            process.communicate(timeout=PATIENCE)


def _address(process: subprocess.Popen[str], log: Path) -> str:
    """Return the address that a server prints when it is ready."""
    for line in process.stdout or ():
        if found := re.search(r"http://\S+", line):
            return found[0]
    raise RuntimeError(f"the explorer ended before it printed its address: {log.read_text('utf-8')}")


@dataclass
class Visit:
    """A page of the explorer: its errors and requests, and the time to its law [s]."""

    page: Page
    server: Server
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def text(self) -> str:
        """The specification of the state that is shown."""
        return from_link(self.page.evaluate("() => location.hash")).text

    @property
    def asked(self) -> int:
        """Number of the last step of the history."""
        return int(
            self.page.evaluate("() => Number(document.querySelector('[data-asked]')?.dataset.asked ?? 0)")
        )

    def settled(self, before: int = 0) -> None:
        """Wait for the answer to a step after the one of a number."""
        self.page.wait_for_function("probe.settled", arg=before, timeout=1e3 * PATIENCE)

    def at_rest(self) -> None:
        """Wait until the server has taken all events and the pictures show the answer to the last step."""
        before, same = -1, 0
        while same < ROUNDS:
            self.page.evaluate("probe.taken")
            asked = self.asked
            self.settled(asked - 1)
            before, same = asked, same + 1 if asked == before else 0

    def anew(self, width: int = 1440, height: int = 900) -> None:
        """Open the page once more as at a first visit: the browser has forgotten what it kept of it."""
        self.page.mouse.up()
        self.page.evaluate("() => { sessionStorage.clear(); localStorage.clear(); }")
        self.page.goto("about:blank")
        self.page.set_viewport_size({"width": width, "height": height})
        self.errors.clear()
        self.requests.clear()
        self.page.goto(self.server.address)
        self.settled()

    def handles(self) -> list[str]:
        """Return the ids of the handles of the law."""
        found = self.page.locator("[data-answered] .handle").all()
        return [str(each.get_attribute("data-id")) for each in found]

    def middle(self, handle: str) -> tuple[float, float]:
        """Return the middle of a handle on the screen [pixels]."""
        box = self.page.locator(f'.handle[data-id="{handle}"] .touch').bounding_box()
        if box is None:
            raise RuntimeError(f"the handle {handle} is not shown")
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag(self, handle: str, right: float, down: float, steps: int = 5) -> None:
        """Drag a handle, release it and wait for the answer."""
        before = self.asked
        x, y = self.middle(handle)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + right, y + down, steps=steps)
        self.page.mouse.up()
        self.settled(before)

    def entered(self, key: str, text: str) -> Locator:
        """Type into the field of a key, and wait for the answer; return the field."""
        before = self.asked
        field = self.page.locator(f'[data-key="{key}"]')
        field.fill(text)
        field.press("Enter")
        self.settled(before)
        return field


@contextmanager
def visited(
    browser: Browser, server: Server, width: int = 1440, height: int = 900, *, touch: bool = False
) -> Iterator[Visit]:
    """Open the page of a server in a tab with storage of its own, and wait for its first law."""
    context = browser.new_context(viewport={"width": width, "height": height}, has_touch=touch)
    try:
        context.add_init_script(path=SCRIPT)
        page = context.new_page()
        visit = Visit(page, server)
        page.on("request", lambda asked: visit.requests.append(asked.url))
        page.on("console", lambda said: visit.errors.append(said.text) if said.type == "error" else None)
        page.on("pageerror", lambda error: visit.errors.append(str(error)))
        start = time.perf_counter()
        page.goto(server.address)
        visit.settled()
        visit.seconds = time.perf_counter() - start
        yield visit
    finally:
        context.close()


def latencies(visit: Visit, handle: str, moves: list[tuple[float, float]]) -> list[float]:
    """Milliseconds from each move of a dragged handle [pixels] to its law and heights on the screen."""
    page = visit.page
    page.evaluate("probe.watch")
    x, y = visit.middle(handle)
    asked = visit.asked
    page.mouse.move(x, y)
    page.mouse.down()
    times: list[float] = []
    for right, down in moves:
        before = page.evaluate("() => { seen.moves = []; return [seen.drawn.length, seen.sent]; }")
        page.mouse.move(x + right, y + down)
        page.wait_for_function("probe.drawn", arg=before, polling=5)
        count, taken = page.evaluate("() => [seen.drawn.length, seen.drawn.at(-1) - seen.moves.at(-1)]")
        times += [float(taken)] if count > before[0] else []
    page.mouse.up()
    visit.settled(asked)
    return times
