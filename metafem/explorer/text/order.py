"""The order of sections and keys in a specification."""

from __future__ import annotations

from metafem.files import SectionForm, section_forms


def form_of(section: str) -> SectionForm | None:
    """Return the form of a section such as ``limits`` or ``contact.cap``; None for an unknown section.

    Examples
    --------
    >>> form_of("limits").optional
    False
    """
    return next((form for form in section_forms() if form.name == section), None)


def section_order() -> tuple[str, ...]:
    """Return the names of the top-level sections in the order of the manual."""
    return tuple(form.name for form in section_forms() if "." not in form.name)


def key_order(section: str, kind: object = "") -> tuple[str, ...]:
    """Return the keys of a section of a given kind in the order of the manual; none if either is unknown.

    Examples
    --------
    >>> key_order("contact", "kogut-etsion")
    ('kind', 'hardness')
    """
    form = form_of(section)
    if form is None:
        return ()
    names = tuple(key.name for key in form.keys.get(str(kind) if form.kinds else "", ()))
    return ("kind", *names) if form.kinds else names
