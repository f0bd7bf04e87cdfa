"""The contacts of a stack of images, as a value."""

from __future__ import annotations

from dataclasses import dataclass

from metafem._values import Value
from metafem.calibration.contact_table import ContactTable
from metafem.calibration.sites.placement import Placed
from metafem.calibration.sites.site_match import SiteMatch
from metafem.notes import Note


@dataclass(frozen=True, eq=False, repr=False)
class TrackedContacts(Value):
    """The contacts of a stack of images, and where they are seen.

    Attributes
    ----------
    table : ContactTable
    reference : int
        Index of the image with most contacts, whose contacts were matched or, without sites, numbered.
    match : SiteMatch or None
        Match of that image; None without sites.
    placed, placed_sheared : tuple, (k,)
        For each image the sites in it: ``position`` (m, 2) [mm], and ``site`` (n,) of each of its contacts,
        -1 where there is none; None where there is no image.
    notes : tuple of Note

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> areas = mf.calibration.contact_areas(image, 0.005)
    >>> tracked = mf.calibration.track_contacts([areas], ["1.tif"], load=[0.05])
    >>> tracked.table.area.shape, tracked.reference, tracked.match
    ((1, 1), 0, None)
    """

    table: ContactTable
    reference: int
    match: SiteMatch | None
    placed: tuple[Placed | None, ...]
    placed_sheared: tuple[Placed | None, ...]
    notes: tuple[Note, ...] = ()
