"""Membership of the falling set."""

import numpy as np
import pytest
from conftest import BODIES
from numpy.polynomial.polynomial import polyval

import explorer as ex
from explorer import compiled
from explorer.motion.fall_integrals import fall_from_vertical
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.coordinates import constants_to_states
from explorer.phase.falling_set import falls, impact_speed, obstacle, well
from explorer.phase.linear_constants import line_slope

WELLS = {"uniform": 0.34456, "hoop": 0.31638, "matching": 0.33436}
FALLS = {"uniform": (1.293920, 1.612452), "hoop": (1.325324, 1.527525)}


def test_the_well_that_never_falls_exists_below_the_published_sigma3_bar(paper_body):
    assert well(paper_body).sigma3_bar == pytest.approx(WELLS[paper_body.name], abs=5e-6)


@pytest.mark.parametrize("name", FALLS)
def test_the_plain_fall_from_the_vertical_takes_the_published_time(name):
    """Checklist 15: sigma3 = sigma4 = 0, an inverted pendulum."""
    disk = BODIES[name]
    energy = np.array([0.5 * disk.body.M + 1.0])
    time, chi, psi, _error = fall_from_vertical(disk, np.zeros(1), energy)
    assert time[0] == pytest.approx(FALLS[name][0], abs=5e-7)
    assert impact_speed(disk, np.zeros(1), energy)[0] == pytest.approx(FALLS[name][1], abs=5e-7)
    assert chi[0] == psi[0] == 0.0


def test_the_bound_of_the_barriers_series_holds_where_it_was_not_measured(body):
    o, disk = obstacle(body), body.natural
    depth = np.sqrt(np.linspace(1e-6, 1.0, 1000))
    out = np.empty((2, depth.size))
    compiled.falling.barrier_batch(o.X * (1.0 - depth**2) * body.body.r0, o.well_phi, disk, out)
    there = compiled.falling.Barrier(*out)
    assert abs(polyval(2.0 * depth - 1.0, o.sine) - np.sin(there.phi)).max() < o.slack < 1e-10
    assert abs(polyval(2.0 * depth - 1.0, o.V) / there.V - 1.0).max() < o.slack


def test_every_state_at_the_vertical_on_a_line_could_fall_on_that_face(body):
    rng = np.random.default_rng(1)
    unit = body.rate_unit
    for face in (1, -1):
        states = constants_to_states(
            body, rng.uniform(-3, 3, 200) * unit, 0.0, rng.uniform(-3, 3, 200) * unit, face
        )
        found = falls(states)
        assert (found.face == face).all()
        assert found.could_fall.all()
        assert found.on_f.all()
        assert (found.status == ex.Status.FALLS).all()


def test_membership_agrees_with_integration_just_beside_the_lines():
    """States on eta = 1e-7 nearly fall if and only if the algebra says that they could."""
    rng = np.random.default_rng(7)
    for name in ("uniform", "hoop", "thick"):
        disk = BODIES[name]
        b = disk.body
        n = 4000
        phi, phidot = rng.uniform(-1.4, 1.4, n), rng.uniform(-0.6, 0.6, n)
        sigma3_bar = rng.uniform(-0.5, 0.5, n)
        states = beside_line(disk, phi, phidot, sigma3_bar, 1e-7)
        natural = states.motion
        exact = falls(states)
        theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-4, "dopri5"))
        good = (status == 0) & (abs(natural.eta_plus) < 0.5 * abs(natural.eta_minus))
        flat = theta[good] < 1e-3 * np.sqrt(b.I3)
        could = exact.could_fall[good]
        assert good.sum() > 3000
        assert 0.1 < could.mean() < 0.95
        # The two can only differ within a hair of a separatrix.
        assert (flat != could).mean() < 2e-3, name


def beside_line(disk, phi, phidot, sigma3_bar, eta):
    """States at any tilt with eta_+ = eta, by the exact (sigma3, sigma4) of their constants."""
    from kernels.disk.chaplygin import sigma_from_constants, solutions

    b = disk.body
    sigma = np.empty((2, phi.size))
    for i in range(phi.size):
        face = 1.0 if phi[i] >= 0 else -1.0
        S = 2.0 * np.sin((np.pi / 2 - abs(phi[i])) / 2) ** 2
        f = solutions(S, np.log(S), b.c, disk.natural.series)
        near = eta if face > 0 else 2 * b.I1 * b.dr0 * sigma3_bar[i] - eta
        sigma[:, i] = sigma_from_constants(face, sigma3_bar[i] / b.r0, near / b.I1, f, b.k)
    unit = disk.rate_unit
    return ex.phi_to_states(disk, phi, phidot * unit, sigma[0] * unit, sigma[1] * unit)


