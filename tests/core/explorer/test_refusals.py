"""What the explorer refuses: by the name of what is wrong, and the value that was given."""

import base64
import json
import math
import socket
import zlib
from functools import cache

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.editor import loaded
from metafem.explorer.fields import rounded
from metafem.explorer.handles import added, moved, removed, scene_of
from metafem.explorer.history import LARGEST, LONGEST, State, from_link
from metafem.explorer.kinds import reachable, with_kind_near, with_nearest
from metafem.explorer.law_data import read_points
from metafem.explorer.new_part import FIRST, new_part
from metafem.explorer.start import HOST, explore, first_state, free_port
from metafem.explorer.surface_data import edited, typed_height
from metafem.explorer.table import with_field, with_values
from metafem.files import demo_text, parsed
from metafem.material import Material
from metafem.surface import Friction
from tests.explorer.scenes import SAMPLED, files, text_of

TEXT = demo_text("operating-points")
PAIR = Material(1.36), Friction(0.37, 0.85)
TITLES = "load_N,friction_force_N\n"


@cache
def demo():
    return answered(State(TEXT), 1)


def target(name):
    """Return a target with its handles, before any design."""
    return scene_of(State(text_of(name)), parsed(text_of(name)), None)


def points(text, friction=PAIR[1]):
    return lambda: read_points("m.csv", text, PAIR[0], friction)


def link(plain):
    return lambda: from_link("1." + base64.urlsafe_b64encode(zlib.compress(plain)).decode().rstrip("="))


def state(**members):
    return lambda: State.from_json(json.dumps({"text": "", **members}))


def sites(action, numbers, height="", design=demo):
    return lambda: edited(
        State(TEXT).table,
        demo().design if design else None,
        {"action": action, "sites": numbers, "height": height},
    )


def load(**given):
    return lambda: loaded(State(TEXT), files(**given))


def part(**typed):
    return lambda: new_part(FIRST | typed)


def in_use():
    """Ask for a port that another program has."""
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen()
        free_port(other.getsockname()[1])


STEEP = 'kind = "power"\nexponent = 500\nload_range = ["0.1 N", "0.4 N"]\nprefactor = 7'

# Each a call, the name of what is wrong, and the value that the message has.
TEXTS = [
    (lambda: State("[limits").table, "TOML", "line 1"),
    (lambda: with_values({"limits": 3}, {"limits.offset": "1 um"}), "section", "limits"),
    (lambda: with_field({}, "limits.depth", "3 um"), "no key", "limits.depth"),
    (lambda: with_kind_near(State(TEXT), None, "cubic"), "kind", "cubic"),
    (lambda: scene_of(State(TEXT), None, None), "specification", "problems"),
    (lambda: moved(target("points"), "point-7", 0.1, 1.0), "handle", "point-7"),
    (lambda: moved(target("points"), "point-0", -0.1, 1.0), "load", "-0.1"),
    (lambda: moved(target("points"), "point-0", 0.1, math.nan), "friction", "nan"),
    (lambda: added(target("linear"), 0.1, math.inf), "friction", "inf"),
    (lambda: added(target("linear"), 0.1, 1.0), "points", "linear"),
    (lambda: removed(target("one"), "point-0"), "last point", "one"),
    (lambda: removed(target("multilinear"), "range-low"), "removed", "multilinear"),
    (lambda: removed(target("power"), "exponent"), "removed", "power"),
    (lambda: moved(target(STEEP), "exponent", 0.1, 1.0), "target.load_range", "by hand"),
    (lambda: rounded(math.inf, 1e-3), "finite", "inf"),
]
STATES = [
    (lambda: State.from_json("[" * 10**5), "state", "JSON"),
    (state(other=1), "state", "its members"),
    (state(load=-1.0), "state", "its members"),
    (state(load=math.nan), "state", "its members"),
    (state(tables={"a": 1}), "state", "its members"),
    (state(newtons=1), "state", "its members"),
    (lambda: from_link("1." + "A" * LONGEST), f"{LONGEST + 2:,}", f"{LONGEST:,}"),
    (lambda: from_link("2.abc"), "link", "version"),
    (link(b"{}"), "link", "damaged"),
    (link(b"0" * (LARGEST + 1)), "link", "damaged"),
]
LAWS = [
    (points("\0"), "m.csv", "null"),
    (points("load_N,friction_N\n0.1,0.12\n"), "m.csv", "friction_N"),
    (points(TITLES + "0.1,many\n"), "m.csv", "many"),
    (points(TITLES + "0.1,0.2\n", None), "friction", "[friction]"),
    (lambda: with_nearest(demo()), "nearest law", "known"),
    (lambda: reachable(Answer(1, State(TEXT))), "law", "known"),
]
FILES = [
    (sites("pin", [1], design=None), "surface", "sites"),
    (sites("pin", []), "sites", "select"),
    (sites("shave", [1]), "sites", "select"),
    (sites("pin", [64]), "sites", "select"),
    (sites("pin", [True]), "sites", "select"),
    (lambda: typed_height("-3"), "height", "-3"),
    (load(a_toml=SAMPLED, b_toml=SAMPLED), "specifications", "several"),
    (load(law_csv=TITLES), "law.csv", "has no problems"),
    (load(a_csv=TITLES, b_csv=TITLES), "a.csv, b.csv", "one measured law"),
    (load(p_png=""), "p.png", "spec.toml"),
]
PARTS = [
    (part(size="20 × 20"), "size", "20 × 20"),
    (part(size="0 × 20 × 7"), "size", "0 × 20 × 7"),
    (part(asperities="8 × 1.5"), "asperities", "8 × 1.5"),
    (part(radius="small"), "radius", "small"),
]
STARTS = [
    (lambda: first_state("."), "spec.toml", "holds no"),
    (lambda: first_state("gone.toml"), "gone.toml", "no such file"),
    (lambda: explore(port=0), "port", "0"),
    (lambda: explore(port=65536), "port", "65536"),
    (in_use, "port", "in use"),
]
REFUSALS = {
    "texts": TEXTS, "states": STATES, "laws": LAWS, "files": FILES, "parts": PARTS, "starts": STARTS
}  # fmt: skip


@pytest.mark.parametrize("border", REFUSALS)
def test_what_is_wrong_is_named_with_its_value(border, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for row, (call, key, value) in enumerate(REFUSALS[border]):
        with pytest.raises(InvalidInput) as error:
            call()
        assert key in str(error.value), row
        assert value in str(error.value), row
