"""A surface with the friction coefficient that you choose.

The inverse of the last example: the friction coefficient is given, and the heights are found. You
learn how to state the friction of a material pair, a target and the limits of the workshop, and how
to read the design. The friction force is F = σ B A0, so that a straight law A0(P) has a constant
friction coefficient dF/dP.
"""

import numpy as np

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
friction = mf.Friction(shear_strength=0.358, area_ratio=0.85)  # σ [MPa], B [-]
# the sites and the radius of the asperities; the design replaces the heights
template = mf.Surface.square_lattice(
    0.12, shape=(8, 8), pitch=1.5, radius=0.526, material=material, friction=friction
)
limits = mf.Limits(max_height=0.12, offset=0.05, height_sd=0.0009)  # [mm]
lowest, highest = mf.achievable_friction_coefficients(template, limits)
print(f"friction coefficients within these limits: {lowest:.2f} to {highest:.2f}")
assert np.allclose((lowest, highest), (1.10, 3.03), atol=0.005)  # as printed in the paper

wanted = 2.0
design = mf.design(
    mf.LinearLaw.from_friction_coefficient(wanted, material, friction), template, limits=limits
)
height = 1e3 * design.surface.height  # [µm]
print(f"{design.surface.count} asperities of {height.min():.1f} to {height.max():.1f} µm above the base")
print(f"scale λ of their exponential density: {1e3 * design.parameters['scale']:.1f} µm")

fit = design.fits[0][1]  # a straight line through the law of the design
print(f"friction coefficient dF/dP: wanted {wanted:.3f}, achieved {fit.friction_coefficient:.3f}")
assert abs(fit.friction_coefficient / wanted - 1) < 0.02

# The law is straight over the shaded loads. It bends where all asperities are in contact.
figure = design.plot().figure
