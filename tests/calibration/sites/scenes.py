"""Contacts of images of lattices, without images."""

import numpy as np

from metafem.calibration import ContactAreas


def contacts(centre, radius, *, shape=(1400, 1400), pixel=0.01, edge=(), merged=(), **more):
    """Return the contacts of an image: circles, of which those of the given indices are flagged."""
    centre = np.asarray(centre, dtype=float)
    n = len(centre)
    area = np.pi * np.broadcast_to(np.asarray(radius, dtype=float), n) ** 2
    none = np.zeros(n, dtype=bool)
    values = {
        "area": area,
        "area_error": 0.01 * area,
        "otsu_area": area,
        "centre": centre,
        "axes": np.column_stack([np.sqrt(area / np.pi)] * 2),
        "angle": np.zeros(n),
        "edge": np.isin(np.arange(n), edge),
        "merged": np.isin(np.arange(n), merged),
        "saturated": none,
        "holes": np.zeros(n, dtype=int),
        "threshold": 0.7,
        "dark_level": 0.3,
        "blur": 1.5 * pixel,
        "noise": 0.01,
        "pixel_size": pixel,
        "shape": shape,
    }
    return ContactAreas(**{**values, **more})
