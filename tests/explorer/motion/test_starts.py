"""What is known of motions before they are followed."""

import numpy as np
from conftest import BODIES

import explorer as ex
from explorer.motion.starts import fallen, held_constants, orbit_starts, status_at_start, told_upright
from explorer.phase.constants import natural_constants
from explorer.phase.lines import line_slope
from explorer.phase.states import constants_to_states, phi_to_states, theta_to_states
from kernels.integrals.point import Orbits


def test_a_state_on_the_line_to_rounding_falls_or_does_not_know_its_side():
    disk = BODIES["uniform"]
    slope = line_slope(disk)
    states = phi_to_states(disk, 0.3 * np.ones(3), 1.0, 1.0, slope)  # not on F: the slope is that at the vertical
    assert (status_at_start(states, natural_constants(states)) == ex.Status.OK).all()
    beside = slope * (1.0 + 1e-15 * np.array([0.0, 3.0, 1e9]))
    states = phi_to_states(disk, 0.0, 1.0, 1.0, beside)
    status, held = held_constants(states, natural_constants(states))
    assert status[0] in (ex.Status.FALLS, ex.Status.UNRESOLVED_SIDE)
    assert status[1:].tolist() == [ex.Status.UNRESOLVED_SIDE, ex.Status.OK]
    np.testing.assert_array_equal(held, natural_constants(states).linear)


def test_constants_that_were_given_are_held_and_zero_falls():
    disk = BODIES["hoop"]
    states = constants_to_states(disk, 1.0, [1e-280, 0.0], 1.0)
    status, held = held_constants(states, natural_constants(states))
    assert status.tolist() == [ex.Status.OK, ex.Status.FALLS]
    assert held.eta_plus.tolist() == [disk.eta_hat_to_eta(1e-280), 0.0]


def test_an_eta_of_zero_on_either_side_is_a_fall_and_no_other_is():
    known = np.array([[0.0, 1.0, 1.0, 1.0, 0.0], [1.0, 0.0, 1.0, 5e-324, 0.0]])
    starts = Orbits(*np.ones((3, 5)), *known, np.ones(5))
    fall, ok, bad = ex.Status.FALLS, ex.Status.OK, ex.Status.BAD_INPUT
    status = np.array([ok, ok, ok, ok, bad], dtype=np.int8)
    assert fallen(starts, status).tolist() == [fall, fall, ok, ok, bad]


def test_without_axial_inertia_nothing_is_held():
    states = phi_to_states(ex.Disk(I1=0.3, I3=0.0), [0.2, np.nan], 0.1, 0.5, 0.4)
    natural = natural_constants(states)
    status, held = held_constants(states, natural)
    assert status.tolist() == status_at_start(states, natural).tolist() == [ex.Status.OK, ex.Status.BAD_INPUT]
    assert np.isnan(held).all()


def test_orbits_are_seen_from_the_hemisphere_they_start_in(body):
    rates = np.array([0.3, 0.8, -0.2]) * body.rate_unit
    states = theta_to_states(body, 0.4, *rates, [1, -1])
    natural = natural_constants(states)
    h, _speed, sigma3_bar, near, far, z = orbit_starts(states, natural.linear)
    np.testing.assert_allclose(h, 2.0 * np.sin(0.2))
    np.testing.assert_allclose(z, np.cos(0.4))
    np.testing.assert_array_equal(sigma3_bar, natural.sigma3_bar)
    np.testing.assert_array_equal(near, [natural.eta_plus[0], natural.eta_minus[1]])
    np.testing.assert_array_equal(far, [natural.eta_minus[0], natural.eta_plus[1]])


def test_potentials_are_told_from_the_vertical_where_little_i3_makes_sigma4_large_at_flat():
    rng, one_face = np.random.default_rng(4), np.zeros(200, np.bool_)
    rates = np.array([rng.normal(0.0, size, 200) for size in (1.0, 3.0, 3.0)])
    share = {}
    for I3 in (0.5, 0.05, 1e-3, 1e-8):
        states = phi_to_states(ex.Disk(I1=0.25, I3=I3), rng.uniform(-1.4, 1.4, 200), *rates)
        starts = orbit_starts(states, natural_constants(states).linear)
        upright, rounding = told_upright(states.disk, starts, one_face)
        share[I3] = upright.mean()
        # On one face the terms are no more than on both.
        alone, less = told_upright(states.disk, starts, ~one_face)
        assert (less <= rounding).all()
        assert not (alone & ~upright).any()
    assert share[0.5] == share[0.05] == 0.0
    assert share[1e-3] > 0.9
    assert share[1e-8] == 1.0
