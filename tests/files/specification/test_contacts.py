"""Contact laws of specifications and of options, and models with them."""

from dataclasses import dataclass

import pytest

import metafem as mf
from metafem.cli.group import CONTACTS as COMMAND_CONTACTS
from metafem.files.specification.models import demo_text
from metafem.files.specification.options import chosen_model, contact_named, contacts, form
from metafem.models.model import with_contact

PROFILE = "rho_mm,f_um\n0,0\n0.2,39.5\n0.4,184\n0.6,600\n"
CAP = mf.AxisymmetricCap([[0.0, 0.2, 0.4, 0.6], [0.0, 39.5e-3, 0.184, 0.6]])

MEASURED = [[0.005, 0.02, 0.09], [0.00046, 0.0037, 0.035], [0.0083, 0.033, 0.15]]

# Words of each kind, its section, and the law.
LAWS = {
    "hertz": ("", mf.Hertz()),
    "elastic": ("", mf.Elastic()),
    "sphere": ("", mf.SphericalCap()),
    "power 4 0.3": ("exponent = 4.0\ncoefficient = 0.3", mf.PowerCap(4, 0.3)),
    "profile cap.csv": ('file = "cap.csv"', CAP),
    "jkr 9 mJ/m^2": ('adhesion_energy = "9 mJ/m^2"', mf.JKR(9e-6)),
    "jkr 27mJ/m^2 power 4 0.3": (
        'adhesion_energy = "0.027 N/m"\ncap = {kind = "power", exponent = 4.0, coefficient = 0.3}',
        mf.JKR(2.7e-5, mf.PowerCap(4, 0.3)),
    ),
    "jkr 9 mJ/m^2 profile cap.csv": (
        'adhesion_energy = "9 mJ/m^2"\ncap = {kind = "profile", file = "cap.csv"}',
        mf.JKR(9e-6, CAP),
    ),
    "kogut-etsion 10 MPa": ('hardness = "10 MPa"', mf.KogutEtsion(10.0)),
    "jackson-green 4000kPa": ('yield_strength = "4 MPa"', mf.JacksonGreen(4.0)),
    "tabulated contact.csv": ('file = "contact.csv"', mf.TabulatedContact(*MEASURED)),
}


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cap.csv").write_text(PROFILE, "utf-8")
    rows = "5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n"
    (tmp_path / "contact.csv").write_text(f"indentation_um,load_mN,area_mm2\n0,0,0\n{rows}", "utf-8")
    return tmp_path


def written(folder, section):
    path = folder / "spec.toml"
    path.write_text(f"{demo_text('linear')}\n[contact]\n{section}\n", "utf-8")
    return path


def test_every_kind_of_law_is_tested():
    assert list(dict.fromkeys(words.split()[0] for words in LAWS)) == list(contacts())


@pytest.mark.parametrize("words", LAWS)
def test_a_law_is_read_from_words_and_from_a_section(home, words):
    keys, law = LAWS[words]
    assert contact_named(words) == law
    model = mf.read_spec(written(home, f'kind = "{words.split()[0]}"\n{keys}')).model
    assert model == mf.Independent(contact=law)


CAP_SECTIONS = {
    'kind = "sphere"': mf.Sphere(),
    'kind = "paraboloid"': mf.Paraboloid(),
    'kind = "power"\nexponent = 4.0\ncoefficient = 0.3': mf.Power(4, 0.3),
    'kind = "profile"\nfile = "cap.csv"': mf.Profile(CAP.profile),
}


@pytest.mark.parametrize("section", CAP_SECTIONS)
def test_a_cap_is_read_from_its_section(home, section):
    path = written(home, f'kind = "elastic"\n[cap]\n{section}')
    found = mf.read_spec(path)
    assert found.template.cap == CAP_SECTIONS[section]
    assert found.model == mf.Independent(mf.Elastic())


