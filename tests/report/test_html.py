"""Templates: one base, and the contents made of the headings."""

import pytest
from jinja2 import UndefinedError

from metafem.report.html import headings, render

PAGE = """{% extends "base.html" %}{% from "macros.html" import table %}
{% block title %}A & B{% endblock %}
{% block navigation %}{{ bar|safe }}{% endblock %}
{% block main %}<h2 id="one">First <b>part</b></h2>{{ table(["<x>"], [["&"]]) }}{% endblock %}
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "own.html").write_text(PAGE, "utf-8")
    return tmp_path


def test_headings_are_the_contents(folder):
    assert headings('<h2 id="a">A <i>b</i></h2><h2>without</h2>') == [("a", "A b")]
    text = render("own.html", folder, bar="")
    assert text.startswith("<!doctype html>")
    assert text.count('<a href="#one">First part</a>') == 2  # at the side, and unfolded where it is narrow
    assert 'class="bar"' not in text
    assert 'class="bar"' in render("own.html", folder, bar="<a href='x.html'>x</a>")


def test_texts_are_escaped_and_values_must_exist(folder):
    text = render("own.html", folder, bar="")
    assert "<th>&lt;x&gt;</th>" in text
    assert "<td>&amp;</td>" in text
    with pytest.raises(UndefinedError, match="'bar' is undefined"):
        render("own.html", folder)
