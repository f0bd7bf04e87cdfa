"""Estimated errors of A0(P), against resolved contacts and order 3, for every model."""

import json
import math
import pickle
from itertools import product

import numpy as np

import metafem as mf
from metafem.files.result import from_record, written
from metafem.models.error import DISPLACEMENTS, RADII

MATERIAL = mf.Material(1.36)


def rough(pitch, thickness=None, side=3):
    height = 0.1 + 0.02 * np.random.default_rng(1).random(side**2)
    block = None if thickness is None else mf.Block(20.0, 20.0, thickness)
    return mf.Surface.square_lattice(
        height, (side, side), pitch, radius=0.526, material=MATERIAL, block=block
    )


def test_errors_of_coarser_models_are_those_against_order_3():
    """Up to a factor of three, as for `Automatic`; the estimate of a small error has a safety margin."""
    load = np.array([0.02, 0.1])
    for law, pitch in product((mf.Hertz(), mf.Elastic(mf.Sphere())), (20.0, 1.5, 0.8)):
        surface = rough(pitch)
        truth = mf.friction_law(surface, mf.Interacting(contact=law), load=load)
        for model in (mf.Independent(law), mf.Interacting(1, contact=law)):
            found = mf.friction_law(surface, model, load=load)
            error = np.abs(found.area / truth.area - 1.0).max()
            assert error / 3.0 <= found.model_error
            if error > 1e-4:
                assert found.model_error <= 3.0 * (error + truth.model_error)


def test_errors_of_order_3_and_of_cells_are_those_against_finer_cells():
    surface, load = rough(0.6, thickness=1.5), 0.1
    truth = mf.equilibrium(surface, mf.BoundaryElements(0.003, mf.BondedLayer()), load=load).area
    third = mf.equilibrium(surface, mf.Interacting(substrate=mf.BondedLayer()), load=load)
    assert abs(third.area / truth - 1.0) <= third.model_error <= 6.0 * abs(third.area / truth - 1.0)
    assert third.model_error.source == RADII
    for cell in (0.01, 0.02):
        coarse = mf.equilibrium(surface, mf.BoundaryElements(cell, mf.BondedLayer()), load=load)
        assert abs(coarse.area / truth - 1.0) <= coarse.model_error <= 0.4 * (cell / 0.15) ** 2 * 9.0


def test_the_cheapest_sufficient_estimate_is_taken(monkeypatch):
    """Without a coupled solution for a sparse scene; on the layer of a block for a dense one."""
    dense = mf.equilibrium(rough(0.6, thickness=1.5), load=0.1)
    assert dense.model_error.source == "order 3 on the bonded layer"
    assert 1.0 <= dense.model_error / np.abs(dense.model_error.change).max() < 1.1
    monkeypatch.setattr("metafem.models.error.compared", None)
    sparse = mf.equilibrium(rough(50.0), load=0.1)
    assert sparse.model_error.source == DISPLACEMENTS


UNKNOWN = [
    (rough(1.5), mf.Independent(mf.KogutEtsion(0.5)), "cannot be resolved"),
    (rough(0.3), mf.Interacting(), "contacts overlap"),
    (rough(0.8, thickness=0.05), mf.Independent(), "thinner"),
]


def test_unknown_errors_have_a_reason():
    for surface, model, reason in UNKNOWN:
        error = mf.equilibrium(surface, model, load=0.2).model_error
        assert math.isnan(error)
        assert reason in error.source


def test_no_contact_has_no_error():
    for model in (mf.Independent(), mf.Interacting(), mf.BoundaryElements(0.01), mf.Automatic()):
        assert mf.equilibrium(rough(1.5), model, load=0.0).model_error == 0.0


def test_errors_are_kept_in_copies_and_records():
    law = mf.friction_law(rough(0.8), mf.Independent(), load=[0.05, 0.1])
    for again in (pickle.loads(pickle.dumps(law)), from_record(json.loads(written(law)))):
        assert again == law
        assert again.model_error.source == law.model_error.source
