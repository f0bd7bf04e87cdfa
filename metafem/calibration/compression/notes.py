"""What a calibration of contacts leaves open, in sentences."""

from __future__ import annotations

import math

from metafem._values import percent
from metafem.calibration.compression.data import FEWEST
from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.contact_table import listed
from metafem.contact import Contact, TabulatedContact
from metafem.notes import Note, information

# Contact radius over R beyond which large strain bends the law. Up to there the load of a soft cap
# (neo-Hookean, incompressible) is 1 to 4 % below Hertz's, and at 0.76 R from 2 % below to 1 % above it,
# depending on the height of the cap: tables of finite elements, meshes/deep_caps.csv.
KNOWN = 0.5


def notes_of(found: ContactCalibration, cap: Contact, draws: int) -> tuple[Note, ...]:
    """Return notes on range, adhesion, fit and tests."""
    notes = []
    contacts = 1 if found.area.ndim == 2 else found.contacts
    widest = math.sqrt(float(found.area.max()) / contacts / math.pi) / found.radius
    if widest > KNOWN and not isinstance(cap, TabulatedContact):
        notes.append(
            Note(
                f"contact radii reach {widest:.2f} R; beyond {KNOWN} R the load of a soft cap at large "
                "strain rises from 3 to 4 % below Hertz's law to nearly that law, and the fit takes the bend "
                "for adhesion. Leave out the largest loads, or use the table of metafem.fe.tabulated_contact "
                "as the contact law"
            )
        )
    if found.adhesion_energy_interval[0] == 0.0:
        modulus, sd = found.modulus_without_adhesion
        notes.append(
            information(
                f"the data do not show adhesion: the 68 % interval of w begins at 0; with w = 0, "
                f"E* = {modulus:.4g} ± {sd:.2g} MPa"
            )
        )
    elif isinstance(cap, TabulatedContact):
        notes.append(
            Note("contact_law is the table without adhesion, as models need the profile of an adhesive cap")
        )
    if not found.verdict.fits:
        notes.append(Note(f"{found.verdict}; the stated uncertainties hold only for a law that fits"))
    if found.heterogeneity is not None and not found.heterogeneity.agree:
        notes.append(found.heterogeneity.note())
    unfitted = [test for test in found.tests if test.composite_modulus is None]
    few = [test.name for test in unfitted if test.points < FEWEST]
    if few:
        notes.append(information(f"no fit of their own have the tests {listed(few)}: too few points"))
    other = [test.name for test in unfitted if test.points >= FEWEST]
    if other:
        notes.append(
            Note(
                f"no fit of their own have the tests {listed(other)}: their areas are alike, or their loads "
                "do not grow with them; they are part of the common fit, but not compared with others"
            )
        )
    if found.bootstrap is not None and len(found.bootstrap) < draws:
        lost = draws - len(found.bootstrap)
        notes.append(Note(f"{lost} of the {draws} draws of the bootstrap have no fit and are left out"))
    if found.radius_sd:
        share = abs(found.radius_change[0]) / found.composite_modulus
        notes.append(information(f"the error of the radius alone changes E* by {percent(share)}"))
    return tuple(notes)
