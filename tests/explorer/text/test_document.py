"""The values of a specification and the text that is written from them."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.explorer.text.document import Document, loses_comments
from metafem.files import demo_text, parsed, section_forms
from metafem.files.specification.models import DEMOS

TEXTS = {
    **{name: demo_text(name) for name in DEMOS},
    "inline": "# one\ntarget = {kind = 'linear', slope=6.87}\nlimits={ max_height=\"120 um\" } # two",
    "dotted": "target.kind = 'linear'\ntarget.slope = 6.87 # steep\n\nlimits . max_height = '120 um'",
    "split": "[contact]\nkind = 'jkr'\n[limits]\nmax_height = '3 um'\n[contact.cap]\nkind = 'sphere'\n",
    "lists": "[target]\nrescaled_load = [ '0.1 mm^2' , # first\n  '0.2 mm^2', # second\n]\n[part] # none\n",
    "quoted": "[\"limits\"]\n'max_height' = '''1\n[part] um'''\n[ layout ]\n\tseed=1\n",
    "unknown": "top = 2020-01-01\n[limits]\n'a b' = {x = [{}, {y = nan}]}\n[[mine]]\nx = -inf\n[[mine]]\n",
    "windows": "\ufeff[limits]\r\nmax_height = '120 um'\r\n",
    "empty": "",
}
KEYS = sorted(
    f"{form.name}.{key.name}"
    for form in section_forms()
    for keys in form.keys.values()
    for key in keys
    if key.value != "section" and "." not in form.name
)
VALUES = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_nan=False, allow_infinity=False),
    st.booleans(),
    st.lists(st.sampled_from(["0.1 mm^2", "0.2 mm^2", "it's"]), max_size=4),
    st.lists(st.lists(st.floats(0, 1), min_size=1, max_size=2), max_size=3),
)


def same(first, second):
    """Return whether two tables are equal, nan counted as equal to nan; an empty section counts as none."""
    kept = [{name: value for name, value in table.items() if value != {}} for table in (first, second)]
    return repr(sorted_table(kept[0])) == repr(sorted_table(kept[1]))


def sorted_table(value):
    if isinstance(value, dict):
        return sorted((name, sorted_table(each)) for name, each in value.items())
    return value


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(sorted(TEXTS)), st.sampled_from(KEYS), VALUES)
def test_a_value_that_is_set_is_read_back_and_all_other_values_stay(name, key, value):
    text = TEXTS[name]
    new = Document(text).with_values({key: value})
    section, _, name = key.partition(".")
    wanted = Document(text).table
    wanted.setdefault(section, {})[name] = value
    assert same(Document(new).table, wanted)
    assert Document(new).with_values({key: value}) == new


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(sorted(TEXTS)), st.sampled_from(KEYS))
def test_a_key_that_is_removed_leaves_all_other_values(name, key):
    text = TEXTS[name]
    new = Document(text).with_values({key: None})
    section, _, name = key.partition(".")
    wanted = Document(text).table
    wanted.get(section, {}).pop(name, None)
    assert same(Document(new).table, wanted)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_change_that_changes_nothing_returns_the_same_text(text):
    document = Document(text)
    found = {f"{name}.{key}": value for name, table in document.table.items() if isinstance(table, dict)
             for key, value in table.items()}  # fmt: skip
    assert document.with_values(found) == document.with_values({"checks.hardness": None}) == text
    if document.section("target"):
        assert document.with_kind("target", document.value("target.kind"), document.section("target")) == text
    number = Document("[limits]\noffset = 1\n")
    assert number.with_values({"limits.offset": 1.0}) != number.text


WRITTEN = """[target]
kind = "linear"
slope = 6.5

[lattice]
pitch = "1.5 mm"
shape = [8, 8]

[tools]
radii = ["300 um", "526 um"]

[limits]
max_height = "120 um"
min_height = "10 um"
offset = "50 um"

[contact]
kind = "jkr"
adhesion_energy = "9 mJ/m^2"

[contact.cap]
kind = "sphere"

