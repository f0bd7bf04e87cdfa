"""Changed specifications and tables are read or refused in one sentence; no other error is raised."""

import random
import re
from functools import partial

import pytest

import metafem as mf
from metafem import files
from tests.core.files.test_labs import TABLES

WORDS = ["-", "nan", "1e400", "1.5", "[]", "{}", "true", '"', "\x00", "µ", "Mm", "'1,5'", "=", "[[", ";", ","]
CONTENTS = [each[0] if isinstance(each, tuple) else each for each in TABLES.values()]


def changed(text, rng):
    """Return a text of which one or two words or lines are replaced, removed or repeated."""
    for _ in range(rng.randint(1, 2)):
        parts = re.split(rng.choice([r"(\W+)", r"(\n)", r"( = )"]), text)
        i = rng.randrange(len(parts))
        parts[i] = rng.choice([rng.choice(WORDS), parts[i] * 2, rng.choice(parts), parts[i][1:]])
        text = "".join(parts)
    return text


@pytest.mark.parametrize("seed", range(2))
def test_no_change_is_a_traceback(seed, tmp_path):
    rng, path = random.Random(seed), tmp_path / "t.csv"
    for _ in range(80):
        text = changed(files.demo_text(rng.choice(files.DEMOS)), rng)
        path.write_bytes(changed(rng.choice(CONTENTS).decode("latin-1"), rng).encode("latin-1", "replace"))
        for call in (partial(files.parsed, text), partial(files.read_calibration, [path])):
            said = ""
            try:
                call()
            except mf.InvalidInput as error:
                said = str(error)
            for line in said.splitlines():
                assert re.match(r"(spec\.toml|.*\.csv).{10,700}$", line)
