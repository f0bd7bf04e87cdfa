"""The README's Python runs and prints what it says."""

import contextlib
import io
import re
from pathlib import Path

README = (Path(__file__).parent.parent / "README.md").read_text("utf-8")


def test_printed_output_is_what_the_example_prints():
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    output = re.search(r"```text\n(.*?)```", README, re.S).group(1)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue() == output
