"""The commands and their options, each in an empty folder."""

import json
from pathlib import Path

import pytest

import metafem as mf
from metafem.files import DEMOS, MODELS, all_keys, demo_text, manual, schema_text


def test_spec_prints_every_key(run):
    assert run("spec").stdout == manual()
    data = json.loads(run("spec", "--json").stdout)
    assert [(key["section"], key["name"]) for key in data] == [(key.section, key.name) for key in all_keys()]


@pytest.mark.slow
def test_radii_and_layout_of_a_specification_are_designed(run):
    text = demo_text("linear").replace('radius = "526 um"', "").replace("seed = 0", 'tilt = "0.1 deg"')
    text = text.replace("[8, 8]", "[6, 6]")
    Path("tools.toml").write_text(text + '[tools]\nradii = ["526 um", "300 um"]\n', "utf-8")
    result = run("design", "tools.toml", "-o", "tools")
    assert result.exit_code == 0, result.output
    assert "misfit with the optimised assignment" in " ".join(result.output.split())
    found = mf.load("tools")
    assert found.layout.tilt == pytest.approx(0.1 * 3.141592653589793 / 180.0)
    assert found.parameters["tried_radii"].tolist() == [0.3, 0.526]
    assert "misfit with the optimised assignment" in Path("tools/report.html").read_text("utf-8")


@pytest.mark.slow
def test_a_robust_design_is_made_from_a_specification(run):
    errors = '\n[robust]\nheight_sd = "3 um"\nangle = "0.05 deg"\n'
    text = demo_text("linear").replace("[8, 8]", "[6, 6]") + errors
    Path("robust.toml").write_text(text, "utf-8")
    result = run("design", "robust.toml", "-o", "robust", "--json")
    assert result.exit_code in (0, 1), result.output
    found = mf.load("robust")
    assert found.robust == mf.Tolerances(0.003, 0.05 * 3.141592653589793 / 180.0)
    assert found.parameters["expected_misfit"] <= found.parameters["plain_expected_misfit"]
    report = Path("robust/report.html").read_text("utf-8")
    assert "expected misfit of made surfaces" in report
    assert '<tr><td>robust.angle</td><td class="number">0.05</td><td>°</td></tr>' in report


@pytest.mark.slow
@pytest.mark.usefixtures("plain_reports")
def test_empty_sites_and_given_heights_are_designed(run):
    sites = '[sites]\nempty = [3]\npinned = [9]\nheights = ["150 um"]\n'
    Path("sites.toml").write_text(demo_text("linear").replace("[8, 8]", "[6, 6]") + sites, "utf-8")
    result = run("design", "sites.toml", "-o", "sites")
    assert result.exit_code == 0, result.output
    assert "with the height of 1 site given the misfit is" in " ".join(result.output.split())
    rows = [row.split(",") for row in Path("sites/heights.csv").read_text("utf-8").splitlines()[1:]]
    heights = {int(row[0]): row[3] for row in rows}
    assert (len(rows), heights[9], 3 in heights) == (35, "0.15", False)
    holes = {row.split(",")[2]: row for row in Path("sites/mould.csv").read_text("utf-8").splitlines()[1:]}
    assert holes["9"].split(",")[5] == "0.15"
    assert "3" not in holes
    report = Path("sites/report.html").read_text("utf-8")
    assert '<tr><td>given height of site 9</td><td class="number">150</td><td>µm</td></tr>' in report
    assert dict(mf.load("sites").pinned) == {3: None, 9: 0.15}


@pytest.mark.usefixtures("plain_reports")
@pytest.mark.parametrize(
    "model",
    [
        "layer",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("mean-field", "half-space")),
        # its influence takes half a minute; resolved contacts take longer where the automatic ones need them
        pytest.param("block", marks=pytest.mark.slow),
        "automatic",
    ],
)
def test_demo_runs_under_every_model(run, model):
    result = run("demo", "linear", "--model", model, "--json")
    assert result.exit_code == 0, result.output
    assert mf.load("linear").law.model == MODELS[model]()


