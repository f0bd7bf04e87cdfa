"""Pages opened in a browser without a window: and what is wrong with them."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# The browser of the system, by its names on Linux; playwright brings none of its own.
NAMES = ("chromium", "chromium-browser", "google-chrome")

# What a page may link to outside its folder.
OUTSIDE = ("https:", "data:", "mailto:")

# Height of the longest page on a phone, which is so wide [px].
TALLEST, PHONE = 20_000, 390


@dataclass(frozen=True)
class View:
    """How a page is looked at."""

    name: str
    width: int
    dark: bool = False


VIEWS = (View("wide", 1280), View("narrow", PHONE), View("dark", 1280, dark=True))


def browser_path() -> str | None:
    """Return the path of the system's browser, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def opened() -> Iterator[Browser]:
    """Start the system's browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
        try:
            yield browser
        finally:
            browser.close()


def problems(browser: Browser, *paths: Path, views: tuple[View, ...] = VIEWS) -> list[str]:
    """Open files one after the other, look at each in each view, and return what is wrong with them."""
    found: list[str] = []
    page = browser.new_page()
    page.add_init_script(path=Path(__file__).with_suffix(".js"))
    page.on("console", lambda said: found.append(f"console: {said.text}") if said.type == "error" else None)
    page.on("pageerror", lambda error: found.append(f"error: {error}"))
    page.on("request", lambda asked: found.extend(_foreign(asked.url, own)))
    anchors = cache(_anchors)
    problems = []
    try:
        for path in paths:
            own = path.resolve().as_uri()
            found.clear()
            page.goto(own)
            links = page.evaluate("probe.links")
            for view in views:
                page.set_viewport_size({"width": view.width, "height": 900})
                page.emulate_media(color_scheme="dark" if view.dark else "light")
                found += [f"{view.name}: {each}" for each in _shown(page.evaluate("probe.measure"), view)]
            found += [] if page.title() else ["it has no title"]
            found += [each for link in links for each in _broken(link, path, anchors)]
            problems += [f"{path.name}: {each}" for each in found]
    finally:
        page.close()
    return problems


def _shown(shown: dict[str, Any], view: View) -> list[str]:
    """Return what is wrong with what a view shows."""
    found = [f"the anchor {each} stands twice" for each in sorted(set(shown["repeated"]))]
    if shown["overflow"] > 0:
        found.append(f"the page is {shown['overflow']} px wider than its window of {view.width} px")
    if view.width <= PHONE and shown["tall"] > TALLEST:
        found.append(f"the page is {shown['tall']} px tall; at most {TALLEST}")
    if shown["empty"] or shown["broken"]:
        found.append(f"{shown['empty']} pictures have no size, {shown['broken']} are broken")
    if shown["ground"] == shown["ink"] or (shown["ground"] < shown["ink"]) != view.dark:
        found.append(f"ground of tone {shown['ground']:.2f} and text of tone {shown['ink']:.2f}")
    return found


def _foreign(address: str, own: str) -> list[str]:
    """Return a request that is neither for the page itself nor for data that it holds."""
    return [] if address.partition("#")[0] == own or address.startswith("data:") else [f"request: {address}"]


def _broken(link: str, path: Path, anchors: Callable[[Path], set[str]]) -> list[str]:
    """Return what is wrong with a link of a page."""
    if link.startswith(OUTSIDE):
        return []
    parts = urlsplit(link)
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if parts.scheme or not target.is_file():
        return [f"link to {link}, which does not exist"]
    if parts.fragment and unquote(parts.fragment) not in anchors(target):
        return [f"link to {link}, whose anchor does not exist"]
    return []


def _anchors(path: Path) -> set[str]:
    """Return the anchors of a page."""
    return set(re.findall(r'\bid="([^"]+)"', path.read_text("utf-8")))
