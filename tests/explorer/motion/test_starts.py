"""What is known of motions before they are followed."""

import numpy as np
from conftest import BODIES

import explorer as ex
from explorer.motion.starts import arc_starts, face_of, status_at_start
from explorer.phase.coordinates import constants_to_states
from explorer.phase.linear_constants import line_slope
from explorer.phase.states import phi_to_states, theta_to_states

OK, FALLS, UNRESOLVED, BAD = ex.Status.OK, ex.Status.FALLS, ex.Status.UNRESOLVED_SIDE, ex.Status.BAD_INPUT


def test_a_state_on_the_line_to_rounding_falls_or_does_not_know_its_side():
    disk = BODIES["uniform"]
    slope = line_slope(disk)
    states = phi_to_states(disk, 0.3 * np.ones(3), 1.0, 1.0, slope)  # not on F: the slope is that at the vertical
    assert (status_at_start(states) == OK).all()
    beside = slope * (1.0 + 1e-15 * np.array([0.0, 3.0, 1e9]))
    states = phi_to_states(disk, 0.0, 1.0, 1.0, beside)
    status = status_at_start(states)
    assert status[0] in (FALLS, UNRESOLVED)
    assert status[1:].tolist() == [UNRESOLVED, OK]
    assert status_at_start(states, sided=False)[1:].tolist() == [OK, OK]


def test_constants_that_were_given_are_held_and_zero_falls():
    disk = BODIES["hoop"]
    states = constants_to_states(disk, 1.0, [1e-280, 0.0], 1.0)
    assert status_at_start(states).tolist() == [OK, FALLS]
    assert states.motion.eta_plus.tolist() == [disk.eta_hat_to_eta(1e-280), 0.0]
    assert ex.falls(states).on_f.tolist() == [False, True]
    np.testing.assert_allclose(ex.constants(states).eta_hat_plus, [1e-280, 0.0], rtol=1e-15)
    assert states.at(np.array([0])).motion.eta_plus[0] == disk.eta_hat_to_eta(1e-280)


def test_a_motion_on_a_line_of_f_that_does_not_fall_is_a_motion_like_others():
    """At rest upright the disk could not fall, and stays for ever. In a well on the line it has a period."""
    disk = BODIES["uniform"]
    states = phi_to_states(disk, [0.0, 0.3, 0.3, np.nan], 0.0, [0.0, 0.0, 1e-3, 0.0], 0.0)
    assert status_at_start(states).tolist() == [OK, FALLS, OK, BAD]
    on_line = ex.coordinates_to_states(disk, phi=-0.7398, phidot=0.02, sigma3_bar=0.25, eta_hat=0.0)
    plain = phi_to_states(disk, on_line.phi, on_line.phidot, on_line.sigma3, on_line.sigma4)
    assert on_line.motion.eta_plus[0] == 0.0 != plain.motion.eta_plus[0]
    for call in (ex.periods, ex.wander):
        assert call(on_line).status == OK
    np.testing.assert_allclose(ex.periods(on_line).period, ex.periods(plain).period, rtol=1e-9)
    np.testing.assert_allclose(ex.bounces(on_line, 2).theta_min, ex.bounces(plain, 2).theta_min, rtol=1e-9)


def test_without_axial_inertia_motions_run_free():
    states = phi_to_states(ex.Disk(I1=0.3, I3=0.0), [0.2, np.nan], 0.1, 0.5, 0.4)
    assert status_at_start(states).tolist() == [OK, BAD]
    found = ex.simulate(states, t_eval=[1.0], accuracy=1e-6)
    assert found.status.tolist() == [OK, BAD]
    assert abs(found.constants_error[0, 0]) < 1e-6


def test_motions_are_seen_from_the_hemisphere_they_start_in(body):
    rates = np.array([0.3, 0.8, -0.2]) * body.rate_unit
    states = theta_to_states(body, 0.4, *rates, [1, -1])
    motion, b = states.motion, body.body
    starts, Y_far, *unsure = arc_starts(states.disk, states.rows, states.motion, face_of(states) > 0.0)
    assert np.max(unsure) < 1e-14
    np.testing.assert_allclose(starts.r, np.tan(0.2))
    np.testing.assert_allclose(starts.w, 1.0 - np.tan(0.2) ** 2)
    np.testing.assert_array_equal(starts.X, motion.sigma3_bar / b.r0)
    np.testing.assert_array_equal(starts.Y, np.array([motion.eta_plus[0], motion.eta_minus[1]]) / b.I1)
    np.testing.assert_array_equal(Y_far, np.array([motion.eta_minus[0], motion.eta_plus[1]]) / b.I1)
    np.testing.assert_allclose(starts.sigma4, [-0.2, 0.2])
