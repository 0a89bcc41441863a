"""Constants of motion near flat, against forty digits."""

import math

import mpmath
import numpy as np
import pytest
from conftest import BODIES
from slow_chaplygin import hypergeometric

from explorer.phase import linear_constants
from explorer.phase.states import theta_to_states
from kernels._jit import device
from kernels.disk import constants
from kernels.disk.chaplygin import sigma_from_constants, solutions

mpmath.mp.dps = 40


@pytest.mark.parametrize("face", [1, -1])
@pytest.mark.parametrize("theta", [1e-300, 1e-100, 1e-30, 1e-8, 1e-3, 0.2, 1.0, 1.5])
def test_states_made_from_constants_give_them_back_near_both_flat_states(body, face, theta):
    """Full relative accuracy of sigma3_bar, and of eta against its own rounding bound, at any tilt."""
    b = body.body
    X, eta = 0.8 / b.r0, 3e-3
    S, log_S = 2.0 * math.sin(theta / 2) ** 2, 2.0 * math.log(math.sqrt(2) * math.sin(theta / 2))
    f = solutions(S, log_S, b.c, body.natural.series)
    sigma3, sigma4 = sigma_from_constants(face, X, eta / b.I1, f, b.k)
    unit = body.rate_unit
    states = theta_to_states(body, theta, 0.0, sigma3 * unit, sigma4 * unit, face)
    natural = states.motion
    there = np.array([face > 0])
    assert natural.sigma3_bar[0] == pytest.approx(0.8, rel=1e-13)
    rounding = natural.rounding(there)[0]
    assert abs(natural.eta(there)[0] - eta) <= rounding
    assert rounding < 4e-15 * (abs(sigma3) + abs(sigma4) * b.I3)


@pytest.mark.parametrize("face", [1, -1])
def test_constants_of_a_state_agree_with_forty_digits(face):
    """sigma3_bar and eta by the hypergeometric solutions, from the doubles of the state."""
    disk = BODIES["hoop"]
    b = disk.body
    rng = np.random.default_rng(3)
    for theta in np.concatenate([np.geomspace(1e-12, 0.1, 6), rng.uniform(0.1, 1.5, 6)]):
        s3, s4 = rng.uniform(-1, 1) * min(1.0, 4 * theta**2), rng.uniform(-1, 1)
        there = np.array([face > 0])
        natural = theta_to_states(disk, theta, 0.4, s3, s4, face).motion
        S = 2 * mpmath.sin(mpmath.mpf(float(theta)) / 2) ** 2
        rho, drho, D, dD = hypergeometric(b.c, S)
        sigma3_bar = b.r0 * (face * b.k * s4 * D - s3 * dD)
        eta = b.I1 * (s3 * drho - face * b.k * s4 * rho)
        assert natural.sigma3_bar[0] == pytest.approx(float(sigma3_bar), rel=1e-13, abs=1e-15)
        assert abs(natural.eta(there)[0] - float(eta)) <= natural.rounding(there)[0]


@pytest.mark.parametrize(
    ("plus", "minus"),
    [(1.0, 2.0), (2.0, -1.0), (-1.0, 1.0), (0.0, 0.0), (math.nan, 1.0), (1.0, math.nan)],
)
def test_compiled_which_face_is_nearer_is_decided_alike_also_in_ties(plus, minus):
    compiled = device(constants.nearer_minus)(plus, minus)
    assert compiled != linear_constants.nearer_plus(np.array(plus), np.array(minus))
