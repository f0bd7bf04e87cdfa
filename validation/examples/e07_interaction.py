"""Asperities that interact through the elastic block.

Each contact deforms the block and lowers its neighbours. You learn how to predict the law of
independent asperities, and of asperities that interact through a half-space or through a bonded layer,
which is close to the true block. Then the heights are refined until the law on the layer is right.
"""

import numpy as np
from matplotlib import pyplot

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
block = mf.Block(width=20.0, length=20.0, thickness=7.2)  # [mm]
template = mf.Surface.square_lattice(
    0.12, shape=(8, 8), pitch=1.5, radius=0.526, material=material, block=block
)
target = mf.LinearLaw(6.87, load_range=(0.05, 0.2))  # slope of A0 over P/E* [-]; P/E* [mm²]
limits = mf.Limits(max_height=0.12, offset=0.05)  # [mm]

half_space, layer = mf.Interacting(substrate=mf.HalfSpace()), mf.Interacting(substrate=mf.BondedLayer())
simple = mf.design(target, template, limits=limits).surface
refined = mf.design(target, template, model=layer, limits=limits).surface

rescaled = np.linspace(0.05, 0.2, 31)
ax = pyplot.figure(figsize=(5.0, 3.6), layout="constrained").add_subplot()
largest = []
for surface, model, words in (
    (simple, mf.Independent(), "independent asperities"),
    (simple, half_space, "on a half-space"),
    (simple, layer, "on the layer"),
    (refined, layer, "on the layer, refined"),
):
    law = mf.friction_law(surface, model, load=rescaled * material.composite_modulus)
    difference = 100 * (law.area / (target.slope * rescaled) - 1)
    largest.append(np.abs(difference).max())
    print(f"{words}: at most {largest[-1]:.2f} % from the target")
    ax.plot(rescaled, difference, label=words)
assert largest[3] < 1 < largest[2]

ax.set(xlabel="P/E* [mm²]", ylabel="difference of A0 from the target [%]", ylim=(-3, 1))
ax.legend(frameon=False)

# Interaction changes the contact area by up to 2 %. The refined heights bring it back to the target.
figure = ax.figure
