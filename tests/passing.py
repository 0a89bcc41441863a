"""What tests of passages, periods and falls share: samples ordinary or wild, with and without tables."""

import numpy as np

from explorer.motion import passages_by_quadrature
from explorer.motion.legs import legs_of
from explorer.phase.gauss import packed_rules
from explorer.phase.states import constants_to_states
from kernels.integrals import passages
from kernels.integrals.orbits import OrbitRow, orbits_of_legs
from kernels.integrals.point import VERTICAL, Orbits


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


def orbits_anywhere(disk, n, seed, least=-4.0):
    """Motions all over the phase space, as seen from their hemisphere."""
    rng = np.random.default_rng(seed)
    b, bar = disk.body, rng.uniform(-1.5, 1.5, n)
    near = rng.choice([-1.0, 1.0], n) * b.I3 * b.r0 * 10.0 ** rng.uniform(least, 0.0, n)
    h = rng.uniform(0.1, VERTICAL, n)
    return Orbits(h, rng.uniform(-1.0, 1.0, n), bar, near, 2.0 * b.I1 * b.dr0 * bar - near, 1.0 - 0.5 * h * h)


def periods_by_legs(disk, orbits, accuracy):
    """Periods by legs alone; NaN where lanes do not settle them."""
    n = orbits.h.size
    out, status = np.empty((8, n)), np.zeros(n, np.int8)
    ends, legs, _upright = legs_of(disk, orbits, status, accuracy, 2)
    orbits_of_legs(orbits, ends, legs, disk.natural, out, status)
    return OrbitRow(*out)


def start_on_f(disk, face, sigma3_bar=1.0, speed=1.0):
    """A start at the vertical on F; sigma3_bar and speed in natural units."""
    unit = disk.rate_unit
    return constants_to_states(disk, sigma3_bar * unit, 0.0, face * speed * unit, face)
