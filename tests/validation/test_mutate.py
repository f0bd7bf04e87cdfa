"""The list of mutants fits the package, and what is noticed is told."""

import click
import pytest

from validation.mutate import ROOT, UNCHANGED, Mutant, Noticed, chosen, mutants
from validation.results import claims

LISTED = mutants()


def test_each_mutant_changes_one_place():
    assert len(LISTED) >= 30
    for each in LISTED.values():
        assert (ROOT / each.file).read_text("utf-8").count(each.old) == 1, each.name
        assert each.new != each.old, each.name
        assert each.file.startswith("metafem/"), each.name


def test_each_mutant_names_claims_and_default_tests():
    for each in LISTED.values():
        assert each.claims, each.name
        assert set(each.claims) <= set(claims()), each.name
        assert each.tests, each.name
        for path in each.tests:
            file, _, test = path.partition("::")
            assert f"def {test}(" in (ROOT / file).read_text("utf-8") if test else (ROOT / file).is_file(), (
                path
            )


def test_the_package_without_a_change_comes_first():
    name = next(iter(LISTED))
    first, second = chosen([name])
    assert first.name == UNCHANGED
    assert (list(first.claims), list(first.tests)) == (LISTED[name].claims, LISTED[name].tests)
    assert second == LISTED[name]
    assert len(chosen([])) == 1 + len(LISTED)
    with pytest.raises(click.BadParameter, match="'x' is none of the mutants"):
        chosen(["x"])


def test_a_mutant_is_applied_where_its_text_occurs_once(tmp_path):
    (tmp_path / "law.py").write_text("a = 4.0 / 3.0\n", "utf-8")
    Mutant("law", "law.py", "4.0 / 3.0", "4.1 / 3.0", ["bounds"], ["tests"]).applied(tmp_path)
    assert (tmp_path / "law.py").read_text("utf-8") == "a = 4.1 / 3.0\n"
    with pytest.raises(ValueError, match="0 times, not once"):
        Mutant("law", "law.py", "4.0 / 3.0", "4.1", ["bounds"], ["tests"]).applied(tmp_path)


@pytest.mark.parametrize(
    ("found", "passed"),
    [
        (Noticed("law", "check", "test"), True),
        (Noticed("law", "", "test"), False),
        (Noticed("law", "check", ""), False),
        (Noticed(UNCHANGED, "", ""), True),
        (Noticed(UNCHANGED, "", "test"), False),
    ],
)
def test_a_mutant_must_be_noticed_twice_and_the_package_not(found, passed):
    assert found.passed is passed
    assert str(found).startswith("FAILED: ") is not passed
