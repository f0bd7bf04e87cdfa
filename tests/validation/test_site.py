"""The pages of the examples and of the reference: public names, docstrings, links, equal bytes."""

import importlib
import inspect
import re
from functools import cache
from importlib.util import find_spec
from urllib.parse import unquote

import pytest

import metafem as mf
from metafem import _extras
from tests.test_docstrings import MODULES
from validation.site import write_api, write_site
from validation.site.api import address_on, call
from validation.site.docstrings import html, summary
from validation.site.interface import Entry, addresses, inherited, members, pages

# Largest page that still opens at once, in bytes.
LARGEST = 3_000_000


def nowhere(name):
    """No name has an address."""


def test_every_public_name_has_a_place():
    shown = {id(entry.value) for page in pages().values() for entry in page.entries}
    for module in map(importlib.import_module, MODULES):
        for name in module.__all__:
            value = getattr(module, name)
            assert inspect.ismodule(value) or id(value) in shown, f"{module.__name__}.{name}"


def test_names_are_found_in_the_forms_in_which_texts_mention_them():
    for name in ("Surface", "mf.Surface", "metafem.Surface", "mf.fe.press", "metafem.studies.manufacturing"):
        assert addresses()[name].endswith(f"#{name.rpartition('.')[2]}")
    assert addresses()["Surface.tilted"] == "metafem.html#Surface.tilted"
    assert addresses()["mf.studies"] == "metafem.studies.html"
    # an argument of the same name is no link
    address = address_on(pages()["metafem"])
    assert address("design") is address("contact") is address("load") is None
    assert address("arrange") == "metafem.html#arrange"
    assert address("mf.design") == "metafem.html#design"
    assert address_on(pages()["metafem.studies"])("Check") == "metafem.studies.html#Check"


def test_members_are_those_for_users():
    names = [member.name for member in members(mf.LinearLaw)]
    assert "from_friction_coefficient" in names
    assert not {"candidate", "refuse", "guesses"} & set(names)  # they take internal types
    assert {"fit", "plot", "to_dataframe"} <= {member.name for member in members(mf.FrictionLaw)}
    assert "indentation" in inherited(mf.Hertz)["Contact"]
    assert members(mf.DesignStatus) == []
    assert Entry("Status", mf.Status).constants


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Load P/E* [mm^2] and w/E* of A*.", "<p>Load P/E* [mm²] and w/E* of A*.</p>"),
        ("*Rescaled* means P/E*.", "<p><em>Rescaled</em> means P/E*.</p>"),
        ("0 < h <= R and h_i, h_j.", "<p>0 &lt; h &lt;= R and h_i, h_j.</p>"),
        ("The line ``F = m P*`` of `law`.", "<p>The line <code>F = m P*</code> of <code>law</code>.</p>"),
        ("``(<R>/<sqrt R>)^2``", "<p><code>(&lt;R&gt;/&lt;sqrt R&gt;)^2</code></p>"),
        ("See doi:10.1126/science.adk4234.", '<p>See <a href="https://doi.org/10.1126/science.adk4234">'
         "doi:10.1126/science.adk4234</a>.</p>"),
        ("(doi:10.1016/0020-7225(65)90019-4)", '<p>(<a href="https://doi.org/10.1016/0020-7225(65)90019-4">'
         "doi:10.1016/0020-7225(65)90019-4</a>)</p>"),
    ],
)  # fmt: skip
def test_docstrings_mean_what_they_say(text, expected):
    assert html(text, nowhere).strip() == expected


def test_sections_of_docstrings_are_lists_and_code():
    text = html(inspect.getdoc(mf.Limits), lambda name: f"#{name}" if name == "InvalidInput" else None)
    assert "<h4>Parameters</h4>" in text
    assert '<li><b>max_height</b> <span class="quiet">float</span><br>Largest h [mm], positive' in text
    assert '<li><b><a href="#InvalidInput">InvalidInput</a></b><br>If a value' in text
    assert re.search(r"<pre>.*gp.*Limits.*max_height", text, re.DOTALL)
    assert summary("A law.\n\nMore.", nowhere) == "A law."


def test_calls_are_those_of_the_source():
    assert call(mf.Material, nowhere) == "(composite_modulus: float, poisson_ratio: float = 0.5)"
    text = call(mf.equilibrium, lambda name: f"#{name}")
    assert 'surface: <a href="#Surface">Surface</a>' in text
    assert "\n    *,\n" in text
    assert text.endswith('→ <a href="#ContactState">ContactState</a>')
    assert "Interacting" in addresses()
    assert call(mf.BoundaryElements, nowhere).endswith(
        "substrate: Radial = HalfSpace(), contact: Contact = Hertz())"
    )


def test_the_extra_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setattr(_extras, "find_spec", lambda name: None if name == "pdoc" else find_spec(name))
    with pytest.raises(mf.InvalidInput, match=r"needs the extra docs: pip install 'metafem\[docs\]'"):
        write_api(tmp_path)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder of the pages, and their addresses."""
    folder = tmp_path_factory.mktemp("site")
    return folder, write_site(folder)


@pytest.mark.slow
def test_pages_are_equal_to_the_byte_and_name_no_machine(site, tmp_path):
    folder, names = site
    assert write_site(tmp_path) == names
    files = sorted(path.relative_to(folder) for path in folder.rglob("*.*"))
    assert files == sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*.*"))
    assert {str(path) for path in files if path.suffix == ".html"} == set(names)
    for name in files:
        data = (folder / name).read_bytes()
        assert data == (tmp_path / name).read_bytes(), name
        assert len(data) < LARGEST
        assert not re.search(rb"/tmp/|/home/|/root/|0x[0-9a-f]{7,}", data), name


@pytest.mark.slow
def test_links_lead_somewhere(site):
    folder, names = site

    @cache
    def anchors(path):
        return set(re.findall(r' id="([^"]+)"', path.read_text("utf-8")))

    for name in names:
        path = folder / name
        for link in re.findall(r' href="([^"]+)"', path.read_text("utf-8")):
            if link.startswith(("https://doi.org/", "data:")):
                continue
            file, _, anchor = link.partition("#")
            target = (path.parent / file).resolve() if file else path
            if target.is_relative_to(folder / "api") or target.is_relative_to(folder / "examples"):
                assert target.exists(), f"{name}: {link}"
                assert not anchor or unquote(anchor) in anchors(target), f"{name}: {link}"
            else:  # pages that the report writes
                assert target.parent in (folder, folder / "guide"), f"{name}: {link}"


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
