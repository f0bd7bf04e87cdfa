"""One contact, and Hertz's law.

A rigid plane is pressed onto one spherical asperity of an elastomer. You learn how to state a
material and a surface, how to compute the equilibrium under a load, and in which units the results
are. The contact radius and the indentation are compared with Hertz's closed form. The picture shows
rescaled quantities: P/E* and F/(σB), which is the contact area A0, both in mm².
"""

import numpy as np

import metafem as mf

radius = 0.526  # of the asperity [mm]
material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
surface = mf.Surface(position=[[0.0, 0.0]], height=[0.12], radius=radius, material=material)

load = 0.02  # [N]
state = mf.equilibrium(surface, load=load)
contact_radius = np.sqrt(state.area / np.pi)
print(f"load {load} N: contact radius {1e3 * contact_radius:.2f} µm")
print(f"indentation {1e3 * state.approach:.2f} µm, plane {1e3 * state.separation:.2f} µm above the base")
print(f"contact stiffness dP/dδ {state.stiffness:.3f} N/mm")

# Hertz: a³ = 3 R P / (4 E*), and the indentation is a² / R
hertz_radius = (3 * radius * load / (4 * material.composite_modulus)) ** (1 / 3)
hertz_indentation = hertz_radius**2 / radius
print(f"Hertz: {1e3 * hertz_radius:.2f} µm and {1e3 * hertz_indentation:.2f} µm")
assert np.allclose((contact_radius, state.approach), (hertz_radius, hertz_indentation), rtol=1e-9)

law = mf.friction_law(surface, load=np.linspace(0.0005, 0.03, 60))
ax = law.plot(label="metafem")
x = law.rescaled_load[4::6]
ax.plot(x, np.pi * (0.75 * radius * x) ** (2 / 3), "o", color="tab:orange", label="Hertz")
ax.legend(frameon=False)

# The contact area of one asperity increases as the load to the power 2/3.
figure = ax.figure
