"""A design that tolerates the errors of the made part, and the files to make it.

You learn how to design for the surface as it will be made: the expected misfit under errors of the
heights is minimised, in place of the misfit of the exact heights. It is checked with 300 random
surfaces. The design is saved with the solids of block and mould and a drawing, and read back.
"""

import tempfile
from pathlib import Path

import numpy as np
from matplotlib import pyplot

import metafem as mf

material = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)  # E* [MPa]
block = mf.Block(width=10.0, length=10.0, thickness=7.2)  # [mm]
template = mf.Surface.square_lattice(
    0.12, shape=(5, 5), pitch=1.5, radius=0.526, material=material, block=block
)
load, area = np.array([0.06, 0.15, 0.3]), np.array([0.35, 0.75, 1.7])  # P/E* and F/(σB) [mm²]
target, limits = mf.OperatingPoints(load, area), mf.Limits(max_height=0.27)  # [mm]

plain = mf.design(target, template, limits=limits)
robust = mf.design(target, template, limits=limits, robust=mf.Tolerances(height_sd=0.003))  # [mm]
ax = pyplot.figure(figsize=(5.0, 3.6), layout="constrained").add_subplot()
for words, design, key in (("plain", plain, "plain_expected_misfit"), ("robust", robust, "expected_misfit")):
    made = [design.surface.perturbed(0.003, rng=i) for i in range(300)]
    errors = [mf.friction_law(each, load=material.composite_modulus * load).area / area - 1 for each in made]
    misfits, expected = np.sqrt(np.mean(np.square(errors), axis=1)), robust.parameters[key]
    rms = np.sqrt(np.mean(misfits**2))
    print(f"{words}: misfit as designed {design.misfit:.2%}, as made {rms:.2%}, expected {expected:.2%}")
    assert abs(rms / expected - 1) < 0.1
    ax.hist(100 * misfits, bins=np.linspace(0, 5, 31), alpha=0.6, label=words)
ax.set(xlabel="misfit of made surfaces [%]", ylabel="number of 300")
ax.legend(frameon=False)

with tempfile.TemporaryDirectory() as parent:
    folder = Path(parent, "robust")
    mf.save(robust, folder)
    print(", ".join(sorted(path.name for path in folder.glob("[a-z]*"))))
    assert mf.load(folder) == robust

# The misfits of 300 made surfaces of each design: errors of the heights matter less to the robust design.
figure = ax.figure
