"""Slow starts at the vertical: E - V beside it."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.gauss import packed_rules
from kernels.integrals import departure, nodes
from kernels.integrals.point import VERTICAL, motion_through, point
from kernels.integrals.quadrature import Start, passage
from kernels.status import Status

X, Y = 0.7, 0.2


def expanded(disk, moving, x=1.0, y=1.0):
    """The series of a start whose constants were changed by these factors."""
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    departure.expand_start(W, moving, x * X, y * Y, disk.body)
    return W


@pytest.mark.parametrize("u", [1e-4, 0.01, 0.149])
def test_the_series_is_what_the_motion_gains(body, u):
    """Against the difference of potentials, where that has digits left."""
    W = expanded(body, 0.25)
    h = math.sqrt(2.0 * (1.0 - u))
    gained = point(VERTICAL, X, Y, body.natural).V - point(h, X, Y, body.natural).V
    at_start = departure.left_at(W, u)
    assert at_start == pytest.approx(0.25 + gained, abs=3e-14)


@pytest.mark.parametrize("u", [0.0, 1e-9, 0.01, 0.149])
def test_a_state_beside_the_vertical_tells_what_is_left_of_the_energy_there(body, u):
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    there, rounding = departure.at_vertical(W, u, 0.25, X, Y, body.body)
    start = point(VERTICAL, X, Y, body.natural).V
    risen = point(math.sqrt(2.0 * (1.0 - u)), X, Y, body.natural).V - start
    assert there == pytest.approx(0.25 + risen, abs=3e-14)
    assert 0.0 < rounding < 1e-14 * (1.0 + abs(start))


def test_beyond_the_series_and_across_a_barrier_nothing_is_told_of_the_vertical():
    """V has its top beside the vertical, on the side that the sign of the spin says: nothing comes over it."""
    W, b = np.zeros(nodes.ROWS * nodes.ROOM), BODIES["uniform"].body
    assert math.isnan(departure.at_vertical(W, departure.WIDEST, 1.0, X, Y, b)[0])
    x = 0.2 / b.r0
    left = [departure.at_vertical(W, 0.06, 1e-6, x, b.r0 * (x * b.dr0 - b.k * spin), b)[0] for spin in (-0.1, 0.1)]
    assert sorted(map(math.isnan, left)) == [False, True]


@pytest.mark.parametrize("disk", [BODIES["uniform"], ex.Disk(I1=1e3, I3=2e3)], ids=["light", "heavy"])
def test_the_doubt_is_what_rounding_of_the_start_makes_of_it(disk):
    """Changes of the constants stand for rounding of their terms: far above it, so that theirs does not count."""
    share = 1e-6
    exact = expanded(disk, 0.25)
    ways = [expanded(disk, 0.25, 1.0 + share, 1.0 + sign * share) for sign in (1.0, -1.0)]
    for u in (1e-4, 0.01, 0.14):
        values = [departure.left_at(W, u) for W in (exact, *ways)]
        moved = max(abs(value - values[0]) for value in values) / share
        doubt = departure.doubt(exact, u) / (4.0 * np.finfo(float).eps)
        assert 0.1 * doubt <= moved <= doubt


@pytest.mark.parametrize("rate", [1e-9, 1e-3])
def test_a_motion_that_turns_back_at_once_does_so_with_constant_acceleration(rate):
    """Its time is 2 v/a up to a share of (v/a)^2, also where doubles hold no tilt between both ends."""
    disk = BODIES["uniform"]
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    # sigma3 and sigma4 of unlike signs at the vertical push it back.
    x, y = 0.7, 3.0
    at = point(VERTICAL, x, y, disk.natural)
    push = -at.slope / VERTICAL * math.sqrt(0.5) / disk.body.M  # dV/dh, dh/dtheta
    assert push > 0.0
    motion = motion_through(VERTICAL, rate, x, y, disk.natural)
    start = Start(VERTICAL, False, 0.5 * disk.body.M * rate * rate)
    status, row = passage(start, motion, 1e-11, packed_rules(), disk.natural, W)
    assert status == Status.OK
    assert row.time == pytest.approx(2.0 * rate / push, rel=1e-12 + 10.0 * (rate / push) ** 2)
    assert 0.5 * math.pi - row.theta_min == pytest.approx(0.5 * rate**2 / push, rel=1e-5, abs=3e-16)
