"""Edits of a specification's text: the value is set, and all else stays as it was."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.explorer.text.document import Document, as_own
from metafem.files import demo_text, parsed, section_forms
from metafem.files.specification.models import DEMOS

TEXTS = {
    **{name: demo_text(name) for name in DEMOS},
    "inline": "# one\ntarget = {kind = 'linear', slope=6.87}\nlimits={ max_height=\"120 um\" } # two",
    "dotted": "target.kind = 'linear'\ntarget.slope = 6.87 # steep\n\nlimits . max_height = '120 um'",
    "split": "[contact]\nkind = 'jkr'\n[limits]\nmax_height = '3 um'\n[contact.cap]\nkind = 'sphere'\n",
    "lists": "[target]\nrescaled_load = [ '0.1 mm^2' , # first\n  '0.2 mm^2', # second\n]\n[part] # none\n",
    "quoted": "[\"limits\"]\n'max_height' = '''1\n[part] um'''\n[ layout ]\n\tseed=1\n",
    "empty": "",
    "remark": "# nothing but this",
}
FORMS = [
    lambda text: text,
    lambda text: text.removesuffix("\n"),
    lambda text: text.replace("\n", "\r\n"),
    lambda text: "\ufeff" + text.replace("\n", "\r\n").removesuffix("\r\n"),
]
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


def texts():
    return st.builds(
        lambda name, form: form(TEXTS[name]), st.sampled_from(list(TEXTS)), st.sampled_from(FORMS)
    )


@settings(max_examples=30, deadline=None)
@given(texts(), st.sampled_from(KEYS), VALUES)
def test_a_value_that_is_set_is_read_back_and_all_else_stays(text, key, value):
    new = Document(text).with_value(key, value)
    assert Document(new).value(key) == value
    section, _, name = key.partition(".")
    before, after = Document(text).table, Document(new).table
    before.setdefault(section, {})[name] = value
    assert after == before
    for comment in ("# one", "# two", "# steep", "# none", "# nothing but this"):
        assert (comment in new) == (comment in text)
    assert new.startswith("\ufeff") == text.startswith("\ufeff")
    if text and not isinstance(value, str):
        assert ("\r\n" in text) == ("\r\n" in new)
        if "\r\n" in text:
            assert "\n" not in new.replace("\r\n", "")
        assert new.endswith("\n") == text.endswith("\n")


@settings(max_examples=20, deadline=None)
@given(texts(), st.sampled_from(KEYS))
def test_a_key_that_is_removed_leaves_all_else(text, key):
    new = Document(text).without(key)
    assert Document(new).value(key) is None
    section, _, name = key.partition(".")
    before, after = Document(text).table, Document(new).table
    before.get(section, {}).pop(name, None)
    assert after.get(section, {}) == before.pop(section, {})
    after.pop(section, None)
    assert after == before


@pytest.mark.parametrize("form", FORMS)
def test_only_the_line_of_the_value_changes(form):
    text = form(demo_text("bilinear"))
    new = Document(text).with_value("limits.max_height", "1234 um")
    before, after = text.splitlines(keepends=True), new.splitlines(keepends=True)
    (pair,) = [pair for pair in zip(before, after, strict=True) if pair[0] != pair[1]]
    assert pair[0].index("#") == pair[1].index("#")  # the comment keeps its column
    assert Document(new).with_value("limits.max_height", "120 um") == text


@pytest.mark.parametrize("form", FORMS)
def test_a_key_is_added_in_the_order_of_the_manual_and_removed_again(form):
    text = form(demo_text("linear"))
    new = Document(text).with_value("limits.min_height", "10 um")
    names = [line.split(" ")[0] for line in new.split("[limits]")[1].split("[layout]")[0].splitlines()[1:]]
    assert names[:3] == ["max_height", "min_height", "offset"]
    assert Document(new).without("limits.min_height") == text


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("key", "value", "after", "before"),
    [
        ("tools.radii", ["300 um", "526 um"], "[lattice]", "[block]"),
        ("contact.kind", "sphere", "[model]", "[part]"),
        ("checks.hardness", "10 MPa", "[part]", None),
    ],
)
def test_a_section_is_made_in_the_order_of_the_manual_and_removed_again(form, key, value, after, before):
    text = form(demo_text("linear"))
    new = Document(text).with_value(key, value)
    section = f"[{key.partition('.')[0]}]"
    assert new.index(after) < new.index(section) < (new.index(before) if before else len(new))
    newline = "\r\n" if "\r\n" in text else "\n"
    assert f"{newline}{newline}{section}{newline}" in new
    assert Document(new).without(key).rstrip() == text.rstrip()


def test_entries_of_a_list_keep_their_comments():
    text = TEXTS["lists"]
    new = Document(text).with_value("target.rescaled_load", ["0.1 mm^2", "0.15 mm^2", "0.2 mm^2"])
    assert "# first\n" in new
    assert "'0.2 mm^2', # second" in new
    assert Document(new).with_value("target.rescaled_load", ["0.1 mm^2", "0.2 mm^2"]) == text


def test_a_section_is_removed_with_its_last_key_but_not_the_comment_of_the_next():
    text = "[checks]\nhardness = '1 MPa' # H\n# of the sphere\n\n# Limits of the shop\n[limits]\n"
    assert Document(text).without("checks.hardness") == "# Limits of the shop\n[limits]\n"
    assert Document("[limits]\nmax_height = '1 um'\n").without("limits.max_height") == "[limits]\n"


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
        Document(text).with_value("limits.max_height", "1 um")


def test_an_own_law_loses_the_comment_about_the_law_of_the_demo():
    text = demo_text("operating-points")
    assert as_own(text) == text
    assert as_own(text.replace('"270 um"', '"280 um"')).startswith("# A friction law through three")
    own = as_own(text.replace('"4.12 mm^2"', '"4.1 mm^2"'))
    assert own.startswith("# Every kind of law")
    assert "Fig. 3" not in own
    assert "[part]" in own
