"""How accurate the part must be.

No surface is made as designed, and no plane is exactly parallel to it. You learn how errors of the
heights and a tilt scatter the slope of the law, which is proportional to the friction coefficient.
The surface is that of the red law in the paper's Fig. 4, which was made with a precision of 0.9 µm.
"""

import numpy as np
from matplotlib import pyplot

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
template = mf.Surface.square_lattice(0.12, shape=(8, 8), pitch=1.5, radius=0.526, material=material)
limits = mf.Limits(max_height=0.12, offset=0.084, height_step=0.006)  # [mm]
surface = mf.design(mf.LinearLaw(6.87), template, limits=limits).surface

height_sd = np.array([0.0003, 0.0009, 0.0018, 0.003])  # [mm]
made = mf.studies.manufacturing(surface, height_sd, draws=1000)
scatter = 100 * made.slope_sd / made.nominal_slope
for sd, value in zip(height_sd, scatter.values, strict=True):
    print(f"heights with errors of {1e3 * sd:.1f} µm (SD): the slope scatters by {value:.2f} % (SD)")
assert scatter[1] < 0.5  # the paper's bounds at 0.9 µm
assert scatter[3] < 1.5  # and at 3 µm

angle = np.radians(np.linspace(0.005, 0.1, 20))
tilted = mf.studies.misalignment(surface, angle, assignments=20)
variation = 100 * tilted.slope_sd / tilted.nominal_slope
print(
    f"tilts up to 0.1°: {variation[1:, -1].min():.1f} to {variation[1:, -1].max():.1f} %, by the assignment"
)

left, right = pyplot.figure(figsize=(8.0, 3.4), layout="constrained").subplots(1, 2, sharey=True)
left.plot(1e3 * height_sd, scatter, "o-")
left.set(xlabel="error of the heights, SD [µm]", ylabel="scatter of the slope, SD [%]")
right.plot(np.degrees(angle), variation[1:].T, color="grey", lw=0.7)
right.plot(np.degrees(angle), variation[0], lw=2, label="this assignment; grey: 20 others")
right.set(xlabel="largest tilt [°]", ylim=0)
right.legend(frameon=False)

# Both errors scatter the slope; the effect of a tilt depends on where the tall asperities stand.
figure = left.figure