@pytest.mark.parametrize("name", DEMOS)
def test_demo_writes_the_specification_and_the_whole_folder(demo, name):
    data = demo(name)
    assert data["status"] in ("exact", "approximate")
    assert Path(f"{name}.toml").read_text("utf-8") == demo_text(name)
    assert Path("metafem.schema.json").read_text("utf-8") == schema_text()
    files = {"design.json", "heights.csv", "law.csv", "mould.csv", "block.stl", "surface.vtu", "report.html"}
    assert files <= {path.name for path in Path(name).iterdir()}
    assert mf.load(name).misfit == data["misfit"]


def test_existing_files_are_kept_without_force(run, demo, request):
    Path("linear.toml").write_text("mine", "utf-8")
    result = run("demo", "linear")
    assert (result.exit_code, "linear.toml exists" in result.output) == (2, True)
    assert Path("linear.toml").read_text("utf-8") == "mine"
    assert not Path("linear").exists()
    assert run("demo", "linear", "--force").exit_code == 2
    assert Path("linear.toml").read_text("utf-8") == "mine"
    Path("linear.toml").unlink()
    demo("linear")
    request.getfixturevalue("plain_reports")  # the demo of all tests has its pictures
    Path("metafem.schema.json").write_text("mine", "utf-8")
    assert "metafem.schema.json exists and differs" in run("demo", "linear", "--force").stderr
    assert Path("metafem.schema.json").read_text("utf-8") == "mine"
    result = run("demo", "linear")
    assert (result.exit_code, "--force" in result.output) == (2, True)
    assert "force=True" not in result.output


@pytest.mark.usefixtures("plain_reports")
def test_a_friction_coefficient_is_printed_at_the_terminal_and_as_json(run):
    target = 'friction_coefficient = 1.5\nload_range = ["0.2 N", "0.5 N"]'
    Path("mu.toml").write_text(demo_text("linear").replace("slope = 6.87", target), "utf-8")
    data = json.loads(run("design", "mu.toml", "-o", "mu", "--json").stdout)
    assert data["target"] == "Friction proportional to load: friction coefficient 1.5 from 0.2 to 0.5 N"
    assert data["misfit_meaning"] == "largest difference from the target"
    assert data["slopes"][0]["target_friction_coefficient"] == 1.5
    assert "target friction coefficient" in run("design", "mu.toml", "-o", "again").output


@pytest.mark.usefixtures("plain_reports")
def test_a_missed_target_exits_with_one(run):
    text = demo_text("bilinear").replace("12.52", "60.0")
    Path("steep.toml").write_text(text, "utf-8")
    result = run("design", "steep.toml", "-o", "steep", "--json")
    assert (result.exit_code, json.loads(result.stdout)["status"]) == (1, "missed")


def test_predict_reads_a_folder_and_a_table(run, demo):
    demo("linear")
    folder = json.loads(run("predict", "linear", "--load", "0.2 N", "--json").stdout)
    table = run(
        "predict", "linear/heights.csv", "--composite-modulus", "1.36 MPa", "--load", "200 mN", "--json"
    )
    assert folder["area_mm2"] == pytest.approx(json.loads(table.stdout)["area_mm2"], rel=1e-11)
    assert "friction_force_N" in folder
    assert "area [mm²]" in run("predict", "linear").output
    assert run("predict", "linear", "-o", "law.csv").exit_code == 0
    assert Path("law.csv").read_text("utf-8") == Path("linear/law.csv").read_text("utf-8")


