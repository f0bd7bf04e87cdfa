"""What explains a measured law, as the dataset that a result folder keeps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.calibration import Explanation
from metafem.studies.sampling.dataset import dataset
from metafem.studies.sampling.store import inputs_hash

if TYPE_CHECKING:
    import xarray as xr


def explained(found: Explanation) -> xr.Dataset:
    """Return the explanation of a measured law.

    Parameters
    ----------
    found : metafem.calibration.Explanation

    Returns
    -------
    xarray.Dataset
        Over ``cause``: ``prior_sd``, ``mean`` and ``sd`` [rad or relative], and ``covariance`` over ``cause``
        and ``other_cause``. Over ``group``: ``share`` of the explained misfit, and
        ``misfit_without`` the group. Over ``site``: ``height`` and
        ``radius`` [mm] with ``..._sd``, and ``outlier``; over ``kind``: their ``single_prior_sd`` [mm]. Over
        ``sentence``: the explanation in words. Single numbers are ``misfit_design``, ``misfit`` and
        ``values``, their expected size.

    Examples
    --------
    >>> import metafem as mf
    >>> from metafem.calibration import MeasuredLaw, explain
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> measured = MeasuredLaw([0.1, 0.2], area=[0.42, 0.7], material=material)
    >>> explained(explain(measured, design, model=mf.Independent())).cause.values.tolist()
    ['angle_x', 'angle_y', 'height_scale', 'composite_modulus']
    """
    names = [cause.name for cause in found.causes]
    variables: dict[str, tuple[tuple[str, ...], Any]] = {
        name: (("cause",), np.array([getattr(cause, name) for cause in found.causes]))
        for name in ("prior_sd", "mean", "sd")
    }
    variables["covariance"] = ("cause", "other_cause"), found.covariance
    variables["share"] = ("group",), np.array(list(found.shares.values()))
    variables["misfit_without"] = ("group",), np.array(list(found.misfit_without.values()))
    variables["sentence_text"] = ("sentence",), np.array(found.sentences())
    kinds = [name for name in ("height", "radius") if name in found.single]
    for name in kinds:
        errors = found.single[name]
        variables |= {name: (("site",), errors.mean), f"{name}_sd": (("site",), errors.sd)}
    if kinds:
        variables["single_prior_sd"] = ("kind",), np.array([found.single[name].prior_sd for name in kinds])
        variables["outlier"] = ("site",), np.isin(np.arange(found.surface.count), found.outliers).astype(int)
    sites = np.arange(found.surface.count) if found.sites is None else found.sites
    for name in ("misfit_design", "misfit"):
        variables[name] = (), getattr(found, name)
    variables["values"] = (), found.count
    return dataset(
        "explained",
        variables,
        {
            "cause": np.array(names, dtype=str),
            "other_cause": np.array(names, dtype=str),
            "group": np.array(list(found.shares), dtype=str),
            "kind": np.array(kinds, dtype=str),
            **({"site": sites} if kinds else {}),
        },
        model=found.model,
        inputs=inputs_hash((found,)),
        notes=found.notes,
    )
