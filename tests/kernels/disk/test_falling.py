"""The potential on F, and who belongs to F."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.falling_set import obstacle
from explorer.phase.linear_constants import Motion
from kernels.disk import falling, membership
from kernels.disk.falling import Barrier, OnF

SHAPES = ["uniform", "hoop", "matching", "thick"]


def on_f(disk, theta, X=0.7):
    return OnF(*np.transpose([falling.on_f(math.sin(t), math.cos(t), X, disk.natural) for t in theta]))


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


def could_fall(disk, states, motion, barriers):
    """Whether states could fall on face +1 and on face -1, their constants given."""
    codes = np.empty(states.shape[1], np.int8)
    call = barriers, disk.natural, np.stack(motion), codes
    membership.membership_batch(states, True, *call)
    return np.array([(codes & bit) != 0 for bit in (membership.COULD_PLUS, membership.COULD_MINUS)])


def test_a_motion_falls_if_its_energy_lies_above_the_potential_all_the_way_to_flat():
    disk, none = BODIES["uniform"], np.zeros(3)
    V = float(on_f(disk, np.array([0.4])).V[0])
    states = np.repeat([[math.sin(0.4)], [math.cos(0.4)], [0.0], [0.0], [0.0]], 3, axis=1)
    bar, energy = np.full(3, 0.7 * disk.body.r0), np.array([V * (1.0 + 1e-9), V, V * (1.0 - 1e-9)])
    found = could_fall(disk, states, Motion(bar, none, none, energy, none, none), obstacle(disk))
    # At rest, with E = V, it falls as well: V falls towards flat.
    assert found[0].tolist() == [True, True, False]


@pytest.mark.parametrize("name", SHAPES)
def test_random_states_could_fall_where_their_energy_exceeds_the_potential_at_every_tilt_on_the_way(name):
    disk, random = BODIES[name], np.random.default_rng(4)
    rates = random.uniform(-2.0, 2.0, (3, 300)) * disk.rate_unit
    states = ex.phi_to_states(disk, random.uniform(-1.5, 1.5, 300), *rates)
    motion = states.motion
    found, compared = could_fall(disk, states.natural, motion, obstacle(disk)), 0
    for seen, face in zip(found, (1.0, -1.0), strict=True):
        for row, falls in enumerate(seen):
            start = 0.5 * math.pi - face * states.phi[row]
            V = on_f(disk, np.linspace(1e-6, start, 400), motion.sigma3_bar[row] / disk.body.r0).V
            if abs(motion.energy[row] / V.max() - 1.0) > 1e-3:
                compared += 1
                assert falls == (motion.energy[row] > V.max())
    assert compared > 500


def drawn_beyond_the_vertical(disk, count):
    random = np.random.default_rng(1)
    rates = random.uniform(-2.0, 2.0, (3, count)) * disk.rate_unit
    states = ex.phi_to_states(disk, random.uniform(-1.5, 1.5, count), *rates)
    return states, states.motion


def beside_the_barrier(disk, count):
    """Tilts and energies at their barrier but for 1e-17 to 1e-3, up to where well and barrier merge."""
    random, o = np.random.default_rng(2), obstacle(disk)
    X = o.X * (1.0 - 10.0 ** random.uniform(-15.0, 0.0, count))
    out = np.empty((2, count))
    falling.barrier_batch(X * disk.body.r0, o.well_phi, disk.natural, out)
    there = Barrier(*out)
    near = random.choice([-1.0, 1.0], (2, count)) * 10.0 ** random.uniform(-17.0, -3.0, (2, count))
    states = ex.phi_to_states(disk, np.minimum(np.nan_to_num(there.phi) + near[0], 0.0), 0.0, 0.0, 0.0)
    none = np.zeros(count)
    return states, Motion(X * disk.body.r0, none, none, there.V * (1.0 + near[1]), none, none)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("starts", [drawn_beyond_the_vertical, beside_the_barrier])
def test_the_barriers_series_judges_as_bisection_for_the_barrier_does(name, starts):
    disk = BODIES[name]
    states, constants = starts(disk, 4000)
    always = obstacle(disk)._replace(slack=math.inf)
    by_series, bisected = (could_fall(disk, states.natural, constants, o) for o in (obstacle(disk), always))
    np.testing.assert_array_equal(by_series, bisected)
    # Both verdicts occur, else nothing would be compared.
    assert 0.01 < by_series[0].mean() < 0.99