def test_theta_min_approaches_its_leading_order(paper_body):
    """Checklist 40: theta_min = |eta| / sqrt(2 I1 (E - V0)) (1 + O(eta ln eta))."""
    errors = []
    for eta_hat in (1e-3, 1e-4, 1e-5):
        states = constants_to_states(paper_body, 1.0, [eta_hat, -eta_hat], 1.0)
        theta, _, _ = smallest_tilt(states, plan(("theta_min",), 1e-8, "dopri5"))
        errors.append(abs(theta / falls(states).theta_min_estimate - 1).max())
    assert errors[2] < 3e-4
    assert errors[2] < 0.2 * errors[1] < 0.04 * errors[0]


def test_the_nearer_side_and_the_sign_of_eta_are_reported():
    disk = BODIES["uniform"]
    slope = line_slope(disk)
    found = ex.falls(ex.phi_to_states(disk, 0.0, 1.0, [1.0, 1.0, 1.0], [slope - 0.1, slope + 0.1, -slope + 0.1]))
    assert found.face.tolist() == [1, 1, -1]
    assert np.sign(found.distance).tolist() == [1, -1, 1]
    norm = np.hypot(slope, 1.0)
    np.testing.assert_allclose(abs(found.distance), 0.1 / norm, rtol=1e-12)


def test_the_pendulum_lies_on_both_lines():
    found = ex.falls(ex.phi_to_states(BODIES["hoop"], 0.2, 0.1, 0.0, 0.0))
    assert found.distance_plus == found.distance_minus == 0.0
    assert found.status == ex.Status.FALLS


def test_too_little_energy_to_reach_flat_is_not_a_fall():
    """A disk that spins upright fast enough has E < V0 on neither line near it, and stays up."""
    disk = BODIES["uniform"]
    found = ex.falls(ex.phi_to_states(disk, 0.0, 0.0, 3.0, 0.0))
    assert not found.could_fall
    assert np.isnan(found.theta_min_estimate)


def test_nothing_falls_off_the_lines(body):
    """Checklist 29: theta_min > 0 for every sample with eta_+ eta_- != 0."""
    rng = np.random.default_rng(11)
    unit = body.rate_unit
    states = ex.phi_to_states(body, rng.uniform(-1.3, 1.3, 3000), *(rng.uniform(-2, 2, (3, 3000)) * unit))
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-4, "dopri5"))
    assert (status == 0).mean() > 0.998
    assert (theta[status == 0] > 0).all()


def test_a_start_from_rest_falls_where_the_potential_falls_and_an_equilibrium_stays():
    disk = BODIES["uniform"]
    both = ex.falls(ex.phi_to_states(disk, [0.1, -0.1], 0.0, 0.0, 0.0))
    assert (both.face.tolist(), both.status.tolist()) == ([1, -1], [ex.Status.FALLS] * 2)
    assert ex.falls(ex.phi_to_states(disk, 0.0, 0.0, 0.0, 0.0)).status == ex.Status.OK
    assert ex.simulate(ex.phi_to_states(disk, 0.1, 0.0, 0.0, 0.0), 3.0).status == ex.Status.FALLS
    still = ex.simulate(ex.phi_to_states(disk, 0.0, 0.0, 0.0, 0.0), 3.0, observables=("phi",))
    assert still.status == ex.Status.OK
    assert (still.phi == 0.0).all()


def test_next_to_no_axial_inertia_takes_no_digits_of_the_smallest_tilt():
    """V_0 is 10^22 times the energy there: potentials that are measured from flat have no digit left.

    An integration still knows the tilt; of a tenth of this inertia rounding decides whether it does.
    """
    disk = ex.Disk(I1=0.25, I3=1e-11)
    states = ex.phi_to_states(disk, 0.1, 0.5, [1.0, -0.7], [0.3, 0.9])
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-6))
    assert (status == ex.Status.OK).all()
    integrated, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-6, "dopri5"))
    assert (status == ex.Status.OK).all()
    np.testing.assert_allclose(theta, integrated, rtol=1e-5)
