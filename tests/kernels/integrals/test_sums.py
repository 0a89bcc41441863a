"""What rules miss is told from their last coefficients, and of slow starts from where the speed vanishes."""

import numpy as np
import pytest

from explorer.phase.gauss import gauss
from kernels.integrals import sums
from kernels.integrals.tables import coefficients


def room(**rows):
    """A work array with these rows, else zeros."""
    W = np.zeros(sums.ROWS * sums.LANES)
    for name, value in rows.items():
        at = getattr(sums, name) * sums.LANES
        W[at : at + sums.LANES] = value
    return W


def of_lane(W, name):
    return W[getattr(sums, name) * sums.LANES]


def gathered(n, integrand):
    """A work array in which one rule on [-1, 1] has added up an integrand as all three integrals."""
    nodes, weights = gauss(n)
    tails, W = coefficients(np.stack([nodes, weights]), (n - 1, n - 2)), room()
    for j in range(n):
        for lane in range(sums.LANES):
            for rows in (sums.OF_CHI, sums.OF_REST, sums.OF_TIME):
                sums.gather(W, lane, rows, weights[j] * integrand(nodes[j]), *tails[:, j])
    return W


@pytest.mark.parametrize("pole", [1.2, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("n", [6, 10, 16])
def test_coefficients_tell_what_a_rule_misses(n, pole):
    """Of 1/(pole - x): its Legendre series is geometric, like ratio^-n, the rule misses ratio^-2n."""
    W = gathered(n, lambda x: 1.0 / (pole - x))
    missed = abs(of_lane(W, "TIME") - np.log((pole + 1.0) / (pole - 1.0)))
    sums.told_by_coefficients(W)
    ratio = pole + np.sqrt(pole * pole - 1.0)
    assert missed <= of_lane(W, "TIME_ERROR") + 1e-14
    assert of_lane(W, "TIME_ERROR") <= 1e6 * ratio ** (-2.0 * n)
    assert of_lane(W, "ANGLE_ERROR") == pytest.approx(2.0 * of_lane(W, "TIME_ERROR"))


@pytest.mark.parametrize("r", [0.02, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("n", [5, 9, 17, 24])
def test_what_is_missed_of_a_slow_start_is_told_whatever_its_coefficients_are(n, r):
    """Of 1/sqrt(r^2 + (1 + x)^2), the time of a motion whose speed vanishes at -1 +- i r."""
    nodes, weights = gauss(n)
    missed = abs(weights @ (1.0 / np.hypot(r, 1.0 + nodes)) - np.arcsinh(2.0 / r))
    W = room(ROOT2=r * r, TIME_SIZE=np.arcsinh(2.0 / r))
    sums.told_by_the_start(W, n)
    assert missed <= 10.0 * of_lane(W, "TIME_ERROR") <= 1e3 * missed + 1e-3


def test_a_start_that_is_not_slow_adds_nothing():
    W = room(ROOT2=1.0, TIME_SIZE=1.0, CHI_SIZE=1.0, REST_SIZE=1.0)
    sums.told_by_the_start(W, 24)
    assert 0.0 < of_lane(W, "ANGLE_ERROR") < 1e-16


def test_sums_stand_where_both_errors_meet_the_target():
    kept = {"CHI": 1.0, "REST": 0.4, "TIME": 2.0, "LEAST": 1.0}
    for angle, time, check in ((1e-7, 1e-7, 0.0), (1e-5, 0.0, 1.0), (0.0, 1e-5, 1.0)):
        W = room(**kept, ANGLE_ERROR=angle, TIME_ERROR=time)
        sums.finish(W, 1e-6, 1e-13)
        assert of_lane(W, "CHECK") == check
    assert (of_lane(W, "CHI"), of_lane(W, "PSI"), of_lane(W, "TIME")) == pytest.approx((2.0, 1.2, 4.0))