def test_a_law_with_a_profile_of_its_own_states_the_cap(home):
    found = mf.read_spec(written(home, 'kind = "power"\nexponent = 4.0'))
    assert found.template.cap == mf.Power(4)
    words = r"cap\.kind is Power\(exponent=3\.0.*which the contact law PowerCap\(exponent=4\.0"
    with pytest.raises(mf.InvalidInput, match=words):
        mf.read_spec(written(home, 'kind = "power"\nexponent = 4.0\n[cap]\nkind = "power"\nexponent = 3.0'))


def test_a_profile_is_read_from_keys(home):
    keys = 'kind = "profile"\nrho = ["0 um", "0.2 mm", "0.4 mm", "0.6 mm"]\n'
    model = mf.read_spec(written(home, keys + 'f = ["0 um", "39.5 um", "184 um", "600 um"]')).model
    assert model.contact == CAP


def test_the_table_of_a_profile_is_kept(home):
    (home / "law.csv").write_text(PROFILE, "utf-8")
    kept = mf.read_spec(written(home, 'kind = "profile"\nfile = "law.csv"')).files
    assert kept["wanted-law.csv"] == PROFILE.encode()
    assert b'file = "wanted-law.csv"' in kept["spec.toml"]


def test_tables_of_a_target_and_of_a_profile_are_both_kept(home):
    for name, text in (("a", "load_N,friction_force_N\n0.1,0.2\n0.2,0.3\n"), ("b", PROFILE)):
        (home / name).mkdir()
        (home / name / "t.csv").write_text(text, "utf-8")
    rest = demo_text("linear").split("[material]")[1]
    target = f'[target]\nkind = "sampled"\nfile = "a/t.csv"\n[material]{rest}'
    path = home / "spec.toml"
    path.write_text(f'{target}\n[contact]\nkind = "profile"\nfile = "b/t.csv"\n', "utf-8")
    spec = mf.read_spec(path)
    (home / "out").mkdir()
    for name, content in spec.files.items():
        (home / "out" / name).write_bytes(content)
    again = mf.read_spec(home / "out" / "spec.toml")
    assert sorted(spec.files) == ["spec.toml", "t.csv", "wanted-t.csv"]
    assert (again.target, again.model) == (spec.target, spec.model)


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("exponent = 4.0", r'contact.kind is missing; write for example kind = "hertz"'),
        ('kind = "sphere"\nexponent = 4.0', r"contact.exponent is an unknown key \(known: kind\)"),
        ('kind = "power"', "contact.exponent is missing; write for example exponent = 4.0"),
        ('kind = "power"\nexponent = 0.5', "contact.exponent = 0.5 must be at least 1"),
        ('kind = "power"\nexponent = 4.0\ncoefficient = 0.0', "contact.coefficient = 0 must be greater"),
        ('kind = "jkr"\nadhesion_energy = 9e-6', 'contact.adhesion_energy = 9e-06 needs a unit; .* "9 mJ/m'),
        (
            'kind = "jkr"\nadhesion_energy = "-9 mJ/m^2"',
            "contact.adhesion_energy = -9 mJ/m.2 must be at least 0",
        ),
        ('kind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap = "sphere"', r"write \[contact.cap\] on a line"),
        (
            'kind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap = {kind = "jkr"}',
            r'contact.cap.kind = "jkr" is unknown \(known: hertz, elastic, sphere, power, profile\)',
        ),
        (
            'kind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap = {kind = "power"}',
            "contact.cap.exponent is missing; write for example exponent = 4.0",
        ),
        ('kind = "kogut-etsion"\nhardness = "0 MPa"', "contact.hardness = 0 MPa must be greater than 0"),
        ('kind = "tabulated"', "contact needs either indentation and load and area or file"),
        ('kind = "tabulated"\nfile = "cap.csv"', "name its columns indentation_um,load_mN,area_mm2"),
        ('kind = "tabulated"\nfile = "less.csv"', r"less.csv, line 3: area_mm2 = 0 must be greater than 0"),
        (
            'kind = "tabulated"\nindentation = ["5 um", "6 um"]\nload = ["1 mN"]\narea = ["1 mm2", "2 mm2"]',
            "contact.load has 1 number; it must have 2",
        ),
        (
            'kind = "profile"\nrho = ["0 um", "0.1 mm"]\nf = ["0 um", "1 um"]',
            r"contact.rho = \[0.0, 0.1\] must begin with 0 and increase over at least 3 points",
        ),
        ('kind = "profile"', "contact needs either rho and f or file"),
        ('kind = "profile"\nrho = ["0 mm"]\nfile = "cap.csv"', "contact.file and contact.rho both give the"),
        (
            'kind = "profile"\nrho = ["0 mm"]\nf = ["0 um", "1 um"]',
            r"contact.profile is not an array of numbers: \[\[0.0\]",
        ),
        ('kind = "profile"\nfile = "late.csv"', "late.csv, line 2: rho_mm = 0.1 must be 0; the first line"),
        (
            'kind = "profile"\nfile = "back.csv"',
            "back.csv, line 4: f_um = 2 must exceed the f of the previous",
        ),
    ],
)
def test_errors_name_the_key_the_value_and_the_remedy(home, section, words):
    (home / "late.csv").write_text("rho_mm,f_um\n0.1,1\n0.2,3\n", "utf-8")
    (home / "back.csv").write_text("rho_mm,f_um\n0,0\n0.2,3\n0.3,2\n", "utf-8")
    (home / "less.csv").write_text("indentation_um,load_mN,area_mm2\n5,1,2\n6,2,0\n", "utf-8")
    with pytest.raises(mf.InvalidInput, match=words):
        mf.read_spec(written(home, section))


