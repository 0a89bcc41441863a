"""The constant of the law of races, on races that the law made."""

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


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_race_made_by_the_law_gives_its_constant_back(side):
    """K = 2 m g r/(I1 M A^3) in natural units: twice the speed, an eighth of it."""
    eta_hat, speed, b = side * np.geomspace(1e-6, 1e-3, 5), np.array([1.0, 2.0, 0.5, 1.0, 3.0]), DISK.body
    eta = b.I3 * b.r0 * eta_hat
    beyond = 2.0 * eta / (b.I1 * b.M * speed**3) * (np.log(1.0 / abs(eta)) - 9.5)
    constant, _, _ = constants_of(eta_hat, side * LIMIT + beyond, speed, np.ones(5))
    assert constant == pytest.approx(np.full(5, 9.5), rel=1e-6)


def test_a_constant_is_known_as_well_as_its_race_and_not_at_all_on_f():
    eta_hat, race, b = np.array([1e-3, 0.0, np.nan, 1e-3]), np.full(4, LIMIT + 1e-3), DISK.body
    race[3] = np.nan
    constant, doubt, _ = constants_of(eta_hat, race, np.ones(4), np.full(4, 1e-9))
    assert np.isfinite(constant).tolist() == [True, False, False, False]
    assert doubt == pytest.approx([0.5e-9 * b.I1 * b.M], rel=1e-12)
