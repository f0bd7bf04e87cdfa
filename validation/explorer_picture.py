"""The README's picture of the explorer, taken in the system's browser."""

from __future__ import annotations

from pathlib import Path

from validation.scenes.browser import browser_path, opened
from validation.scenes.explorer import served, visited

PICTURE = Path(__file__).with_name("explorer.png")

# Size of the window [pixels]: all parts of the page are seen at once.
WIDTH, HEIGHT = 1280, 860


def renew_picture() -> None:
    """Take the picture of the explorer's first page; where no browser is installed, it stays."""
    if browser_path() is None:
        return
    with opened() as browser, served() as server, visited(browser, server, WIDTH, HEIGHT) as visit:
        visit.page.screenshot(path=PICTURE)


if __name__ == "__main__":
    renew_picture()
