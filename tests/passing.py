"""What tests of passages share: samples drawn at random, ordinary or wild, with and without tables."""

import math

import numpy as np

from kernels.integrals import passages
from kernels.integrals.point import VERTICAL


def batch(disk, sigma3_bar, eta_hat, speed, accuracy, by_tables):
    """out and status; without tables by asking for a window one rounding below the vertical."""
    n = sigma3_bar.size
    out, status = np.empty((8, n)), np.zeros(n, np.int8)
    eta = eta_hat * disk.body.I3 * disk.body.r0
    h_end = VERTICAL if by_tables else math.nextafter(VERTICAL, 0.0)
    crossings = passages.Crossings(sigma3_bar, eta, speed)
    passages.passage_batch(crossings, h_end, accuracy, disk.quadrature, disk.natural, out, status)
    return out, status


def draw(rng, n, wild):
    sign = rng.choice([-1.0, 1.0], n)
    eta_hat = sign * 10.0 ** rng.uniform(-12 if wild else -8, 0, n)
    if wild:
        return 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n), eta_hat, 10.0 ** rng.uniform(-2, 3, n)
    return rng.uniform(-2, 2, n), eta_hat, rng.uniform(0.3, 3, n)
