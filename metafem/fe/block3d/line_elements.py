"""One-dimensional elements along the edges of the block, for tensor products."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, MeshLine

from metafem._validate import FloatArray

# Degree to which the Gauss points are exact: the matrices need 4; the tractions are not polynomials.
QUADRATURE = 9


MASS = BilinearForm(lambda u, v, _: u * v)
DERIVATIVE = BilinearForm(lambda u, v, _: u * v.grad[0])  # of the test function, a row of the matrix
STIFFNESS = BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0])


@dataclass(frozen=True, eq=False)
class LineElements:
    """Quadratic (displacement) and linear (pressure) elements on one line of vertices."""

    node: FloatArray  # ascending positions of the quadratic degrees of freedom [mm]
    vertex: FloatArray  # ascending positions of the linear ones [mm]
    # matrix of ``int D^i v D^j u`` for quadratic v (rows) and u, by (i, j)
    product: dict[tuple[int, int], Any]
    # matrix of ``int q D^j u`` for linear q (rows) and quadratic u, by j; "mass": of ``int q p``
    pressure: dict[Any, Any]
    quadrature: tuple[FloatArray, FloatArray]  # Gauss points [mm] and weights [mm]
    _basis: Any
    _order: Any

    @classmethod
    def on(cls, line: FloatArray) -> LineElements:
        """Return the elements on ascending vertices."""
        mesh = MeshLine(line)
        basis = Basis(mesh, ElementLineP2(), intorder=QUADRATURE)
        linear = basis.with_element(ElementLineP1())
        order, vertices = (np.argsort(each.doflocs[0]) for each in (basis, linear))
        first = DERIVATIVE.assemble(basis)
        product = {
            (0, 0): MASS.assemble(basis),
            (1, 0): first,
            (0, 1): first.T,
            (1, 1): STIFFNESS.assemble(basis),
        }
        mixed = {
            0: MASS.assemble(basis, linear),
            # here u is differentiated: the transpose is assembled
            1: DERIVATIVE.assemble(linear, basis).T,
        }
        pressure: dict[Any, Any] = {j: matrix.tocsr()[vertices][:, order] for j, matrix in mixed.items()}
        pressure["mass"] = MASS.assemble(linear).tocsr()[vertices][:, vertices]
        return cls(
            node=basis.doflocs[0, order],
            vertex=linear.doflocs[0, vertices],
            product={key: matrix.tocsr()[order][:, order] for key, matrix in product.items()},
            pressure=pressure,
            quadrature=(np.asarray(basis.global_coordinates())[0].ravel(), basis.dx.ravel()),
            _basis=basis,
            _order=order,
        )

    def at(self, position: FloatArray) -> sp.csr_matrix:
        """Return the quadratic shape functions at positions, (positions, nodes)."""
        return self._basis.probes(position[None, :]).tocsr()[:, self._order]
