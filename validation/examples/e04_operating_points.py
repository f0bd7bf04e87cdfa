"""A law through given points.

A machine needs a certain friction force at each of three loads. You learn how to state a target by
points in newtons, and that the law of the design passes through them. The points are about those of
the paper's Fig. 3. Its surface has three levels of asperities, and between them single asperities that
adjust the area at each point.
"""

import numpy as np

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
friction = mf.Friction(shear_strength=0.37, area_ratio=0.85)  # σ [MPa], B [-]
template = mf.Surface.square_lattice(
    0.27, shape=(8, 8), pitch=1.5, radius=0.526, material=material, friction=friction
)

load = np.array([0.196, 0.457, 0.883])  # P [N]
force = np.array([0.264, 0.528, 1.296])  # F [N]
target = mf.OperatingPoints.from_forces(load, force, material, friction)
design = mf.design(target, template, limits=mf.Limits(max_height=0.27))  # [mm]

for level, count in zip(design.parameters["levels"], design.parameters["counts"], strict=True):
    print(f"{count:2d} asperities of {level * 1e3:.1f} µm")
print(f"{design.surface.count} asperities in all, with those of adjusted height")

law = mf.friction_law(design.surface, load=load)
for P, wanted, achieved in zip(load, force, law.friction_force, strict=True):
    print(f"at {P:.3f} N: wanted {wanted:.3f} N, achieved {achieved:.3f} N")
assert np.allclose(law.friction_force, force, rtol=1e-6)

# The law passes through the three points; it is steeper where a new level of asperities comes into contact.
figure = design.plot().figure
