"""Any increasing law: a table, a power of the load, and a law that no surface has.

You learn how to give a target as a table of loads and friction forces or as a power law, and what
happens with a target that cannot be reached. The error `Infeasible` states the reason, and holds
the nearest target that can be designed.
"""

import io

import numpy as np

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
friction = mf.Friction(shear_strength=0.358, area_ratio=0.85)  # σ [MPa], B [-]
template = mf.Surface.square_lattice(0.12, shape=(8, 8), pitch=1.5, radius=0.526, material=material)
limits = mf.Limits(max_height=0.27, offset=0.05)  # [mm]

# `np.loadtxt` reads a file in the same way.
table = io.StringIO("load_N,force_N\n0.05,0.08\n0.1,0.155\n0.2,0.32\n0.3,0.47\n0.4,0.60\n")
load, force = np.loadtxt(table, delimiter=",", skiprows=1, unpack=True)
sampled = mf.design(mf.SampledLaw.from_forces(load, force, material, friction), template, limits=limits)
print(f"table: misfit {sampled.misfit:.2%}")
assert sampled.misfit < 0.01

# A power law: F increases as the load to the power 1.2 over a range of P/E* [mm²].
power = mf.design(mf.PowerLaw(1.2, load_range=(0.1, 0.4)), template, limits=limits)
print(f"exponent 1.2: misfit {power.misfit:.2%}")
assert power.misfit < 0.01

try:  # asperities of one height have the exponent 2/3, by Hertz's law; no surface of one radius has less
    mf.design(mf.PowerLaw(0.5, load_range=(0.1, 0.4)), template, limits=limits)
except mf.Infeasible as error:
    print(f"exponent 0.5: {error}")
    nearest = mf.design(error.nearest, template, limits=limits)
print(f"exponent {nearest.target.exponent:.4f}: misfit {nearest.misfit:.2%}")
assert abs(nearest.target.exponent - 2 / 3) < 1e-10  # a design keeps 11 digits of its target

ax = nearest.law.plot(label="exponent 2/3")
ax.plot(sampled.law.rescaled_load, sampled.law.area, color="tab:orange", label="table")
ax.plot(power.law.rescaled_load, power.law.area, color="tab:green", label="exponent 1.2")
ax.legend()

# The laws of the three designs: friction may increase faster or more slowly than the load.
figure = ax.figure
