"""Tables of contacts from arrays."""

import pandas as pd

from metafem.calibration import contact_table


def table_of(image, test, load, friction_force, position, site, matched, *areas):
    """Return the table of contacts in images; `areas` are (images, contacts)."""
    forces = pd.DataFrame({"image": image, "test": test, "load": load, "friction_force": friction_force})
    return contact_table(forces, position, site if matched else None, *areas)
