"""A law of two slopes that meet at a crossover load.

Friction increases slowly at light loads and faster above a crossover. You learn how to state such a
law over a range of loads, how its two branches are fitted, and how the crossover follows from the
two lines. The law is rescaled: A0 = F/(σB) over P/E*, both in mm², so that it holds for any
material pair.
"""

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
template = mf.Surface.square_lattice(0.12, shape=(8, 8), pitch=1.5, radius=0.526, material=material)

slopes, crossover = (7.15, 11.0), 0.07  # of A0 over P/E* [-], and P/E* where they meet [mm²]
target = mf.BilinearLaw(slopes, crossover, load_range=(0.03, 0.15))
design = mf.design(target, template, limits=mf.Limits(max_height=0.12, offset=0.05))  # [mm]
print(f"{design.surface.count} asperities; largest difference from the target {design.misfit:.2%}")
assert design.misfit < 0.01

# Each branch of the law is fitted by a line A0 = slope · P/E* + intercept.
(_, below), (_, above) = design.fits
found = (below.intercept - above.intercept) / (above.slope - below.slope)
print(f"slopes: wanted {slopes[0]:.2f} and {slopes[1]:.2f}, achieved {below.slope:.2f} and {above.slope:.2f}")
print(f"crossover: wanted {crossover:.4f} mm², achieved {found:.4f} mm²")
print(f"on this material that is a load of {1e3 * found * material.composite_modulus:.0f} mN")
assert abs(found / crossover - 1) < 0.01

# The law follows both lines of the target. The loads of the two branches are shaded.
figure = design.plot().figure
