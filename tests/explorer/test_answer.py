"""Answers equal the design of the command, and say what is wrong by key."""

import io
import re

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.law.law_data import SEARCHED, law_data
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.fields import with_field
from metafem.explorer.workshop.changes import with_section
from metafem.explorer.workshop.header import header_data
from metafem.files import Specification, demo_text, parsed
from metafem.models import Independent

TEXT = demo_text("operating-points")

# Random targets of each kind: some of them are refused.
TRIALS = {"operating-points": 30, "sampled": 20, "linear": 6, "bilinear": 8, "power": 12, "multilinear": 8}

# A section by which each asperity can have one of two radii.
TOOLS = "[tools]\nradii = ['300 um', '526 um']\nmixed = true\n"

# Operating points that no levels meet, whose heights a draft does not find: rows of the lattice, offset [um],
# rescaled loads and frictions [mm^2]. They lie on laws of random surfaces.
WITHOUT_LEVELS = [
    (4, 100, [0.395868, 0.449902, 0.88191], [2.18778, 2.40195, 3.8549]),
    (5, 100, [0.181566, 0.221206, 1.03144, 1.21713], [1.26976, 1.49605, 4.922, 5.52384]),
]


def test_an_answer_is_the_design_of_the_specification_to_the_bit():
    answer = answered(State(TEXT), 3)
    assert answer.number == 3
    assert answer.current
    assert answer.refused == ""
    assert answer.design == parsed(TEXT).design()


def test_another_look_at_the_same_specification_designs_nothing():
    before = answered(State(TEXT), 1)
    after = answered(State(TEXT, newtons=True, load=0.2), 2, before)
    assert after.design is before.design
    assert after.number == 2
    assert after.state.newtons
    assert answered(State(TEXT + "\n"), 3, before).design is not before.design


def test_problems_are_told_by_their_keys_and_the_last_design_stays():
    before = answered(State(TEXT), 1)
    text = TEXT.replace('"270 um"', "270").replace('pitch = "1.5 mm"', 'pitch = "1.5 kg"')
    answer = answered(State(text), 2, before)
    assert set(answer.problems) == {"limits.max_height", "lattice.pitch"}
    assert "needs a unit" in answer.problems["limits.max_height"]
    assert "kg" in answer.refused
    assert answer.specification is None
    assert answer.design is before.design
    assert not answer.current
    assert set(answered(State("[target"), 1).problems) == {""}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"4.12 mm^2"', '"40 mm^2"'),
        ('kind = "operating-points" ', 'kind = "sampled"'),
    ],
)
def test_a_target_out_of_reach_is_refused_with_the_nearest_law(old, new):
    text = TEXT.replace('"4.12 mm^2"', '"40 mm^2"').replace(old, new)
    answer = answered(State(text), 1)
    assert "mm^2" in answer.refusal
    assert answer.refused == answer.refusal
    assert not answer.problems
    load, friction = answer.nearest
    assert load[-1] == pytest.approx(0.649)
    assert friction[-1] < 40.0
    assert answer.nearest_target.curve().base == pytest.approx(friction)
    # the nearest law can be designed
    specification = answer.specification
    found = mf.design(answer.nearest_target, specification.template, limits=specification.limits)
    assert found.misfit < 0.1


def test_the_nearest_law_of_a_slope_is_that_of_its_design():
    answer = answered(
        State(demo_text("linear").replace("friction_coefficient = 1.5", "friction_coefficient = 9.0")), 1
    )
    if answer.refusal:
        assert answer.nearest is not None
        assert len(answer.nearest[0]) == 100


def test_a_table_is_read_from_the_state():
    lines = ["[target]", 'kind = "sampled"', 'file = "wanted.csv"']
    text = "\n".join(lines) + "\n" + TEXT[TEXT.index("[material]") :]
    table = "rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.5\n0.2,1.0\n0.3,1.6\n"
    assert answered(State(text, {"wanted.csv": table}), 1).current
    assert "wanted.csv" in answered(State(text), 1).refused


def test_a_table_with_half_a_character_is_a_problem_of_its_key():
    text = demo_text("linear").replace('"linear"', '"sampled"').replace("slope = 6.87", 'file = "a.csv"')
    (problem,) = answered(State(text, {"a.csv": "load_N,\ud800"}), 1).problems.items()
    assert problem[0] == "target.file"
    assert "is not UTF-8" in problem[1]


