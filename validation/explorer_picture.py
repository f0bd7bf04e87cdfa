"""The README's picture of the explorer, taken in the system's browser."""

from __future__ import annotations

from pathlib import Path

from validation.scenes.browser import browser_path, opened
from validation.scenes.explorer import served, visited

PICTURE = Path(__file__).with_name("explorer.png")

# Size of the window [pixels]: all parts of the page are seen at once.
WIDTH, HEIGHT = 1400, 860

# Load of the picture, in steps of the slider from the smallest to the largest load, and the time in which the
# surface is drawn [ms].
LOAD, DRAWN = "150", 4000.0


def renew_picture() -> None:
    """Take the picture of the explorer, with the surface pressed; where no browser is installed, it stays."""
    if browser_path() is None:
        return
    with opened() as browser, served() as server, visited(browser, server, WIDTH, HEIGHT) as visit:
        visit.page.get_by_role("tab", name="3D").click()
        visit.page.get_by_label("Load", exact=True).fill(LOAD)
        visit.at_rest()
        visit.page.wait_for_timeout(DRAWN)
        visit.page.screenshot(path=PICTURE)


if __name__ == "__main__":
    renew_picture()
