"""The validation report as one HTML page, and its summary for the README."""

from __future__ import annotations

from metafem.drawing import svg
from validation.chapters import CHAPTERS
from validation.check import Claim, Picture
from validation.discovery import module
from validation.published import REFERENCE

TEMPLATE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>metafem: validation</title>
<style>
body { margin: 0 auto; max-width: 1060px; padding: 24px 20px 60px; color: #1f2933;
  font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h2 { margin: 34px 0 8px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 4px 14px 4px 0; border-bottom: 1px solid #dfe3e8; vertical-align: top; }
th { color: #667078; } .failed td { color: #b3261e; font-weight: 600; }
.figures { display: flex; flex-wrap: wrap; gap: 16px; } svg { max-width: 100%; height: auto; }
</style></head><body>
<h1>Validation of metafem</h1>
<p>{{ passed }} of {{ total }} checks passed. Every number is computed when this page is made.</p>
<p>{{ reference }}.</p>
{% for name, claim in results.items() %}
<h2>{{ claim.title }}</h2>
<p><code>{{ path(name) }}</code></p>
{% if claim.text %}<p>{{ claim.text }}</p>{% endif %}
<table><thead><tr><th>check</th><th>computed</th><th>expected</th><th>source</th></tr></thead><tbody>
{% for check in claim.checks %}
<tr{% if not check.passed %} class="failed"{% endif %}><td>{{ check.name }}</td>
<td>{{ "%.6g"|format(check.computed) }}</td><td>{{ check.expected }}</td><td>{{ check.source }}</td></tr>
{% endfor %}
{% for row in claim.results %}
<tr><td>{{ row.name }}</td><td>{{ "%.6g"|format(row.value) }}</td><td></td><td>{{ row.method }}</td></tr>
{% endfor %}
</tbody></table>
<div class="figures">{% for figure in drawn[name] %}{{ figure|safe }}{% endfor %}</div>
{% endfor %}
</body></html>
"""


def page(results: dict[str, Claim]) -> str:
    """Return the page with all figures drawn."""
    from jinja2 import Environment, StrictUndefined

    checks = [check for claim in results.values() for check in claim.checks]
    drawn = {
        name: [
            svg(each.draw() if isinstance(each, Picture) else each(), f"{claim.title}: {title}")
            for title, each in claim.figures.items()
        ]
        for name, claim in results.items()
    }
    return (
        Environment(autoescape=True, undefined=StrictUndefined)
        .from_string(TEMPLATE)
        .render(
            results=results,
            path=path,
            drawn=drawn,
            total=len(checks),
            passed=sum(check.passed for check in checks),
            reference=REFERENCE,
        )
    )


def readme_table(results: dict[str, Claim]) -> str:
    """Return the summary, one line for each chapter, in Markdown."""
    rows = ["| chapter | question | checks passed |", "|---|---|---|"]
    for chapter in CHAPTERS:
        checks = [check for name in chapter.claims if name in results for check in results[name].checks]
        if not checks:
            continue
        passed = sum(check.passed for check in checks)
        rows.append(f"| {chapter.title} | {chapter.question} | {passed} of {len(checks)} |")
    return "\n".join(rows)


def path(name: str) -> str:
    """Return the file of a claim, from the root of the repository."""
    return f"{module(name, 'claim').__name__.replace('.', '/')}.py"