def test_predict_prints_the_onset_of_sliding(run, demo):
    demo("linear")
    onset = json.loads(run("predict", "linear", "--onset", "0.3 N", "--json").stdout)["onset"]
    expected = mf.onset(mf.load("linear").surface, load=0.3)
    assert onset["friction_force_N"] == expected.friction_force.tolist()
    assert onset["sliding_displacement_mm"] == expected.sliding_displacement
    text = " ".join(run("predict", "linear", "--onset", "300 mN").output.split())
    assert "contacts that slide" in text
    assert "At a load of 0.3 N, the first of" in text


def test_predict_compares_contact_laws_and_models_at_the_same_loads(run, demo):
    demo("linear")
    laws = ("--contact", "hertz", "--contact", "power 2 0.5", "--contact", "sphere")
    data = json.loads(run("predict", "linear", *laws, "--load", "0.1 N", "--load", "0.2 N", "--json").stdout)
    first, same, sphere = (law["area_mm2"] for law in data["laws"])
    assert same == pytest.approx(first, rel=1e-10)
    assert all(0.96 < area / other < 0.99 for area, other in zip(sphere, first, strict=True))
    models = ("--model", "half-space", "--model", "independent")
    text = run("predict", "linear", *models).output
    assert "2: change" in " ".join(text.split())
    assert "1: model half-space, converged" in text
    refused = run("predict", "linear", *laws, "-o", "law.csv")
    assert (refused.exit_code, "holds one law, and 3 are compared" in refused.output) == (2, True)


@pytest.mark.slow
def test_a_surface_is_designed_made_and_predicted_under_a_contact_law(run):
    text = demo_text("linear").replace("[8, 8]", "[6, 6]") + '[contact]\nkind = "profile"\nfile = "cap.csv"\n'
    Path("cap.csv").write_text("rho_mm,f_um\n0,0\n0.2,38\n0.4,170\n0.5,290\n0.7,600\n", "utf-8")
    Path("cap.toml").write_text(text, "utf-8")
    result = run("design", "cap.toml", "-o", "cap", "--json")
    assert result.exit_code == 0, result.output
    assert "AxisymmetricCap(<5 points>, extent=0.7)" in json.loads(result.stdout)["model"]["python"]
    design = mf.load("cap")
    contact = design.law.model.contact
    assert contact == mf.AxisymmetricCap([[0.0, 0.2, 0.4, 0.5, 0.7], [0.0, 0.038, 0.17, 0.29, 0.6]])
    assert Path("cap/cap.csv").read_bytes() == Path("cap.csv").read_bytes()
    assert "Profile of the holes: Profile(" in Path("cap/mould.svg").read_text("utf-8")
    predicted = json.loads(run("predict", "cap", "--load", "0.02 N", "--json").stdout)
    area = mf.friction_law(design.surface, mf.Independent(contact=contact), load=[0.02]).area
    assert predicted["area_mm2"] == area.tolist()
    refused = run("predict", "cap", "--model", "resolved", "--contact", "jkr 9 mJ/m^2")
    assert (refused.exit_code, "resolved: contact = JKR(" in refused.output) == (2, True)


TABLE = ("predict", "h.csv", "--composite-modulus", "1.36 MPa")
SIDES = ("--width", "20 mm", "--length", "20 mm")


def test_report_is_written_anew_and_the_same(run, demo):
    demo("operating-points")
    path = Path("operating-points/report.html")
    before = path.read_bytes()
    path.unlink()
    assert run("report", "operating-points").exit_code == 0
    assert path.read_bytes() == before


def test_doctor_finds_no_fault_in_this_installation(run, monkeypatch):
    # tests may run on a checkout beside the one installed
    monkeypatch.setattr("metafem.cli.doctor._package", lambda: ("this one", True))
    result = run("doctor", "--json")
    assert result.exit_code == 0
    assert all(finding["well"] for finding in json.loads(result.stdout))


