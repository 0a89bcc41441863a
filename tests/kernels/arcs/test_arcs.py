"""Motions put together from arcs are those that many digits, and integration, find."""

import numpy as np
import pytest
from motions import trajectories
from mpmath import mp, mpf

import explorer as ex
from kernels.disk import elementary


def test_after_a_period_motions_are_what_they_were(body):
    """By integration, which knows nothing of arcs."""
    random = np.random.default_rng(5)
    phi, phidot, sigma3, sigma4 = random.uniform(-1.2, 1.2, (4, 20))
    unit = body.rate_unit
    states = ex.phi_to_states(body, phi, phidot * unit, sigma3 * unit, sigma4 * unit)
    found = ex.periods(states, accuracy=1e-9)
    for i in np.flatnonzero(found.status == ex.Status.OK):
        after = trajectories(
            states.at(np.array([i])),
            t_eval=[found.period[i]],
            observables=("phi", "phidot", "chi", "psi"),
            method="dop853",
            accuracy=1e-9,
        )
        assert after.phi[0] == pytest.approx(phi[i], abs=1e-7)
        assert after.chi[0] == pytest.approx(found.chi[i], abs=1e-7)
        assert after.psi[0] == pytest.approx(found.psi[i], abs=1e-7)


@pytest.mark.parametrize("x", [-600.0, -40.0, -0.3, -1e-9, 1e-300, 1e-17, 0.2, 3.0, 600.0])
def test_the_exponential_is_right_to_rounding_with_and_without_one(x):
    power, grown = elementary.exponential(x)
    assert power == pytest.approx(float(mp.exp(mpf(x))), rel=5e-16, abs=0.0)
    assert grown == pytest.approx(float(mp.expm1(mpf(x))), rel=5e-16, abs=0.0)


@pytest.mark.parametrize("x", [1e-300, 0.1, 0.7, 0.999, 1.0, 1.4143, 3e200])
def test_the_logarithm_is_right_to_rounding(x):
    assert elementary.logarithm(x) == pytest.approx(float(mp.log(mpf(x))), rel=5e-16, abs=1e-17)
