"""A finite-element check of one cap.

You learn how to press the true spherical cap on its block with finite elements, how exact that
solution is, and how it compares with closed forms. At small strain the load agrees with the law of
the sphere, and is 11 % above Hertz's where the contact radius is half that of the cap. The strain
is then large, and the load of a soft cap is within 3 % of Hertz's law: see
`python -m validation fe_finite_strain`.
"""

import numpy as np
from matplotlib import pyplot

import metafem as mf

a, radius = 0.26, 0.526  # of the contact and of the cap [mm]
contact = mf.fe.press(
    contact_radius=a, radius=radius, poisson_ratio=0.5, height=0.2, thickness=7.2, block_radius=10.0
)
print(f"load P/E* {contact.rescaled_load:.5f} mm², indentation {1e3 * contact.indentation:.1f} µm")
print(f"relative error of the elements: at most {contact.error_estimate:.1e}")

hertz = 4 * a**3 / (3 * radius)
sphere = (a**2 + radius**2) / 2 * np.log((radius + a) / (radius - a)) - a * radius
print(f"load over that of Hertz's law: {contact.rescaled_load / hertz:.4f}")
print(f"load over that of the sphere's law: {contact.rescaled_load / sphere:.4f}")
assert abs(contact.rescaled_load / sphere - 1) < 0.005

r = np.linspace(0.0, a, 200)
ax = pyplot.figure(figsize=(5.0, 3.6), layout="constrained").add_subplot()
ax.plot(r, contact.pressure(r), label="finite elements")
ax.plot(r, 1.5 * hertz / (np.pi * a**2) * np.sqrt(1 - (r / a) ** 2), "--", label="Hertz")
ax.set(xlabel="distance from the axis [mm]", ylabel="pressure p/E* [-]", ylim=(0, None))
ax.legend(frameon=False)

# The pressure below the true cap is larger than Hertz's in the whole contact.
figure = ax.figure
