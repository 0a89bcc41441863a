"""What this core can do, measured: multiply-adds, products and sums apart, roots, divisions."""

import time
from typing import NamedTuple

import numba
import numpy as np

_CHAINS = 12  # independent sums: enough to hide the latency of an operation
_LANES = 16
_SIZE = _CHAINS * _LANES


class Peak(NamedTuple):
    """Per second of one core; strict: additions and multiplications, as many of each, none rounded together."""

    multiply_adds: float
    strict: float
    roots: float
    divisions: float


def _sums(x, a, b, rounds):
    for _ in range(rounds):
        for j in range(_SIZE):
            x[j] = x[j] * a + b
        for j in range(_SIZE):
            x[j] = x[j] * b + a


def _roots(x, _a, _b, rounds):
    for _ in range(rounds):
        for j in range(_SIZE):
            x[j] = np.sqrt(x[j])


def _divisions(x, a, _b, rounds):
    for _ in range(rounds):
        for j in range(_SIZE):
            x[j] = a / x[j]


def _compiled(loop, contracted=False):
    return numba.njit(fastmath={"contract"} if contracted else False, error_model="numpy")(loop)


def _rate(loop, rounds):
    """Numbers per second that go through the loop, best of several."""
    x = np.linspace(1.0, 2.0, _SIZE)
    loop(x, 0.999, 1e-3, 10)
    best = np.inf
    for _ in range(15):
        start = time.process_time()
        loop(x, 0.999, 1e-3, rounds)
        best = min(best, time.process_time() - start)
    return _SIZE * rounds / best


def peak():
    """The limits of this core, each the best of several times."""
    multiply_adds = 2.0 * _rate(_compiled(_sums, contracted=True), 50_000)
    strict = 4.0 * _rate(_compiled(_sums), 50_000)
    return Peak(multiply_adds, strict, _rate(_compiled(_roots), 20_000), _rate(_compiled(_divisions), 20_000))
