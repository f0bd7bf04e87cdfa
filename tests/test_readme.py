"""The README's Python runs and prints what it says."""

import contextlib
import io
import re
from pathlib import Path

import pytest

from validation.__main__ import MARKS, claims, evaluate
from validation.page import readme_table

README = (Path(__file__).parent.parent / "README.md").read_text("utf-8")


def test_printed_output_is_what_the_example_prints():
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    output = re.search(r"```text\n(.*?)```", README, re.S).group(1)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue() == output


@pytest.mark.slow
def test_validation_table_is_the_one_that_is_computed():
    results = {name: evaluate(name) for name in claims()}
    assert f"{MARKS[0]}\n{readme_table(results)}\n{MARKS[1]}" in README
