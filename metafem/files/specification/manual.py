"""Manual of the sections and keys of a specification, generated from their definitions."""

from __future__ import annotations

from typing import Any

from metafem.files.specification.forms import as_toml, section_forms

HEAD = """\
# Every section and key of a specification for `metafem design`, each with an example value. This is a list,
# not a file to read: a specification has one kind of target, and one of the keys marked either and or.
# Sections and keys are required unless they are marked optional. Lengths, areas, forces, stresses and
# angles are written with their unit. `metafem demo linear` writes a whole example file.
# `metafem spec --schema` prints the JSON schema, by which an editor completes keys and marks errors.
# The misfit of a design is the rms of the relative difference between the law and the target or, if larger,
# the largest relative error of a fitted slope. For operating points, and for linear and bilinear laws with a
# load_range, it is the largest relative error. Above 1 % (and the errors of samples) the target is missed.
# Linear and bilinear laws without a load_range are compared with the law of their height density: above 1 %
# a note says so, above 10 % the target is missed.
"""

# Column in which the comments begin; most examples are shorter.
COLUMN = 48

# First words of the meaning of a key in an alternative set of keys, of which one set is required.
CHOICES = ("either: ", "or: ", "with it: ")


def manual() -> str:
    """Return the text that `metafem spec` prints.

    Examples
    --------
    >>> text = manual()
    >>> print(text[text.index("[checks]") :], end="")
    [checks]                                        # optional: further checks
    hardness = "10 MPa"                             # optional: H, which decides on a plastic law
    """
    lines = [HEAD]
    for form in section_forms():
        if "." in form.name:
            continue
        lines.append(_line(f"[{form.name}]", form.meaning, form.optional, None))
        for kind, keys in form.keys.items():
            if kind:
                lines += ["", _line(f'kind = "{kind}"', form.kinds[kind], False, None)]
            lines += [
                _line(f"{key.name} = {as_toml(key.example)}", key.meaning, key.optional, key.default)
                for key in keys
            ]
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def remark(meaning: str, optional: bool, default: Any) -> str:
    """Return the meaning of a key or section, preceded by "optional" and the default where these apply."""
    told = "optional: " if optional and not meaning.startswith(CHOICES) else ""
    if default is not None:
        told = f"optional, default {f'{default:g}' if isinstance(default, float) else as_toml(default)}: "
    return f"{told}{meaning}"


def _line(start: str, meaning: str, optional: bool, default: Any) -> str:
    return f"{start:<{COLUMN - 1}} # {remark(meaning, optional, default)}"
