"""Bands around the laws of known surfaces: how many of 200 perturbed surfaces are brought into them.

Run ``python -m validation.benchmark.bands``.
"""

import time

import numpy as np

import metafem as mf
from validation.scenes.bands import scene

# Number of surfaces.
TRIALS = 200


def main() -> None:
    """Print the number of surfaces brought into their bands, the changes and the times."""
    ratios, times, lowered = [], [], 0
    for seed in range(TRIALS):
        known, made, band = scene(seed)
        start = time.perf_counter()
        try:
            change = mf.brought_into(made, band).change
            ratios.append(float(np.linalg.norm(change) / np.linalg.norm(known.height - made.height)))
        except mf.Infeasible:
            pass
        times.append(time.perf_counter() - start)
        try:
            mf.brought_into(made, band, only_lower=True)
            lowered += 1
        except mf.Infeasible:
            pass
    print(f"{len(ratios)} of {TRIALS} found, median {np.median(times):.3f} s, longest {max(times):.3f} s")
    print(f"change relative to the errors: median {np.median(ratios):.3f}, largest {max(ratios):.3f}")
    print(f"only lowered: {lowered} of {TRIALS} found")


if __name__ == "__main__":
    main()
