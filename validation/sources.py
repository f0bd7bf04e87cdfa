"""Where the expected number of a check comes from: six kinds of source, each of which can be followed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import metafem as mf

PAPER_DOI = "10.1126/science.adk4234"

# What a place in the paper begins with; SM is a section of its Supplementary Materials.
PLACE = re.compile(r"(Figs?\.|Tables?|eqs?\.|SM,|main text)")

DOI = re.compile(r"10\.\d{4,}/\S+$")


class Kind(Enum):
    """The kinds of source, in the words of the report."""

    PAPER = "printed in the paper"
    PUBLICATION = "another publication"
    CLOSED_FORM = "closed form"
    SECOND_METHOD = "second method in the same run"
    SELF_CONSISTENCY = "self-consistency"
    KNOWN_INPUT = "known by construction"


@dataclass(frozen=True)
class Source:
    """A kind of source, what it says, and the address of a publication, if it is one.

    A number of the paper that metafem computes has a quantity, under which it is checked once.
    """

    kind: Kind
    text: str
    link: str = ""
    quantity: str = field(default="", compare=False)

    def __str__(self) -> str:
        return self.text


def printed(place: str, quantity: str = "") -> Source:
    """Return the source of a number that the paper prints at a place, such as "Fig. 4 caption".

    Without a quantity it is a bound or a statement, no number that is recomputed.
    """
    if not PLACE.match(place):
        raise ValueError(f"place = {place!r} must begin with Fig., Table, eq., SM, or main text")
    return Source(Kind.PAPER, place, f"https://doi.org/{PAPER_DOI}", quantity)


def publication(doi: str, place: str) -> Source:
    """Return the source of a number or equation of another publication."""
    if not DOI.match(doi):
        raise ValueError(f"doi = {doi!r} must be a DOI, such as 10.1098/rspa.1971.0141")
    return Source(Kind.PUBLICATION, f"{place}, doi:{doi}", f"https://doi.org/{doi}")


def closed_form(function: Callable[..., Any], equation: str) -> Source:
    """Return the source of a number that a function of `metafem.reference` gives in this run."""
    if not function.__module__.startswith("metafem.reference"):
        raise ValueError(f"function = {_named(function)} must be a function of metafem.reference")
    return Source(Kind.CLOSED_FORM, f"{equation}, {_named(function)}")


def second_method(method: Callable[..., Any], words: str) -> Source:
    """Return the source of a number that another method, a function or class, computes in this run.

    A method of metafem judges metafem by itself: its kind is self-consistency.
    """
    if method.__module__.partition(".")[0] == mf.__name__:
        return self_consistency(method, words)
    return Source(Kind.SECOND_METHOD, f"{words}, {_named(method)}")


def self_consistency(method: Callable[..., Any], words: str) -> Source:
    """Return the source of a number that metafem computes in another way, or from its own equations."""
    return Source(Kind.SELF_CONSISTENCY, f"{words}, {_named(method)}")


def known_input(words: str) -> Source:
    """Return the source of a number that the check itself puts in: a true value, a target, an identity."""
    return Source(Kind.KNOWN_INPUT, words)


def _named(function: Callable[..., Any]) -> str:
    """Return the public name of a function or class, or else its module and name."""
    name = function.__qualname__
    for package in (mf, mf.fe):
        if getattr(package, name, None) is function:
            return f"{package.__name__}.{name}"
    return f"{function.__module__}.{name}"
