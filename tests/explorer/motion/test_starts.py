"""What is known of motions before they are followed."""

import numpy as np
from conftest import BODIES

import explorer as ex
from explorer.motion.starts import fallen, held_constants, orbit_starts, status_at_start
from explorer.phase.constants import natural_constants
from explorer.phase.lines import LinearConstants, line_slope
from explorer.phase.states import constants_to_states, phi_to_states, theta_to_states


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
    linear = LinearConstants(np.ones(5), *known)
    fall, ok, bad = ex.Status.FALLS, ex.Status.OK, ex.Status.BAD_INPUT
    status = np.array([ok, ok, ok, ok, bad], dtype=np.int8)
    assert fallen(linear, status).tolist() == [fall, fall, ok, ok, bad]


def test_without_axial_inertia_nothing_is_held():
    states = phi_to_states(ex.Disk(I1=0.3, I3=0.0), [0.2, np.nan], 0.1, 0.5, 0.4)
    natural = natural_constants(states)
    status, held = held_constants(states, natural)
    assert status.tolist() == status_at_start(states, natural).tolist() == [ex.Status.OK, ex.Status.BAD_INPUT]
    assert np.isnan(held).all()


def test_motions_are_seen_from_the_hemisphere_they_start_in(body):
    rates = np.array([0.3, 0.8, -0.2]) * body.rate_unit
    states = theta_to_states(body, 0.4, *rates, [1, -1])
    natural, b = natural_constants(states), body.body
    starts, Y_far = orbit_starts(states, natural.linear)
    np.testing.assert_allclose(starts.r, np.tan(0.2))
    np.testing.assert_allclose(starts.w, 1.0 - np.tan(0.2) ** 2)
    np.testing.assert_array_equal(starts.X, natural.sigma3_bar / b.r0)
    np.testing.assert_array_equal(starts.Y, np.array([natural.eta_plus[0], natural.eta_minus[1]]) / b.I1)
    np.testing.assert_array_equal(Y_far, np.array([natural.eta_minus[0], natural.eta_plus[1]]) / b.I1)
    np.testing.assert_allclose(starts.sigma4, [-0.2, 0.2])
