"""What tests of passages and falls share: samples ordinary or wild, by tables and as arcs."""

import numpy as np

from explorer.motion import fall_integrals, passages_by_quadrature
from explorer.phase.coordinates import constants_to_states
from kernels.near_flat.passages import Crossings, passage_batch


def batch(disk, sigma3_bar, eta_hat, speed, accuracy, by_tables):
    """Passages from the vertical: rows of PassageRow and status; what tables do not serve, or all, as arcs."""
    n = sigma3_bar.size
    crossings = Crossings(sigma3_bar, eta_hat * disk.body.I3 * disk.body.r0, speed)
    out, status = np.full((8, n), np.nan), np.zeros(n, np.int8)

    def left():
        return np.flatnonzero(~(np.maximum(out[5], out[6]) <= accuracy))

    if by_tables:
        fall_integrals.by_tables(disk, passage_batch, crossings, accuracy, left, out)
    rows = left()
    some = Crossings(*(column[rows] for column in crossings))
    out[:, rows], status[rows] = passages_by_quadrature.as_arcs(disk, some, 0.0, accuracy)
    return out, status


def draw(rng, n, wild):
    sign = rng.choice([-1.0, 1.0], n)
    eta_hat = sign * 10.0 ** rng.uniform(-12 if wild else -8, 0, n)
    if wild:
        return 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n), eta_hat, 10.0 ** rng.uniform(-2, 3, n)
    return rng.uniform(-2, 2, n), eta_hat, rng.uniform(0.3, 3, n)


def start_on_f(disk, face, sigma3_bar=1.0, speed=1.0):
    """A start at the vertical on F; sigma3_bar and speed in natural units."""
    unit = disk.rate_unit
    return constants_to_states(disk, sigma3_bar * unit, 0.0, speed * unit, face)
