"""Forms of sections and keys, against the manual and the sections themselves."""

import pytest

from metafem.files import all_keys, section_forms
from metafem.files.specification.contents import Sections

FORMS = {form.name: form for form in section_forms()}
KEYS = [(form, kind, key) for form in FORMS.values() for kind, keys in form.keys.items() for key in keys]


def test_the_forms_are_those_of_the_manual_in_its_order():
    assert [name for name in FORMS if "." not in name] == list(Sections.model_fields)
    found = [(form.name, kind or None, key.name) for form, kind, key in KEYS if "." not in form.name]
    assert found == [(key.section, key.kind, key.name) for key in all_keys()]
    assert list(FORMS["contact.cap"].kinds) == ["hertz", "elastic", "sphere", "power", "profile"]


@pytest.mark.parametrize(("form", "kind", "key"), KEYS)
def test_the_example_has_the_form(form, kind, key):
    entries = key.example if key.listed else [key.example]
    entries = [part for entry in entries for part in (entry if isinstance(entry, list) else [entry])]
    kinds = {"quantity": str, "text": str, "number": float, "integer": int, "truth": bool, "section": dict}
    if key.example is not None:
        assert all(type(entry) is kinds[key.value] for entry in entries)
        assert key.pairs == (key.example != entries and key.listed and key.value == "quantity")
    if key.value == "quantity":
        assert key.units
        assert all(entry.split(" ")[1] in key.units for entry in entries)
    assert not key.names or set(entries) <= set(key.names)


def test_needed_keys_are_those_of_the_first_choice():
    needed = {(form.name, kind): [key.name for key in keys if key.needed]
              for form in FORMS.values() for kind, keys in form.keys.items()}  # fmt: skip
    assert needed["target", "sampled"] == ["rescaled_load", "rescaled_friction"]
    assert needed["material", ""] == ["composite_modulus"]
    assert needed["limits", ""] == ["max_height"]
