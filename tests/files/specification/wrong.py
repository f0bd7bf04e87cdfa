"""Wrong specifications: a change of the linear demo, and what the error says."""

from metafem.files import demo_text

LINEAR = demo_text("linear")
RADIUS = 'radius = "526 um"'

WRONG = {
    "bare number": ('"120 um"', "120", ["limits.max_height = 120 needs a unit", '"120 um"']),
    "unknown unit": ('"120 um"', '"120 foo"', ["limits.max_height", "foo"]),
    "wrong dimension": ('"1.36 MPa"', '"1.36 mm"', ["material.composite_modulus", "measure in MPa"]),
    "unknown key": ("max_height", "max_heigth", ["limits.max_heigth", "did you mean max_height?"]),
    "missing key": ('pitch = "1.5 mm"', "", ["lattice.pitch is missing", '"1.5 mm"']),
    "unknown section": ("[lattice]", "[latice]", ["latice is an unknown section", "did you mean lattice?"]),
    "unknown kind": ('"linear"', '"linaer"', ["target.kind", "did you mean linear?", "bilinear"]),
    "no kind": ('kind = "linear"', "", ["target.kind is missing"]),
    "list for a kind": ('kind = "linear"', "kind = []", ["target.kind"]),
    "no slope": ("slope = 6.87", "", ["target needs either slope or friction_coefficient"]),
    "foreign key": ("slope = 6.87", "slopes = [6, 7]", ["target.slopes is an unknown key", "slope?"]),
    "text for a number": ("slope = 6.87", 'slope = "6"', ["target.slope = '6'", "slope = 6.87"]),
    "nan": ("slope = 6.87", "slope = nan", ["target.slope = nan", "finite"]),
    "out of range": ("poisson_ratio = 0.5", "poisson_ratio = 0.6", ["material.poisson_ratio = 0.6"]),
    "bad slope": ("slope = 6.87", "slope = -1", ["target.slope = -1"]),
    "bad block": ('"7.2 mm"', '"0 mm"', ["block.thickness = 0"]),
    "bad radius": ('"526 um"', '"-526 um"', ["lattice.radius = -526 um must be greater than 0 um"]),
    "bad limits": ('"6 um"', '"6 m"', ["limits.height_step"]),
    "endless shape": ("[8, 8]", "[3000, 3000]", ["shape = [3000, 3000] has 9,000,000 sites; at most 2,"]),
    "absurd shape": ("[8, 8]", "[1000000000, 1000000000]", ["sites; at most 2,"]),
    "short shape": ("[8, 8]", "[8]", ["lattice.shape[1] is missing", "[8, 8]"]),
    "bad seed": ("seed = 0", "seed = -1", ["layout.seed = -1"]),
    "unknown model": ('"independent"', '"indpendent"', ["model.kind", "did you mean independent?"]),
    "alignment of one": ("[8, 8]", "[1, 1]", ["part.alignment_height", "at least two sites"]),
    "negative alignment": ('"400 um"', '"-4 um"', ["part.alignment_height"]),
    "no section": ("[target]", "checks = 3\n[target]", ["checks = 3 must be a section"]),
    "both": ("slope = 6.87", "slope = 6\nfriction_coefficient = 1", ["has slope and friction"]),
    "mixed range": ("slope = 6.87", 'slope = 6\nload_range = ["1 mm^2", "2 N"]', ["mixes mm^2 and N"]),
    "falling loads": (
        "slope = 6.87",
        'slope = 6\nload_range = ["0.3 N", "0.2 N"]',
        ["load_range[1] = 0.2 N does not exceed"],
    ),
    "loads in mm": (
        "slope = 6.87", 'slope = 6\nload_range = ["3 mm", "4 mm"]', ['"0.144 mm^2" or "0.2 N"']
    ),
    "loads as numbers": ("slope = 6.87", "slope = 6\nload_range = [1, 2]", ["load_range[0] = 1 needs a "]),
    "tilt without unit": ("seed = 0", "tilt = 0.1", ["layout.tilt = 0.1 needs a unit", '"0.1 deg"']),
    "no tilt": ("seed = 0", 'tilt = "0 deg"', ["layout.tilt = 0 deg must be greater than 0 deg"]),
    "weight alone": ("seed = 0", "tilt_weight = 2", ["layout.tilt_weight needs tilt"]),
    "unknown layout": ("seed = 0", "folow_law = true", ["layout.folow_law", "did you mean follow_law?"]),
    "no radius": (RADIUS, "", ["lattice.radius is missing", '"526 um"', "[tools]"]),
    "radii twice": ("[block]", '[tools]\nradii = ["1 mm"]\n[block]', ["lattice.radius and [tools] both"]),
    "no tools at all": ("[block]", "[tools]\n[block]", ["tools needs either radii or radius_range or exp"]),
    "no tools": ("[block]", "[tools]\nradii = []\n[block]", ["tools.radii = []", '["300 um", "526 um"]']),
    "bad tool": ("[block]", '[tools]\nradii = ["0 mm"]\n[block]', ["tools.radii[0] = 0 mm must be gr"]),
    "falling range": (
        "[block]", '[tools]\nradius_range = ["2 mm", "1 mm"]\n[block]', ["must increase, but is [2 mm, 1 mm]"]
    ),
    "short range": ("[block]", '[tools]\nradius_range = ["2 mm"]\n[block]', ["tools.radius_range[1] is mis"]),
    "unknown radii": ("[block]", '[tools]\nradius = ["2 mm"]\n[block]', ["tools.radius", "mean radii?"]),
    "no crossover": (
        'kind = "linear"',
        'kind = "multilinear"\ncrossover_loads = [[]]',
        ["target.crossover_loads[0] = [] must be a load or a pair of loads"],
    ),
    "no numbers": ("[8, 8]", "[8.5, 8]", ["lattice.shape[0]"]),
    "no list": ("[8, 8]", "8", ["lattice.shape = 8 must be a list"]),
    "list": ('"1.5 mm"', '["1.5 mm"]', ["lattice.pitch"]),
    "truth": ("seed = 0", "seed = true", ["layout.seed = true must be a whole number"]),
    "wrong angle": ("seed = 0", 'tilt = "0.1 mm"', ["layout.tilt"]),
    "foreign format": ("[part]", '[part]\nformats = ["step"]', ["part.formats"]),
    "no chord error": ("[part]", '[part]\nchord_error = "0 um"', ["part.chord_error"]),
    "no cap": (
        "[model]",
        '[contact]\nkind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap.kind = "jkr"\n[model]',
        ["contact.cap.kind"],
    ),
    "truncated": ("shape = [8, 8]", "shape = [8,", ["not valid TOML", "line", 'in quotes, such as "1.5 mm"']),
}  # fmt: skip