def test_a_draft_is_followed_by_the_design_of_the_command():
    text = demo_text("linear").replace('kind = "independent"', 'kind = "layer"')
    draft = answered(State(text), 1, draft=True)
    assert draft.draft
    assert draft.current
    again = answered(State(text), 2, draft, draft=True)
    assert again.design is draft.design
    found = answered(State(text), 3, draft)
    assert not found.draft
    assert found.design == parsed(text).design()
    assert answered(State(text), 4, found, draft=True).design is found.design
    assert draft.design.misfit < 1.25 * found.design.misfit


def text_of(target, rows=8):
    """Return a specification of a target, the rest of which is that of the demo."""
    rest = TEXT[TEXT.index("[material]") :].replace("shape = [8, 8]", f"shape = [{rows}, {rows}]")
    return "\n".join(["[target]", *(f"{key} = {value!r}" for key, value in target.items()), "", rest])


def areas(*values):
    """Return areas [mm^2] as they are written in a specification."""
    return [f"{value:.6g} mm^2" for value in values]


def points(load, friction):
    """Return a target of operating points."""
    return {"kind": "operating-points", "rescaled_load": areas(*load), "rescaled_friction": areas(*friction)}


@pytest.mark.parametrize(
    ("rows", "model", "drafted"),
    [
        (8, "layer", "layer"),
        (8, "resolved", "half-space"),
        (8, "mean-field", "mean-field"),
        (12, "layer", "independent"),
        (12, "resolved", "independent"),
        (12, "independent", "independent"),
    ],
)
def test_a_draft_of_many_asperities_or_under_a_slow_model_is_simplified(rows, model, drafted):
    text = TEXT.replace('kind = "independent"', f'kind = "{model}"').replace("[8, 8]", f"[{rows}, {rows}]")
    state = State(text.replace('pitch = "1.5 mm"', 'pitch = "1.2 mm"'))
    draft = answered(state, 1, draft=True)
    assert draft.current
    assert draft.design.law.model.name == drafted
    assert draft.simplified == (model != drafted)
    assert law_data(draft)["model"] == (f"{drafted}, draft" if draft.simplified else model)
    assert header_data(draft)["status"].startswith("draft under") == draft.simplified


def test_a_draft_neglects_what_takes_seconds():
    arranged = answered(State(with_field(TEXT, "layout.tilt", "0.1 deg")), 1, draft=True)
    assert arranged.current
    assert "layout_after" not in arranged.design.parameters
    adhesive = with_field(with_section(TEXT, "contact"), "contact.kind", "jkr")
    draft = answered(State(with_field(adhesive, "model.kind", "layer")), 1, draft=True)
    assert draft.current
    assert draft.design.law.model == Independent(draft.specification.model.contact)


@pytest.mark.parametrize("case", WITHOUT_LEVELS)
def test_a_draft_that_finds_no_surface_within_all_bounds_is_undecided(case):
    rows, offset, load, friction = case
    text = text_of(points(load, friction), rows).replace('offset = "0 um"', f'offset = "{offset} um"')
    with pytest.raises(mf.Infeasible) as refused:
        parsed(text).design(draft=True)
    assert refused.value.by_search
    draft = answered(State(text), 1, draft=True)
    assert draft.undecided
    assert not draft.current
    assert law_data(draft)["undecided"]
    assert law_data(draft)["refusal"].endswith(SEARCHED)
    found = answered(State(text), 2, draft)
    assert found.current
    assert not found.undecided
    assert found.design == parsed(text).design()
    # nothing is searched again on release
    assert answered(State(text), 3, found).design is found.design


def test_a_draft_beyond_a_bound_is_refused_at_once(monkeypatch):
    drafts = []
    design = Specification.design
    monkeypatch.setattr(
        Specification,
        "design",
        lambda self, model=None, *, draft=False: (drafts.append(draft), design(self, model, draft=draft))[1],
    )
    answer = answered(State(TEXT.replace('"4.12 mm^2"', '"40 mm^2"')), 1, draft=True)
    assert answer.refusal
    assert not answer.undecided
    assert drafts == [True]


