"""A specification with changed sections."""

from functools import cache

import metafem as mf
from metafem.files import parsed

# The sections of the plainest specification.
PLAIN = {
    "target": 'kind = "linear"\nslope = 6.87',
    "material": 'composite_modulus = "1.36 MPa"\npoisson_ratio = 0.5',
    "friction": 'shear_strength = "0.358 MPa"\narea_ratio = 0.85',
    "lattice": 'shape = [8, 8]\npitch = "1.5 mm"\nradius = "526 um"',
    "block": 'width = "20 mm"\nlength = "20 mm"\nthickness = "7.2 mm"',
    "limits": 'max_height = "120 um"\noffset = "84 um"',
}
SHAPE = 'shape = [8, 8]\npitch = "1.5 mm"'  # a lattice without a radius


def text(**sections):
    """Return the text of the plain specification with other sections, or without those that are None."""
    merged = {name: keys for name, keys in {**PLAIN, **sections}.items() if keys is not None}
    return "\n".join(f"[{name}]\n{keys}" for name, keys in merged.items()) + "\n"


def spec(tables=None, **sections):
    """Return the specification with other sections; `tables` holds the texts of the tables by name."""
    return parsed(text(**sections), {name: table.encode() for name, table in (tables or {}).items()})


@cache
def small():
    """Return a specification of nine summits and its design, which meets two points."""
    points = 'rescaled_load = ["0.02 mm^2", "0.05 mm^2"]\nrescaled_friction = ["0.16 mm^2", "0.36 mm^2"]'
    found = spec(
        target=f'kind = "operating-points"\n{points}',
        lattice='shape = [3, 3]\npitch = "1.5 mm"\nradius = "526 um"',
        limits='max_height = "160 um"',
        part='alignment_height = "400 um"\nchord_error = "2 um"',
        model='kind = "independent"',
        checks='hardness = "10 MPa"',
    )
    return found, mf.design(found.target, found.template, limits=found.limits)
