"""The constant of the law of races, against NumPy's columns and a race that the law made."""

import numpy as np
import pytest
from conftest import BODIES

from kernels.disk.race_law import Races, constant_batch

DISK = BODIES["thick"]
LIMIT = DISK.race_limit


def constants_of(eta_hat, race, speed, error):
    """Constants, doubts of those that are known, and |eta|."""
    size = abs(DISK.eta_hat_to_eta(eta_hat))
    constant, doubt, known = np.empty(size.size), np.empty(size.size), np.zeros(1, np.int64)
    with np.errstate(all="ignore"):
        races = Races(eta_hat, race, error, size, speed**3, np.log(1.0 / size))
    constant_batch(races, LIMIT, DISK.body, constant, doubt, known)
    return constant, doubt[: known[0]], size


def test_constants_and_doubts_are_those_of_columns_to_the_last_digit():
    rng, n = np.random.default_rng(3), 2000
    eta_hat = 10.0 ** rng.uniform(-16, 0, n) * rng.choice([1.0, -1.0], n)
    race, speed = np.sign(eta_hat) * LIMIT + 3.0 * eta_hat, rng.uniform(0.1, 4.0, n)
    error = 10.0 ** rng.uniform(-15, -9, n)
    eta_hat[:4], race[4:8], speed[8:10] = (
        [0.0, -0.0, np.nan, np.inf],
        [np.nan, np.inf, -np.inf, LIMIT],
        [0.0, np.nan],
    )
    constant, doubt, size = constants_of(eta_hat, race, speed, error)
    b, side = DISK.body, np.sign(eta_hat)
    with np.errstate(all="ignore"):
        scale = 2.0 / (b.I1 * b.M * speed**3) * size
        plain = np.log(1.0 / size) - side * (race - side * LIMIT) / scale
        good, plain_doubt = np.isfinite(plain) & (scale > 1e-12), error * size / scale
    assert 0 < good.sum() < n
    np.testing.assert_array_equal(constant, np.where(good, plain, np.nan))
    np.testing.assert_array_equal(doubt, plain_doubt[good])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_race_made_by_the_law_gives_its_constant_back(side):
    """K = 2 m g r/(I1 M A^3) in natural units: twice the speed, an eighth of it."""
    eta_hat, speed, b = side * np.geomspace(1e-6, 1e-3, 5), np.array([1.0, 2.0, 0.5, 1.0, 3.0]), DISK.body
    eta = b.I3 * b.r0 * eta_hat
    beyond = 2.0 * eta / (b.I1 * b.M * speed**3) * (np.log(1.0 / abs(eta)) - 9.5)
    constant, _, _ = constants_of(eta_hat, side * LIMIT + beyond, speed, np.ones(5))
    assert constant == pytest.approx(np.full(5, 9.5), rel=1e-6)
