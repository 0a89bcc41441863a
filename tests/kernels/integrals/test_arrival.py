"""Series of E - V beside the turning point, of motions that turn far from flat."""

import math

import numpy as np
import pytest

from kernels.integrals import arrival, nodes
from kernels.integrals.point import Motion, point

X, Y = 0.7, 0.2


def expanded(disk, h):
    """The work array with the series of a motion that turns at h, and E there."""
    W, turn = np.zeros(nodes.ROWS * nodes.ROOM), point(h, X, Y, disk.natural)
    arrival.expand_turn(W, turn, Motion(X, Y, turn.V), disk.body)
    return W, turn.V


@pytest.mark.parametrize("h_turn", [0.1, 0.6, 1.2])
@pytest.mark.parametrize("x", [-0.149, 1e-3, 0.149])
def test_the_series_is_what_the_potential_falls_by(body, h_turn, x):
    """Against the difference of potentials, where that has digits left."""
    W, V = expanded(body, h_turn)
    gained = V - point(h_turn * math.sqrt(1.0 + x), X, Y, body.natural).V
    assert arrival.left_beside_turn(W, x) == pytest.approx(gained, abs=2e-13 * (1.0 + abs(V)))


def test_nothing_is_lost_next_to_the_turning_point(body):
    """E - V over x keeps its digits where a difference has none."""
    W, _V = expanded(body, 1.1)
    slope = arrival.left_beside_turn(W, 1e-30) / 1e-30
    turn = point(1.1, X, Y, body.natural)
    # d/dx is h/2 d/dh there
    assert slope == pytest.approx(-0.5 * turn.slope, rel=1e-13)
    assert arrival.doubt_beside_turn(W, 1e-30) < 1e-13 * abs(slope) * 1e-30


def test_nodes_learn_from_the_series_unless_they_know_better(body):
    W, _V = expanded(body, 1.1)
    gaps = np.array([0.5, 0.3, 0.1])  # below y = 0.6: sinh^2 y is 0.01, 0.09, 0.27
    W[nodes.GAP * nodes.ROOM : nodes.GAP * nodes.ROOM + 3] = gaps
    W[nodes.KNOWN * nodes.ROOM + 1], W[nodes.NOISE * nodes.ROOM + 1] = 7.0, 0.0
    arrival.know_beside_turn(W, 3, 0.6)
    known = W[nodes.KNOWN * nodes.ROOM : nodes.KNOWN * nodes.ROOM + 3]
    left = arrival.left_beside_turn(W, math.sinh(0.1) ** 2)
    assert known[0] == (left if left > 0.0 else 0.0)
    assert known[1:].tolist() == [7.0, 0.0]
