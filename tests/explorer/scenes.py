"""A specification of a sampled law, and its table."""

SAMPLED = """
[target]
kind = "sampled"
file = "wanted.csv"
[material]
composite_modulus = "1.36 MPa"
[lattice]
shape = [3, 3]
pitch = "1.5 mm"
radius = "526 um"
[limits]
max_height = "120 um"
"""
WANTED = "rescaled_load_mm2,rescaled_friction_mm2\n0.01,0.1\n0.03,0.25\n0.05,0.4\n"
