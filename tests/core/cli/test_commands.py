"""The commands and their options, each in an empty folder."""

from pathlib import Path

import pytest

import metafem as mf
from metafem.files import DEMOS, demo_text, manual, schema_text
from metafem.files.specification import model_named
from tests.core.files.specs import PLAIN, text

MATERIAL = ("--composite-modulus", "1.36 MPa")


def test_spec_prints_every_key_or_the_schema(run):
    assert run("spec").stdout == manual()
    assert run("spec", "--schema").stdout == run("spec", "--json").stdout == schema_text()


# a design on steps is searched again under these, and the influence of the block takes half a minute
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("half-space", "layer", "block", "automatic")]


@pytest.mark.usefixtures("plain_reports")
@pytest.mark.parametrize("model", ["independent", *SLOW])
def test_demo_runs_under_every_model(run, model):
    result = run("demo", "linear", "--model", model, "--json")
    assert result.exit_code == 0, result.output
    assert mf.load("linear").law.model == model_named(model, block=mf.load("linear").surface.block)


@pytest.mark.parametrize("name", DEMOS)
def test_demo_writes_the_specification_and_the_whole_folder(demo, name):
    data = demo(name)
    assert data["status"] in ("exact", "approximate")
    assert Path(f"{name}.toml").read_text("utf-8") == demo_text(name)
    assert Path("metafem.schema.json").read_text("utf-8") == schema_text()
    files = {"design.json", "heights.csv", "law.csv", "mould.csv", "block.stl", "surface.vtu", "report.html"}
    assert files <= {path.name for path in Path(name).iterdir()}
    assert mf.load(name).misfit == data["misfit"]


def test_existing_files_are_kept_without_force(run, demo):
    Path("linear.toml").write_text("mine", "utf-8")
    assert "linear.toml exists" in run("demo", "linear", "--force").refusal
    assert not Path("linear").exists()
    Path("linear.toml").unlink()
    demo("linear")
    Path("metafem.schema.json").write_text("mine", "utf-8")
    assert "--force" in run("demo", "linear").refusal
    assert Path("metafem.schema.json").read_text("utf-8") == "mine"


@pytest.mark.usefixtures("plain_reports")
def test_a_friction_coefficient_is_printed_at_the_terminal_and_as_json(run):
    target = 'friction_coefficient = 1.5\nload_range = ["0.2 N", "0.5 N"]'
    text = demo_text("linear").replace("slope = 6.87", target).replace('height_step = "6 um"', "")
    Path("mu.toml").write_text(text, "utf-8")
    data = run("design", "mu.toml", "-o", "mu", "--json").data
    assert data["target"] == "Friction proportional to load: friction coefficient 1.5 from 0.2 to 0.5 N"
    assert data["misfit_meaning"] == "largest difference from the target"
    assert data["slopes"][0]["friction_coefficient"] == pytest.approx(1.5, rel=0.01)
    assert "target friction coefficient" in run("design", "mu.toml", "-o", "again").output


@pytest.mark.usefixtures("plain_reports")
def test_a_specification_without_a_model_is_designed_on_its_block(run):
    target = 'kind = "operating-points"\nload = ["30 mN", "90 mN"]\nfriction_force = ["56 mN", "140 mN"]'
    lattice = PLAIN["lattice"].replace("[8, 8]", "[3, 3]")
    Path("plain.toml").write_text(text(target=target, lattice=lattice), "utf-8")
    words = run("design", "plain.toml", "-o", "plain").told
    assert "model automatic, layer" in words
    assert mf.load("plain").law.model == mf.Automatic(1e-3, mf.BondedLayer())


@pytest.mark.usefixtures("plain_reports")
def test_a_missed_target_exits_with_one(run):
    Path("steep.toml").write_text(demo_text("bilinear").replace("12.52", "60.0"), "utf-8")
    assert run("design", "steep.toml", "-o", "steep", "--json").missed["status"] == "missed"


def test_predict_reads_a_folder_and_a_table(run, demo):
    demo("linear")
    block = ("--thickness", "7.2 mm", "--width", "20 mm", "--length", "20 mm")
    for model, more in (((), ()), (("--model", "layer"), block)):
        folder = run("predict", "linear", *model, "--load", "0.2 N", "--json").data
        given = (*MATERIAL, *model, *more, "--load", "200 mN", "--json")
        table = run("predict", "linear/heights.csv", *given).data
        assert folder["area_mm2"] == pytest.approx(table["area_mm2"], rel=1e-11)
    assert "friction_force_N" in folder
    assert "area [mm²]" in run("predict", "linear").output
    assert run("predict", "linear", "-o", "law.csv").exit_code == 0
    assert Path("law.csv").read_text("utf-8") == Path("linear/law.csv").read_text("utf-8")