def test_a_table_is_predicted_on_a_layer_of_a_thickness(run, demo):
    demo("linear")
    folder = json.loads(run("predict", "linear", "--model", "layer", "--load", "0.2 N", "--json").stdout)
    for sides in ((), SIDES):
        table = ("predict", "linear/heights.csv", *TABLE[2:], "--load", "0.2 N", "--json")
        result = run(*table, "--model", "layer", "--thickness", "7.2 mm", *sides)
        assert json.loads(result.stdout)["area_mm2"] == pytest.approx(folder["area_mm2"], rel=1e-11)


@pytest.mark.slow
@pytest.mark.usefixtures("plain_reports")
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({'"7.2 mm"': '"0.2 mm"'}, "changes A0 at a given load by"),
        ({'"1.5 mm"': '"0.3 mm"', "[block]": ""}, "pairs reach into each other"),
        ({'"1.5 mm"': '"0.2 mm"', "[block]": ""}, "order 3 has no solution at"),
    ],
    ids=["thin block", "narrow lattice", "no comparison"],
)
def test_a_design_warns_of_what_its_model_leaves_out(run, changes, words):
    text = demo_text("linear")
    for old, new in changes.items():
        end = text.index("[", text.index(old) + 1) if not new else text.index(old) + len(old)
        text = text[: text.index(old)] + new + text[end:]
    Path("bad.toml").write_text(text, "utf-8")
    result = run("design", "bad.toml", "-o", "bad", "--json")
    assert result.exit_code == 0, result.output
    notes = json.loads(result.stdout)["notes"]
    assert any(words in note["text"] for note in notes if note["level"] == "warning")
    assert "No warnings" not in Path("bad/report.html").read_text("utf-8")
    output = " ".join(run("predict", "bad").output.split())
    assert "warning: " in output
    assert words in output


def test_a_table_is_predicted_with_its_material_and_friction(run):
    Path("h.csv").write_text("x_mm,y_mm,height_um,radius_um\n0,0,100,526\n1.5,0,120,526\n", "utf-8")
    composite = run("predict", "h.csv", "--composite-modulus", "1.2 MPa", "--load", "0.1 N", "--json")
    young = ("--young-modulus", "1.092 MPa", "--poisson-ratio", "0.3", "--load", "0.1 N")
    rubbed = ("--shear-strength", "358 kPa", "--area-ratio", "0.85")
    plain, found = (
        json.loads(each.stdout) for each in (composite, run("predict", "h.csv", *young, *rubbed, "--json"))
    )
    assert found["area_mm2"] == pytest.approx(plain["area_mm2"], rel=1e-12)
    assert plain["model"] == {"name": "independent", "python": "Independent()"}
    assert "friction_coefficient" not in plain
    assert found["friction_force_N"] == pytest.approx([0.358 * 0.85 * found["area_mm2"][0]])
    assert found["friction_coefficient"] == pytest.approx([found["friction_force_N"][0] / 0.1])
    output = run("predict", "h.csv", *young, *rubbed).output
    assert "F/P" in output
    assert "model independent, converged" in output
    refused = run("predict", "h.csv", *young[:3], "0.7")
    assert (refused.exit_code, "--poisson-ratio" in refused.output) == (2, True), refused.output


def test_the_schema_is_printed_and_written(run):
    assert run("spec", "--schema").stdout == schema_text()
    assert run("spec", "--schema", "-o", "a.json").stdout == "wrote a.json\n"
    assert Path("a.json").read_text("utf-8") == schema_text()
    assert run("spec", "--schema", "-o", "a.json").exit_code == 0  # it holds the schema already
    Path("a.json").write_text(schema_text().replace("false", "true"), "utf-8")
    result = run("spec", "--schema", "-o", "a.json")
    assert (result.exit_code, "--force" in result.output) == (2, True)
    assert json.loads(run("spec", "--schema", "-o", "a.json", "--force", "--json").stdout) == {
        "schema": "a.json"
    }
    result = run("spec", "-o", "b.json")
    assert (result.exit_code, "add --schema" in result.output) == (2, True)
    assert not Path("b.json").exists()
