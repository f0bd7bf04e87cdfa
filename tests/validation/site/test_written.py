"""The written pages: equal bytes, no machine, whole examples."""

import re

import pytest

from validation.site import write_site

# Largest page that still opens at once, in bytes.
LARGEST = 3_000_000


# The folders of the site whose pages need no claims.
FOLDERS = ("api", "challenge", "examples", "guide")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder of the pages, and their addresses."""
    folder = tmp_path_factory.mktemp("site")
    return folder, write_site(folder)


@pytest.mark.slow
def test_pages_are_equal_to_the_byte_and_name_no_machine(site, whole_site):
    folder, names = site
    files = sorted(path.relative_to(folder) for path in folder.rglob("*.*"))
    other = [path for name in FOLDERS for path in (whole_site / name).rglob("*.*")]
    assert files == sorted(path.relative_to(whole_site) for path in other)
    assert {str(path) for path in files if path.suffix == ".html"} == set(names)
    for name in files:
        data = (folder / name).read_bytes()
        assert data == (whole_site / name).read_bytes(), name
        assert len(data) < LARGEST
        assert not re.search(rb"/tmp/|/home/|/root/|0x[0-9a-f]{7,}", data), name


@pytest.mark.slow
def test_pages_show_examples_whole(site):
    folder, _ = site
    text = (folder / "examples" / "e01_hertz.html").read_text("utf-8")
    for part in (
        "Hertz's law",
        "contact radius 179.69 µm",
        "<svg",
        "Data (CSV)",
        'href="e01_hertz.py" download',
    ):
        assert part in text.replace("&#39;", "'"), part
    assert '<a href="../api/metafem.html#equilibrium">' in text
    index = (folder / "examples" / "index.html").read_text("utf-8")
    assert index.count("<svg") == len(list((folder / "examples").glob("*.py")))