def test_predict_takes_a_contact_law_and_a_model(run, demo):
    demo("linear")
    laws = ((), ("--contact", "jkr 0 N/m"), ("--contact", "elastic"))
    loads = ("--load", "0.1 N", "--load", "0.2 N", "--json")
    first, same, sphere = (run("predict", "linear", *law, *loads).data["area_mm2"] for law in laws)
    assert same == pytest.approx(first, rel=1e-10)
    assert all(0.96 < area / other < 0.99 for area, other in zip(sphere, first, strict=True))
    assert "model half-space, converged" in run("predict", "linear", "--model", "half-space").told


@pytest.mark.slow
def test_a_surface_is_designed_made_and_predicted_under_a_contact_law(run):
    contact = '[contact]\nkind = "elastic"\n[cap]\nkind = "profile"\nfile = "cap.csv"\n'
    Path("cap.csv").write_text("rho_mm,f_um\n0,0\n0.2,38\n0.4,170\n0.5,290\n0.7,600\n", "utf-8")
    Path("cap.toml").write_text(demo_text("operating-points") + contact, "utf-8")
    made = run("design", "cap.toml", "-o", "cap", "--json").data
    assert made["model"]["python"] == "Independent(contact=Elastic())"
    design = mf.load("cap")
    assert design.surface.cap == mf.Profile([[0.0, 0.2, 0.4, 0.5, 0.7], [0.0, 0.038, 0.17, 0.29, 0.6]])
    assert Path("cap/cap.csv").read_bytes() == Path("cap.csv").read_bytes()
    predicted = run("predict", "cap", "--load", "0.02 N", "--json").data
    area = mf.friction_law(design.surface, mf.Independent(contact=mf.Elastic()), load=[0.02]).area
    assert predicted["area_mm2"] == area.tolist()


def test_report_is_written_anew_and_the_same(run, demo):
    demo("operating-points")
    path = Path("operating-points/report.html")
    before = path.read_bytes()
    path.unlink()
    assert run("report", "operating-points").exit_code == 0
    assert path.read_bytes() == before


@pytest.mark.slow
@pytest.mark.usefixtures("plain_reports")
@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"block": PLAIN["block"].replace("7.2", "0.2")}, "changes A0 at a given load by"),
        ({"lattice": PLAIN["lattice"].replace("1.5", "0.3"), "block": None}, "pairs reach into each other"),
        ({"lattice": PLAIN["lattice"].replace("1.5", "0.2"), "block": None}, "order 3 has no solution at"),
    ],
    ids=["thin block", "narrow lattice", "no comparison"],
)
def test_a_design_warns_of_what_its_model_leaves_out(run, sections, words):
    alone = 'kind = "independent"'
    Path("bad.toml").write_text(text(model=alone, **sections), "utf-8")
    notes = run("design", "bad.toml", "-o", "bad", "--json").data["notes"]
    assert any(words in note["text"] for note in notes if note["level"] == "warning")
    assert "No warnings" not in Path("bad/report.html").read_text("utf-8")
    assert words in run("predict", "bad").words


def test_a_table_is_predicted_with_its_material_and_friction(run):
    Path("h.csv").write_text("x_mm,y_mm,height_um,radius_um\n0,0,100,526\n1.5,0,120,526\n", "utf-8")
    plain = run("predict", "h.csv", "--composite-modulus", "1.2 MPa", "--load", "0.1 N", "--json").data
    young = ("--young-modulus", "1.092 MPa", "--poisson-ratio", "0.3", "--load", "0.1 N")
    rubbed = ("--shear-strength", "358 kPa", "--area-ratio", "0.85")
    found = run("predict", "h.csv", *young, *rubbed, "--json").data
    assert found["area_mm2"] == pytest.approx(plain["area_mm2"], rel=1e-12)
    assert plain["model"] == {"name": "independent", "python": "Independent()"}
    assert "friction_coefficient" not in plain
    assert found["friction_force_N"] == pytest.approx([0.358 * 0.85 * found["area_mm2"][0]])
    assert found["friction_coefficient"] == pytest.approx([found["friction_force_N"][0] / 0.1])
    assert "friction coefficient" in run("predict", "h.csv", *young, *rubbed).output
    assert "--poisson-ratio" in run("predict", "h.csv", *young[:3], "0.7").refusal