def test_laws_of_the_command_are_those_of_the_files():
    assert tuple(form(kind) for kind in contacts()) == COMMAND_CONTACTS


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r'contact law "" is unknown \(known: hertz, elastic, sphere, power'),
        ("powr 4", r'contact law "powr" is unknown; did you mean power\?'),
        ("sphere 3", r'"sphere": 3 is not one of its values \(sphere\)'),
        ("power", r'"power": exponent is missing; .* \(power EXPONENT \[COEFFICIENT\]\)'),
        ("power four", "\"power four\": exponent = 'four' must be a number"),
        ("power 4 -1", '"power 4 -1": coefficient = -1 must be greater than 0'),
        ("profile", r'"profile": needs either rho and f or file \(profile FILE\)'),
        ("profile none.csv", "none.csv: no such file"),
    ],
)
def test_errors_in_words_name_the_value_and_the_form(text, words):
    with pytest.raises(mf.InvalidInput, match=words):
        contact_named(text)


def test_options_replace_the_model_and_the_law_each_alone():
    folder = mf.Independent(contact=mf.SphericalCap())
    assert chosen_model(folder, None, None) is folder
    assert chosen_model(folder, None, "hertz") == mf.Independent()
    assert chosen_model(folder, "independent", None) == folder
    assert chosen_model(mf.MeanField(), "independent", "power 3") == mf.Independent(contact=mf.PowerCap(3))


def test_a_model_that_cannot_use_a_law_is_named():
    @dataclass(frozen=True)
    class Own:
        name = "own"

    with pytest.raises(
        mf.InvalidInput, match=r"own: the contacts of this model are paraboloids, not Spherical"
    ):
        with_contact(Own(), mf.SphericalCap())
    assert with_contact(Own(), mf.Hertz()) == Own()


def test_a_law_without_a_profile_couples_by_order_1():
    law = mf.KogutEtsion(10.0)
    assert with_contact(mf.Interacting(), law) == mf.Interacting(order=1, contact=law)
    assert with_contact(mf.Interacting(order=1), mf.PowerCap(4)).order == 1
    assert with_contact(mf.Interacting(), mf.PowerCap(4)).order == 3
