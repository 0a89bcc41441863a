"""The potential on F, and who belongs to F."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.disk import falling
from kernels.disk.falling import Barrier, LineChart, Membership, OnF

SHAPES = ["uniform", "hoop", "matching", "thick"]


def on_f(disk, theta, X=0.7):
    out = np.empty((4, theta.size))
    falling.on_f_batch(theta, X, disk.natural, out)
    return OnF(*out)


@pytest.mark.parametrize("name", SHAPES)
def test_the_potential_on_f_goes_to_its_value_at_flat_and_falls_towards_it(name):
    """Eq. (6.9): V_0 = J X^2 / (2 k^2). From the vertical to flat V only decreases."""
    disk = BODIES[name]
    theta = np.concatenate([np.geomspace(1e-200, 1e-6, 10), np.linspace(0.01, 0.5 * math.pi, 40)])
    V = on_f(disk, theta).V
    at_flat = 0.5 * disk.body.J * (0.7 / disk.body.k) ** 2
    assert V[0] == pytest.approx(at_flat, rel=1e-15)
    assert (np.diff(V[10:]) > 0.0).all()


@pytest.mark.parametrize("name", SHAPES)
def test_the_slope_on_f_is_the_derivative_of_the_potential_on_both_hemispheres(name):
    disk, h = BODIES[name], 1e-5
    theta = np.linspace(0.1, 3.0, 30)
    by_phi = -(on_f(disk, theta + h).V - on_f(disk, theta - h).V) / (2.0 * h)  # phi = pi/2 - theta
    here = on_f(disk, theta)
    np.testing.assert_allclose(here.dV, by_phi, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("name", SHAPES)
def test_the_chart_keeps_areas_at_every_tilt(name):
    """dsigma3 dsigma4 = dsigma3_bar deta_hat: its determinant is -1."""
    theta = np.concatenate([np.geomspace(1e-100, 0.1, 10), np.linspace(0.2, 3.0, 20)])
    out = np.empty((4, theta.size))
    falling.line_chart_batch(np.sin(theta), np.cos(theta), BODIES[name].natural, out)
    chart = LineChart(*out)
    determinant = chart.bar_to_sigma3 * chart.eta_hat_to_sigma4 - chart.eta_hat_to_sigma3 * chart.bar_to_sigma4
    np.testing.assert_allclose(determinant, -1.0, rtol=1e-12)


def test_a_barrier_is_a_critical_point_and_there_is_none_without_a_well():
    disk = BODIES["uniform"]
    phi = np.linspace(-1.5, -0.01, 400)
    critical = np.empty(phi.size)
    falling.critical_X2_batch(phi, disk.natural, critical)
    well_phi, largest = phi[critical.argmax()], math.sqrt(critical.max()) * disk.body.r0
    out = np.empty((2, 3))
    falling.barrier_batch(np.array([0.5, 0.9, 1.1]) * largest, well_phi, disk.natural, out)
    barrier = Barrier(*out)
    assert np.isnan(barrier.phi).tolist() == [False, False, True]
    for share, angle, V in zip((0.5, 0.9), barrier.phi, barrier.V, strict=False):
        there = on_f(disk, np.array([0.5 * math.pi - angle]), share * largest / disk.body.r0)
        assert there.V[0] == pytest.approx(V, rel=1e-14)
        assert there.dV[0] == pytest.approx(0.0, abs=1e-12)


def test_a_motion_falls_if_its_energy_lies_above_the_potential_all_the_way_to_flat():
    disk = BODIES["uniform"]
    V = float(on_f(disk, np.array([0.4])).V[0])
    states = np.repeat([[math.sin(0.4)], [math.cos(0.4)], [0.0], [0.0], [0.0]], 3, axis=1)
    bar, energy = np.full(3, 0.7 * disk.body.r0), np.array([V * (1.0 + 1e-9), V, V * (1.0 - 1e-9)])
    out = np.empty((3, 3))
    falling.falls_batch(states, bar, energy, -0.7, disk.natural, out)
    # At rest, with E = V, it falls as well: V falls towards flat.
    assert Membership(*out).plus.tolist() == [1.0, 1.0, 0.0]