def random_target(kind, rng):
    """Return a target that is near the law of a random surface, or some way from it."""
    template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    height = np.maximum(0.27 - rng.exponential(rng.uniform(0.01, 0.1), 64), 0.0)
    number = rng.integers(3, 6)
    load = np.sort(rng.uniform(0.03, 0.8, number))
    area = mf.Independent().curve(template.replaced(height=height), load).area
    friction = np.maximum.accumulate(area * rng.normal(1.0, rng.choice([0.0, 0.02, 0.2]), number))
    friction += 1e-3 * np.arange(number)
    if kind in ("operating-points", "sampled"):
        return {**points(load, friction), "kind": kind}
    slopes = (np.diff(friction, prepend=0.0) / np.diff(load, prepend=0.0)).round(4).tolist()
    crossovers, ends = areas(*load[:2]), areas(0.5 * load[0], load[2])
    open_ended = rng.random() < 0.5
    ranged = {} if open_ended else {"load_range": ends}
    return {
        "linear": {"slope": slopes[0], **ranged},
        "bilinear": {"slopes": slopes[:2], "crossover_load": crossovers[0], **ranged},
        "power": {"exponent": rng.uniform(0.6, 1.5), "load_range": ends}
        | ({} if open_ended else {"prefactor": slopes[0]}),
        "multilinear": {"slopes": slopes[:3], "crossover_loads": crossovers, "load_range": ends},
    }[kind] | {"kind": kind}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TRIALS)
def test_what_a_draft_refuses_the_whole_search_refuses(kind):
    rng = np.random.default_rng(0)
    refused = 0
    for trial in range(TRIALS[kind]):
        text = text_of(random_target(kind, rng), int(rng.integers(3, 9)))
        if trial % 3 == 1:
            text = text.replace("height_sd", "height_step = '6 um'\nheight_sd")
        if kind == "operating-points" and trial % 3 == 2:
            text = text.replace('radius = "526 um"', "") + TOOLS
        answer = answered(State(text), 1, draft=True)
        assert not answer.problems
        if answer.refusal and not answer.undecided:
            refused += 1
            with pytest.raises(mf.Infeasible):
                parsed(text).design()
    assert refused > 0


@pytest.mark.parametrize("section", ["target", "contact"])
def test_files_of_the_machine_are_not_read(section, tmp_path, monkeypatch):
    table = tmp_path / "secret.csv"
    table.write_text("rescaled_load_mm2,rescaled_friction_mm2\n0.05,0.4\n0.1,0.7\n", "utf-8")
    monkeypatch.chdir(tmp_path)

    def refused(*given, **options):
        raise AssertionError(f"a file is opened: {given}")

    answered(State(TEXT), 0)  # imports and compiled functions are files too
    for name in (str(table), "secret.csv", f"../{tmp_path.name}/secret.csv", "/etc/passwd"):
        kind = "sampled" if section == "target" else "profile"
        text = Document(TEXT).with_kind(section, kind, {"file": name})
        with monkeypatch.context() as patched:
            patched.setattr(io, "open", refused)
            patched.setattr("builtins.open", refused)
            answer = answered(State(text), 1)
        assert answer.specification is None
        assert "names a table that is not loaded (loaded: none)" in answer.problems[f"{section}.file"]


@pytest.mark.parametrize("forces", [False, True])
def test_a_refusal_is_in_the_unit_of_the_axes(forces):
    text = demo_text("operating-points").replace('"1.68 mm^2"', '"3.9 mm^2"')
    if forces:
        text = text.replace("rescaled_load", "load").replace("rescaled_friction", "friction_force")
        text = text.replace(' mm^2"', ' N"')
    for newtons in (False, True):
        words = answered(State(text, newtons=newtons), 1).refusal
        assert words.startswith("operating point")
        # the load also in the other unit, in brackets
        unit, other = ("N", r"mm\^2") if newtons else (r"mm\^2", "N")
        assert re.search(rf"\(load \S+ {unit} \(\S+ {other}\), friction \S+ {unit}\)", words)
        assert re.search(rf"can be from \S+ to \S+ {unit}$", words)


def test_quantities_other_than_friction_are_refused_by_their_key():
    lines = "rescaled_load = ['0.1 mm^2', '0.2 mm^2']\nrescaled_friction = ['3.5 mm', '5.1 mm']\n"
    rest = TEXT[TEXT.index("[material]") :]
    answer = answered(State(f'[target]\nkind = "sampled"\nof = "stiffness"\n{lines}{rest}'), 1)
    assert list(answer.problems) == ["target.of"]
    assert "draws friction laws" in answer.problems["target.of"]
