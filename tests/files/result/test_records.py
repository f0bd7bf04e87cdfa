import json
from dataclasses import fields, is_dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.files.result.records import from_record, to_record
from metafem.files.specification.models import MODELS
from metafem.notes import Level

# lengths of one surface may differ by fifteen orders of magnitude, and heights may vanish
size = st.floats(min_value=1e-7, max_value=1e7)
finite = st.just(0.0) | size | size.map(lambda x: -x)
positive = st.floats(min_value=1e-300, max_value=1e300)


def same(a, b):
    """Equality to the bit of values whose dataclasses may hold arrays."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and a.shape == b.shape and (a == b).all()
    if is_dataclass(a):
        return type(a) is type(b) and all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(same, a, b))
    if hasattr(a, "keys"):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    return type(a) is type(b) and a == b


def through_json(value):
    return from_record(json.loads(json.dumps(to_record(value), allow_nan=False)))


TEMPLATE = mf.Surface.square_lattice(
    0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358), block=mf.Block(20, 20, 7.2)
)
PINNED = mf.Limits(0.12, pinned={9: 0.1, 3: None})
TARGETS = {
    "points": (mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]), mf.Limits(0.27)),
    "linear": (mf.LinearLaw(6.87), mf.Limits(0.12, offset=0.084, height_step=0.006)),
    "bilinear": (mf.BilinearLaw((7.15, 12.52), 0.038), None),
}


@pytest.mark.parametrize("name", TARGETS)
def test_a_design_reads_back_to_the_bit(name):
    target, limits = TARGETS[name]
    result = mf.design(target, TEMPLATE, limits=limits)
    assert same(through_json(result), result)


def test_a_layout_reads_back_with_its_design():
    result = mf.design(mf.OperatingPoints([0.1], [0.84]), TEMPLATE, layout=mf.Layout(tilt=0.002))
    assert same(through_json(result), result)


def test_given_heights_and_empty_sites_read_back_with_their_design():
    result = mf.design(mf.OperatingPoints([0.1], [0.84]), TEMPLATE, limits=PINNED)
    again = through_json(result)
    assert same(again, result)
    assert dict(again.pinned) == {3: None, 9: 0.1}


@pytest.mark.parametrize("pinned", [{"nine": 0.1}, {"9": "high"}, {"3": 0.05}, {"9": None}, [9]])
def test_damaged_heights_of_a_record_are_refused(pinned):
    result = mf.design(mf.OperatingPoints([0.1], [0.84]), TEMPLATE, limits=PINNED)
    with pytest.raises(mf.InvalidInput, match=r"pinned|site 3|site 9"):
        from_record({**json.loads(json.dumps(to_record(result))), "pinned": pinned})


@given(st.lists(st.tuples(finite, finite, finite, size), min_size=1, max_size=6, unique_by=lambda t: t[:2]))
def test_any_surface_reads_back_to_the_bit(rows):
    x, y, height, radius = (np.array(column) for column in zip(*rows, strict=True))
    surface = mf.Surface(np.column_stack([x, y]), height, radius, mf.Material(1.0))
    assert same(through_json(surface), surface)


@given(positive)
def test_any_slope_reads_back_to_the_bit(slope):
    assert through_json(mf.LinearLaw(slope)) == mf.LinearLaw(slope)


def test_unknown_types_are_not_written():
    with pytest.raises(mf.InvalidInput, match="cannot be written"):
        to_record(object())


@pytest.mark.parametrize(("record", "message"), [
    ({"type": "os.system", "command": "ls"}, "not a type of this version"),
    ({"type": "Friction", "area_ratio": 1.0}, "missing or unknown members: shear_strength"),
    ({"type": "Friction", "area_ratio": 1.0, "shear_strength": 1.0, "way": 2}, "members: way"),
    ({"type": "Friction", "area_ratio": 1.0, "shear_strength": -1.0}, "shear_strength = -1"),
    ({"type": "Status", "name": "FINE"}, "'FINE' is not a Status"),
    ({"type": "Status"}, "None is not a Status"),
    ({"type": ["Status"]}, "not a type"),
    ({"float64": [[1.0], [2.0, 3.0]]}, "not an array of float64"),
    ({"int64": ["a"]}, "not an array of int64"),
])  # fmt: skip
def test_a_foreign_record_is_refused(record, message):
    with pytest.raises(mf.InvalidInput, match=message):
        from_record(record)


@pytest.mark.parametrize("name", MODELS)
def test_every_named_model_reads_back(name):
    assert through_json(MODELS[name]()) == MODELS[name]()


CAPS = (
    mf.Hertz(),
    mf.PowerCap(4, 0.3),
    mf.SphericalCap(),
    mf.AxisymmetricCap([[0, 0.1, 0.2], [0, 0.01, 0.04]]),
)
OF_MATERIALS = (
    *(mf.JKR(9e-6), mf.JKR(9e-6, mf.PowerCap(4)), mf.KogutEtsion(10.0), mf.JacksonGreen(4.0)),
    mf.TabulatedContact([0.0, 0.01, 0.02, 0.04], [0.0, 0.1, 0.3, 0.8], [0.0, 0.01, 0.02, 0.05]),
)
FLATTENED, _ = OF_MATERIALS[2].for_material(mf.Material(1.36)).unloaded(np.array([0.0, 0.01]), np.ones(2))


@pytest.mark.parametrize(
    "law", [*CAPS, *OF_MATERIALS, *(law.for_material(mf.Material(1.0)) for law in OF_MATERIALS), FLATTENED]
)
def test_every_contact_law_reads_back_with_its_model(law):
    model = mf.Independent(contact=law)
    assert through_json(model) == model


@pytest.mark.parametrize("law", CAPS)
def test_a_friction_law_reads_back_with_its_contact_law(law):
    surface = mf.Surface([[0, 0]], [0.1], 0.5, mf.Material(1.0))
    predicted = mf.friction_law(surface, mf.Independent(contact=law), load=[0.01, 0.02])
    assert through_json(predicted) == predicted


def test_a_contact_law_of_a_function_is_not_written():
    model = mf.Independent(contact=mf.AxisymmetricCap(np.square, extent=0.3))
    with pytest.raises(
        mf.InvalidInput, match=r"AxisymmetricCap.profile = square .* cannot .* give it as a table"
    ):
        to_record(model)


def test_notes_read_back():
    design = mf.design(mf.LinearLaw(6.87), TEMPLATE, limits=mf.Limits(0.12, height_sd=0.01))
    assert {note.level for note in design.notes} == set(Level)
    record = json.loads(json.dumps(to_record(design)))
    assert from_record(record).notes == design.notes
    record["notes"] = [3]
    with pytest.raises(mf.InvalidInput, match=r"record\.notes = \[3\] must be an instance of Note"):
        from_record(record)