[mine]
b = 1
a = "µ"
"""


def test_a_changed_text_is_written_in_the_order_of_the_manual():
    text = """mine = {b = 1, a = 'µ'}
    [limits] # of the shop
    offset = '50 um'
    max_height = "120 um"
    [contact]
    cap.kind = 'sphere'
    kind = 'jkr'
    adhesion_energy = '9 mJ/m^2'
    [lattice]
    pitch = "1.5 mm"
    shape = [
        8, 8]
    radius = "526 um"
    """
    values = {"target.slope": 6.5, "target.kind": "linear", "limits.min_height": "10 um"}
    new = Document(text).with_values({**values, "lattice.radius": None, "tools.radii": ["300 um", "526 um"]})
    assert new == WRITTEN
    assert Document(new).with_values({"limits.min_height": "12 um"}) == WRITTEN.replace("10 um", "12 um")


def test_an_optional_section_is_removed_with_its_last_key():
    text = "[checks]\nhardness = '1 MPa'\n[limits]\nmax_height = '1 um'\n"
    assert Document(text).with_values({"checks.hardness": None}) == '[limits]\nmax_height = "1 um"\n'
    assert Document(text).with_values({"limits.max_height": None}).startswith("[limits]\n")


def problems_of(text):
    try:
        parsed(text)
    except mf.InvalidInput as error:
        return error.problems
    return ()


def kinds():
    return [(form.name, kind) for form in section_forms() for kind in form.kinds if "." not in form.name]


@pytest.mark.parametrize(("section", "kind"), kinds())
def test_another_kind_has_the_keys_it_needs_and_no_others(section, kind):
    text = demo_text("bilinear")
    new = Document(text).with_kind(section, kind)
    problems = problems_of(new)  # the examples of the manual may be of another scale
    assert not any(
        word in problem for problem in map(str, problems) for word in ("missing", "unknown", "needs")
    )
    form = next(form for form in section_forms() if form.name == section)
    assert set(Document(new).value(section)) <= {"kind", *(key.name for key in form.keys[kind])}
    untouched = {key: value for key, value in tomllib.loads(new).items() if key != section}
    assert untouched == {key: value for key, value in tomllib.loads(text).items() if key != section}


def test_the_cap_of_adhesive_contacts_has_a_kind_too():
    text = Document(demo_text("linear")).with_kind("contact", "jkr")
    text = Document(text).with_kind("contact.cap", "power")
    assert Document(text).value("contact.cap") == {"kind": "power", "exponent": 4.0}
    text = Document(text).with_kind("contact.cap", "sphere")
    assert parsed(text).model.contact == mf.JKR(9e-6, mf.SphericalCap())


def test_a_text_that_is_not_toml_cannot_be_edited():
    with pytest.raises(mf.InvalidInput, match="not valid TOML"):
        Document("[limits")


@pytest.mark.parametrize("text", ["limits = 3", "[[limits]]\n"])
def test_a_value_within_what_is_no_section_is_refused(text):
    with pytest.raises(mf.InvalidInput, match="limits is not a section in the text; write \\[limits\\]"):
        Document(text).with_values({"limits.max_height": "1 um"})


@pytest.mark.parametrize(
    ("line", "own"),
    [
        ("a = 1", False),
        ("a = '#' # mine", True),
        ("# mine", True),
        ('a = "\\"# a" # mine', True),
        ('a = "\\"# a"', False),
        ('a = \'\'\'\n# a\'\'\'\nb = """\n# \\"""\n # c"""', False),
        ("b = [1, # mine\n2]", True),
    ],
)
@pytest.mark.parametrize("name", DEMOS)
def test_comments_of_the_user_are_known_from_those_of_a_demo(name, line, own):
    text = f"{line}\n{demo_text(name)}"
    new = Document(text).with_values({"limits.max_height": "117 um"})
    assert loses_comments(text, new) == own
    assert not loses_comments(new, Document(new).with_values({"limits.max_height": "118 um"}))
    assert not loses_comments(text, text + "# more")
