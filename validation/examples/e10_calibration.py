"""The material from measured contact areas.

The models need the composite modulus E* and the adhesion energy w of the material pair. You learn
how to find both from loads and areas of one contact, with their errors. The measurement is made
here from known values, with random errors, so that the answer can be checked.
"""

import numpy as np

import metafem as mf

radius, modulus, adhesion = 0.526, 1.36, 3e-5  # [mm], E* [MPa], w [N/mm]: 30 mJ/m²
asperity = mf.Surface([[0.0, 0.0]], [0.12], radius, mf.Material(composite_modulus=modulus, poisson_ratio=0.5))
load = np.geomspace(0.002, 0.15, 25)  # [N]
area = mf.friction_law(asperity, mf.Independent(contact=mf.JKR(adhesion)), load=load).area  # [mm²]

errors = mf.calibration.MeasurementErrors(load=0.0005, boundary=0.0014)  # [N], [mm]
rng = np.random.default_rng(0)
measured_load = load + rng.normal(0.0, errors.of_load(load))
measured_area = area + rng.normal(0.0, errors.of_area(area))

found = mf.calibration.fit_compression(measured_load, measured_area, radius, errors=errors)
stiffness, energy = found.estimates["composite_modulus"], found.estimates["adhesion_energy"]
print(f"E*: true {modulus:.2f} MPa, found {stiffness.value:.3f} ± {stiffness.sd:.3f} MPa")
print(f"w: true {1e6 * adhesion:.1f} mJ/m², found {1e6 * energy.value:.1f} ± {1e6 * energy.sd:.1f} mJ/m²")
assert abs(stiffness.value - modulus) < 2 * stiffness.sd
assert abs(energy.value - adhesion) < 2 * energy.sd

cap = asperity.replaced(material=found.material)
ax = mf.friction_law(cap, mf.Independent(contact=found.contact_law), load=load).plot(label="fitted law")
given = {"material": found.material, "errors": errors}
mf.calibration.MeasuredLaw(measured_load, area=measured_area, **given).plot(ax, label="measured")

# The measured areas with their errors, and the fitted law.
figure = ax.figure
