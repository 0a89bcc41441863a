"""The inverted pendulum keeling over."""

import numpy as np
import pytest
from conftest import BODIES
from scipy.special import ellipkinc

import explorer as ex
from explorer.motion.pendulum import Pendulum
from explorer.motion.trajectories import trajectories
from explorer.phase.states import constants_to_states


def test_the_pendulum_falls_to_both_sides_in_turn():
    disk = BODIES["uniform"]
    for sign in (1, -1):
        for face in (1, -1):
            limit = ex.limit_motion(ex.phi_to_states(disk, 0.0, float(face), 0.0, 0.0), sign)
            hits = limit.impacts(10.0)
            assert hits[0] == pytest.approx(1.293920, abs=5e-7)
            times = np.linspace(0.05, 9.0, 80)
            times = times[abs(times[:, None] - hits).min(axis=1) > 0.1]
            states = constants_to_states(disk, 0.0, face * sign * 1e-10, float(face), face)
            names = ("phi", "phidot", "chi", "psi", "path", "contact")
            got, want = trajectories(states, t_eval=times, observables=names, accuracy=1e-10), limit(times)
            for name in names:
                np.testing.assert_allclose(getattr(got, name)[0], getattr(want, name), atol=1e-7)


@pytest.mark.parametrize("energy", [1.0 + 1e-9, 1.05, 2.0, 40.0])
def test_a_swing_takes_the_time_of_its_integral_and_goes_where_it_says(body, energy):
    swing = Pendulum(body, energy)
    # Legendre's integral of the first kind: E - cos x = (E - 1) + 2 sin^2(x/2).
    above = energy - 1.0
    half = np.sqrt(2.0 * body.body.M / above) * ellipkinc(0.25 * np.pi, -2.0 / above)
    assert swing.half == pytest.approx(half, rel=1e-8)
    theta = np.array([0.01, 0.5, 1.5, 1.6, 3.0])
    times = np.array([swing.time_at(t) for t in theta])
    assert (np.diff(times) > 0.0).all()
    np.testing.assert_allclose(swing.theta(times), theta, atol=1e-8)
    assert swing.impact_speed == swing.speed(0.0)


def test_a_swing_that_stops_upright_is_refused():
    with pytest.raises(ex.InputError, match="stops upright for ever"):
        Pendulum(BODIES["uniform"], 1.0 + 1e-15)
