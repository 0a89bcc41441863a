"""What tests of passages share: samples drawn at random, ordinary or wild, with and without tables."""

import numpy as np

from explorer.motion import passages_by_quadrature
from explorer.phase.gauss import packed_rules
from kernels.integrals import passages
from kernels.integrals.point import VERTICAL


def batch(disk, sigma3_bar, eta_hat, speed, accuracy, by_tables):
    """out and status, from the vertical; without tables by rules that know the speed there as well."""
    n = sigma3_bar.size
    status = np.zeros(n, np.int8)
    crossings = passages.Crossings(sigma3_bar, eta_hat * disk.body.I3 * disk.body.r0, speed)
    return across(disk, crossings, VERTICAL, accuracy, status, by_tables), status


def across(disk, crossings, h_end, accuracy, status, by_tables=True):
    """Passages by the kernels: out (8, n). status becomes theirs."""
    out = np.full((8, status.size), np.nan)
    if by_tables:
        passages_by_quadrature.by_tables(disk, crossings, accuracy, out, status)
    passages.passage_by_rules_batch(crossings, h_end, accuracy, packed_rules(), disk.natural, out, status)
    return out


def draw(rng, n, wild):
    sign = rng.choice([-1.0, 1.0], n)
    eta_hat = sign * 10.0 ** rng.uniform(-12 if wild else -8, 0, n)
    if wild:
        return 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n), eta_hat, 10.0 ** rng.uniform(-2, 3, n)
    return rng.uniform(-2, 2, n), eta_hat, rng.uniform(0.3, 3, n)
