"""Interacting asperities of any elastic law without adhesion: a readable dense twin of the kernels.

With the loads p = P/E* the complementary energy is

    W(p) = sum_i [U*(p_i, k_i) - T(p_i) |g_i|^2/2] + p.G p/2 - e.p

where k_i = sum_j p_j lap_i G_ij/2 and g_i = sum_j p_j grad_i G_ij are curvature and slope of the field of the
others. The derivatives of U* are the indentation d and half of the second moment M, and T = 4/3 a0^3, with
the contact radius a0 under p alone. Order 1 has k = g = 0. The unknowns are z with p the load of an
undisturbed contact at the indentation z; z < 0 is the gap of an open asperity. On the slope the area of a
contact of radius a is pi a^2 F, see `on_slope`.
"""

import numpy as np

import metafem as mf
from metafem.models.load_equation import LoadEquation
from validation.methods.bent import Bent

MAX_STEPS, MAX_CUTS, GOAL = 100, 30, 3e-14


class Twin:
    """A surface with an elastic law on a substrate."""

    def __init__(self, surface, law, order=3, substrate=None):
        bound = (mf.HalfSpace() if substrate is None else substrate).for_surface(surface)
        self.law, self.gap = law, surface.gap
        self.radius = np.array(np.broadcast_to(surface.radius, self.gap.shape))
        self.point = bound.influence_matrix(surface)
        self.fields = [field * (order == 3) for field in bound.influence_derivatives(surface)]

    def disturbed_radius(self, load, own, curvature):
        """Contact radius a at which the load with an extra curvature is that without it at a0."""
        a = own
        for _ in range(100):
            step = (Bent(self.law, curvature).load(a, self.radius) - load) / self.load_slope(a, curvature)
            a = a - np.where(own > 0.0, step, 0.0)
            if (np.abs(step) <= 1e-15 * own).all():
                break
        return a

    def load_slope(self, a, curvature):
        """dP/da = 2 a dd/da, with dd/da = 2 pi a/(dA/dd); 1 for open contacts."""
        slope = Bent(self.law, curvature).area_slope(np.where(a > 0.0, a, 0.1), self.radius)
        return np.where(a > 0.0, 4.0 * np.pi * a**2 / slope, 1.0)

    def on_slope(self, a, curvature, slope):
        """Areas of contacts on slopes; the derivative of D' = dd/da is that of a polynomial through 7 points.

        To second order F = 1 - 2 y with y = (a D''/D' - 1) (g/D')^2; beyond that F is an interpolation for
        y > 0 that agrees with resolved contacts on slopes up to g = D' within 15 %.
        """
        closed = a > 0.0
        steps, own = 0.02 * np.arange(-3, 4), np.where(closed, a, 0.1)
        slopes = [Bent(self.law, curvature).profile_slope(own * np.exp(step), self.radius) for step in steps]
        bend = np.polynomial.polynomial.polyfit(steps, np.log(slopes), 6)[1]
        y = (bend - 1.0) * (slope / slopes[3]) ** 2
        factor = np.where(y > 0.0, 1.0 / np.sqrt(1.0 + 4.0 * np.maximum(y, 0.0)), 1.0 - 2.0 * y)
        return np.where(closed, self.law.area(a) * factor, 0.0)

    def areas(self, z, a):
        """Areas at the nominal indentations z, for contacts of radii a."""
        load = self.law.load(self.law.contact_radius(z, self.radius), self.radius)
        gx, gy, laplacian = (field @ load for field in self.fields)
        return self.on_slope(a, 0.5 * laplacian, np.hypot(gx, gy))

    def equations(self, z, approach):
        """Return the residuals, loads, contact radii, and the derivatives of the residuals by z."""
        law, radius, closed = self.law, self.radius, z > 0.0
        own = law.contact_radius(z, radius)
        load = law.load(own, radius)
        gx, gy, laplacian = self.fields
        slope_x, slope_y, curvature = gx @ load, gy @ load, 0.5 * laplacian @ load
        a = self.disturbed_radius(load, own, curvature)
        bent = Bent(law, curvature)
        moment = bent.second_moment(a, radius)
        tilted = 4.0 / 3.0 * own**3
        rate = law.area_slope(own, radius) / np.pi  # dT/dp
        shift = -gx.T @ (tilted * slope_x) - gy.T @ (tilted * slope_y)
        raised = -0.5 * rate * (slope_x**2 + slope_y**2)
        u = self.point @ load + 0.25 * laplacian.T @ moment + shift + raised
        error = np.where(closed, bent.indentation(a, radius), z) + u - (approach - self.gap)
        # d2W/dp2 without the second derivative of T; dM/dp = 2 a^2/3, and dM/dk = -16 a^5/45 at a given load
        bend = (a**2 / 3.0)[:, None] * 0.5 * laplacian
        coupling = self.point + bend + bend.T - laplacian.T @ ((2.0 / 45.0 * a**5)[:, None] * laplacian)
        for field, slope in ((gx, slope_x), (gy, slope_y)):
            turned = (rate * slope)[:, None] * field
            coupling -= turned + turned.T + field.T @ (tilted[:, None] * field)
        matrix = coupling * (2.0 * own)
        matrix[np.diag_indices_from(matrix)] += np.where(closed, own / np.where(closed, a, 1.0), 1.0)
        return error, load, a, matrix

    def residual(self, z, error, load, target):
        """Residual over the largest indentation, and of the load."""
        worst = np.abs(error).max() / z.max()
        return worst if target is None else max(worst, abs(load.sum() / target - 1.0))

    def solve(self, load=None, approach=None):
        """Return approach, loads, areas and residual at a rescaled load or an approach.

        Newton's method, from independent asperities at the load; at an approach, from half of it.
        """
        if load is None:
            x, z = approach, 0.5 * approach - self.gap
        else:
            x = LoadEquation(None, self.law).curve(-self.gap, np.array([load]), self.radius).approach[0]
            z = x - self.gap
        for _ in range(MAX_STEPS):
            error, p, a, matrix = self.equations(z, x)
            now = self.residual(z, error, p, load)
            if now <= GOAL:
                break
            own = self.law.contact_radius(z, self.radius)
            if load is None:
                step, rise = np.linalg.solve(matrix, -error), 0.0
            else:
                whole = np.block([[matrix, -np.ones((len(z), 1))], [2.0 * own, np.zeros(1)]])
                *step, rise = np.linalg.solve(whole, np.append(-error, load - p.sum()))
            length = 1.0
            for _ in range(MAX_CUTS):
                new_z, new_x = z + length * np.array(step), x + length * rise
                trial = self.equations(new_z, new_x)[:2]
                if new_z.max() > 0.0 and self.residual(new_z, *trial, load) < now:
                    break
                length *= 0.5
            else:
                break
            z, x = new_z, new_x
        return x, p, self.areas(z, a), now
