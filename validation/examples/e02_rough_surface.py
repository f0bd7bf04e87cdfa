"""The law of a rough surface, and its slope.

Each contact obeys Hertz's law, but the law of many asperities of different heights is almost a
straight line. You learn how to compute the real contact area over the load, A0(P), and how to fit
its slope. For heights of exponential density with the scale λ, theory predicts the slope √(πR/λ).
"""

import numpy as np

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
radius, scale = 0.526, 0.02  # of the asperities, and λ of the heights [mm]

# 32 × 32 asperities, whose heights are evenly spread over the exponential distribution
count = 32 * 32
height = -scale * np.log((np.arange(count) + 0.5) / count)
surface = mf.Surface.square_lattice(height, shape=(32, 32), pitch=1.5, radius=radius, material=material)

law = mf.friction_law(surface, load=np.linspace(0.02, 2.0, 100))  # [N]
fit = law.fit(load=(0.1, 2.0))
theory = np.sqrt(np.pi * radius / scale)
for load in (0.02, 0.2, 2.0):
    state = mf.equilibrium(surface, load=load)
    touching = np.count_nonzero(state.asperity_area)
    print(f"at {load} N {touching} of {count} asperities touch, over {state.area:.2f} mm²")
print(f"slope of A0 over P/E* [-]: fitted {fit.slope:.2f}, √(πR/λ) is {theory:.2f}")
assert abs(fit.slope / theory - 1) < 0.02

ax = law.plot(label="A0(P)")
x = law.rescaled_load
ax.plot(x, theory * x, "--", color="tab:orange", label="slope √(πR/λ)")
ax.legend(frameon=False)

# The law of 1,024 asperities and the straight line of the theory: the two can hardly be told apart.
figure = ax.figure
