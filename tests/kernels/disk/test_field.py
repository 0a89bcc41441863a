"""The regularised field against the paper's equations."""

import numpy as np
import pytest

from explorer.paper import eight_dimensions as plain_disk
from kernels.disk.body import make_disk
from kernels.disk.field import State, energy, field, pace, shift, speed


def plain_rates(disk, phi, phidot, sigma3, sigma4):
    """Eqs (2.15)-(2.18), (2.22), (2.31), as printed, in time t."""
    I1, I3, m, r, g = disk.I1, disk.I3, disk.m, disk.r, disk.g
    s1, q2 = np.sin(phi), np.cos(phi) ** 2
    s2 = np.cos(phi) * phidot
    s2dot = -s1 * s2**2 / q2 + (
        -I1 * s1 * sigma3**2 / q2 + (I3 + m * r * r) * sigma3 * sigma4 + m * g * r * s1 * np.sqrt(q2)
    ) / (I1 + m * r * r)
    s3dot = -I3 * s2 * sigma4 / I1
    s4dot = -m * r * r * s2 * sigma3 / (q2 * (I3 + m * r * r))
    return s2dot, s3dot, s4dot, sigma3 / q2, sigma3 * s1 / q2 - sigma4


def random_states(count, seed=5):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-1.4, 1.4, count), rng.uniform(-2, 2, (count, 3))])


def natural(state):
    phi, phidot, sigma3, sigma4 = state
    q, z = np.cos(phi), np.sin(phi)
    return State(q, z, -phidot, sigma3 / q, sigma4, 0.0, 0.7, 0.0, 0.0, 0.0)


def test_the_regularised_field_is_the_papers_field_times_q(body):
    disk = type(body)(I1=body.body.I1, I3=body.body.I3)
    for state in random_states(50):
        x = natural(state)
        d = field(x, disk.body)
        s2dot, s3dot, s4dot, chidot, psidot = plain_rates(disk, *state)
        # sigma2 = -q p, sigma3 = q rho
        got = (-(d.q * x.p + x.q * d.p), d.q * x.rho + x.q * d.rho, d.sigma4, d.chi, d.psi, d.z)
        want = np.array([s2dot, s3dot, s4dot, chidot, psidot, np.cos(state[0]) * state[1]]) * x.q
        np.testing.assert_allclose(got, want, rtol=1e-12, atol=1e-12 * (1 + abs(np.array(want)).max()))
        assert d.t == x.q


def test_the_reduced_equations_follow_from_the_full_ones(body):
    """Checklist 3: eq. (2.12) as corrected gives (2.16)-(2.18)."""
    for state in random_states(20, seed=9):
        A, omega = plain_disk.start(*state)
        u = A[2]
        acceleration, udot = plain_disk.angular_acceleration(body, u, omega), np.cross(u, omega)
        s2dot, s3dot, s4dot, *_ = plain_rates(body, *state)
        got = (
            udot[0] * omega[1] + u[0] * acceleration[1] - udot[1] * omega[0] - u[1] * acceleration[0],
            udot[0] * omega[0] + u[0] * acceleration[0] + udot[1] * omega[1] + u[1] * acceleration[1],
            acceleration[2],
        )
        scale = 1 + max(abs(x) for x in (s2dot, s3dot, s4dot))
        np.testing.assert_allclose(got, (s2dot, s3dot, s4dot), rtol=1e-11, atol=1e-11 * scale)


def test_energy_does_not_change_along_the_field(body):
    b = body.body
    for state in random_states(50, seed=2):
        x = natural(state)
        d = field(x, b)
        rate = b.M * (x.p * d.p + x.rho * d.rho * b.inv_kappa2) + b.J * x.sigma4 * d.sigma4 + d.q
        assert abs(rate) <= 1e-12 * energy(x, b) * (1 + speed(x, b) * b.kappa)


def test_the_flat_state_is_the_heteroclinic_connection_of_the_race():
    """At q = 0: p' = z rho^2/kappa^2, rho' = -z rho p, so p^2 + rho^2/kappa^2 is constant."""
    from conftest import BODIES

    b = BODIES["uniform"].body
    d = field(State(0.0, 1.0, 0.6, 1.1, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0), b)
    assert (d.q, d.z, d.sigma4, d.t) == (0.0, 0.0, 0.0, 0.0)
    assert 0.6 * d.p + 1.1 * d.rho * b.inv_kappa2 == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("I3", [1e-3, 0.02, 0.1])
def test_nothing_of_a_tilting_disk_changes_faster_than_its_pace(I3):
    """p and rho/kappa stay below twice it where most of the energy is in sigma4, and change in some 1/pace."""
    b = make_disk(0.25, I3).body
    rng = np.random.default_rng(1)
    for spin in rng.choice([-1.0, 1.0], 10) * 10.0 ** rng.uniform(0.0, 2.0, 10):
        x = natural((0.3, 0.5, 0.4, spin))
        unit = pace(x, b)
        for _ in range(400):
            k = field(x, b)
            middle = field(shift(x, 0.01 / unit, k), b)
            x = shift(x, 0.02 / unit, middle)
            assert np.hypot(x.p, x.rho / b.kappa) < 2.0 * unit
            assert np.hypot(k.p, k.rho / b.kappa) < 4.0 * unit * unit
