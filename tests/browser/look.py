"""Opens pages in the browser that is installed, and says what is wrong with them."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

# Widths of a desk and of a telephone [px], each with the scheme of colours that is looked at.
VIEWS = {"wide": (1300, "light"), "narrow": (390, "light"), "dark": (1300, "dark")}

HEIGHT = 1000

# Elements that are wider than the window although nothing around them scrolls, pictures without an area, and
# text that has the colour of what is behind it.
FAULTS = """() => {
  const faults = [];
  if (document.documentElement.scrollWidth > window.innerWidth)
    faults.push(`the page is ${document.documentElement.scrollWidth} px wide in ${window.innerWidth} px`);
  for (const each of document.querySelectorAll("svg[role], main svg, img")) {
    const box = each.getBoundingClientRect();
    if (each.checkVisibility() && Math.min(box.width, box.height) < 1) faults.push("a picture is empty");
    if (each.tagName === "IMG" && !each.naturalWidth) faults.push(`an image is missing: ${each.src}`);
  }
  const colour = (each) => getComputedStyle(each).color;
  const ground = getComputedStyle(document.body).backgroundColor;
  if (colour(document.body) === ground) faults.push("the text has the colour of the page");
  if (!document.title) faults.push("the page has no title");
  return faults;
}"""


@contextmanager
def browser() -> Iterator:
    """Start the browser; skip the test, with the reason, where there is none."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("chromium is not installed")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        try:
            yield started
        finally:
            started.close()


def faults(started, path: Path, views: tuple[str, ...] = tuple(VIEWS)) -> list[str]:
    """Open a page once and return its errors on the console, its requests, and what is badly laid out."""
    found = []
    requests = []
    page = started.new_page()
    page.on("console", lambda message: found.append(f"console: {message.text}"))
    page.on("pageerror", lambda error: found.append(f"error: {error}"))
    page.on("request", lambda request: requests.append(request.url))
    try:
        address = path.resolve().as_uri()
        page.goto(address, wait_until="load")
        for view in views:
            width, scheme = VIEWS[view]
            page.set_viewport_size({"width": width, "height": HEIGHT})
            page.emulate_media(color_scheme=scheme)
            found += [f"{view}: {each}" for each in page.evaluate(FAULTS)]
    finally:
        page.close()
    found += [f"request: {url[:100]}" for url in requests if url != address and not url.startswith("data:")]
    return [f"{path.name}: {each}" for each in found]
