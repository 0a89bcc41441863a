"""The vectorised evaluation of many tilts against the plain one."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.integrals import nodes
from kernels.integrals.point import Motion, point


def row(W, which, n):
    return W[which * nodes.ROOM : which * nodes.ROOM + n]


@pytest.mark.parametrize("h_turn", [1e-300, 1e-40, 1e-6, 1e-2, 0.3, 1.3])
def test_nodes_are_placed_where_the_hyperbolic_cosine_puts_them(h_turn):
    h_end = math.sqrt(2.0)
    y_end = math.acosh(h_end / h_turn)
    gaps = np.concatenate([np.linspace(0.0, min(y_end, 36.0), 40), np.geomspace(1e-12, min(y_end, 1.0), 20)])
    n = gaps.size
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    row(W, nodes.GAP, n)[:] = gaps
    nodes.place(W, n, h_end, h_turn, y_end)
    y = y_end - gaps
    h = row(W, nodes.H, n)
    # sixteen roundings in an exponential, and the rounding of y itself
    np.testing.assert_allclose(h, h_turn * np.cosh(y), rtol=2e-14 + 5e-16 * y_end)
    np.testing.assert_allclose(row(W, nodes.LOG, n), 2.0 * np.log(h) - math.log(2.0), atol=3e-13, rtol=1e-15)
    near = y < 1.0
    excess = 2.0 * np.sinh(0.5 * y[near]) ** 2
    # relative, so that P keeps its digits next to the turning point
    np.testing.assert_allclose(h[near] / h_turn - 1.0, excess, atol=3e-16, rtol=6e-14)
    # On a short way ln S, and V with it, is rounded a few times and not sixteen.
    short = y < 2.0
    np.testing.assert_allclose(row(W, nodes.LOG, n)[short], 2.0 * np.log(h[short] / math.sqrt(2.0)), atol=1e-14)


@pytest.mark.parametrize("name", list(BODIES))
def test_levels_and_slopes_are_those_of_a_single_tilt(name):
    disk = BODIES[name]
    h = np.geomspace(1e-8, math.sqrt(2.0), 50)
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    row(W, nodes.H, 50)[:] = h
    row(W, nodes.LOG, 50)[:] = 2.0 * np.log(h) - math.log(2.0)
    X, Y = 0.7, 1e-5
    nodes.levels(W, 50, Motion(X, Y, 0.0), disk.natural)
    for j, tilt in enumerate(h):
        at = point(tilt, X, Y, disk.natural)
        scale = disk.body.J * (X / disk.body.k) ** 2
        assert row(W, nodes.LEVEL, 50)[j] == pytest.approx(at.V, rel=1e-13, abs=1e-14 * scale)
        assert row(W, nodes.SLOPE, 50)[j] == pytest.approx(at.slope, rel=1e-12, abs=1e-13 * scale)
