"""What tests of passages share: samples drawn at random, ordinary or wild, with and without tables."""

import numpy as np

from kernels.integrals import passages
from kernels.integrals.point import VERTICAL


def without_tables(quadrature):
    """The rules with tables that answer nothing: a check against NaN fails, so every sample goes by the rules."""
    tables = quadrature.tables
    blank = {name: np.full_like(getattr(tables, name), np.nan) for name in ("vertical", "outer", "inner")}
    return quadrature._replace(tables=tables._replace(**blank))


def batch(disk, sigma3_bar, eta_hat, speed, accuracy, by_tables):
    """out and status, from the vertical; without tables by rules that know the speed there as well."""
    n = sigma3_bar.size
    out, status = np.empty((8, n)), np.zeros(n, np.int8)
    crossings = passages.Crossings(sigma3_bar, eta_hat * disk.body.I3 * disk.body.r0, speed)
    quadrature = disk.quadrature if by_tables else without_tables(disk.quadrature)
    passages.passage_batch(crossings, VERTICAL, accuracy, quadrature, disk.natural, out, status)
    return out, status


def draw(rng, n, wild):
    sign = rng.choice([-1.0, 1.0], n)
    eta_hat = sign * 10.0 ** rng.uniform(-12 if wild else -8, 0, n)
    if wild:
        return 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n), eta_hat, 10.0 ** rng.uniform(-2, 3, n)
    return rng.uniform(-2, 2, n), eta_hat, rng.uniform(0.3, 3, n)
