"""One fall on F as an integral, however slowly it leaves the vertical."""

import math

import mpmath
import numpy as np
import pytest
from conftest import BODIES
from scipy.special import ellipkinc

from explorer.motion.passages_by_quadrature import vertical_above_flat
from explorer.phase.gauss import packed_rules
from kernels.integrals import nodes
from kernels.integrals.falls import Departure, fall
from kernels.integrals.point import VERTICAL, Motion, motion_through, point
from kernels.integrals.quadrature import Start, passage


def falling(disk, X, moving, doubt=0.0):
    """The fall with this kinetic energy at the vertical."""
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    above = float(vertical_above_flat(disk, np.array([X * disk.body.r0]))[0])
    motion = Motion(X, 0.0, moving + above)
    return fall(VERTICAL, Departure(moving, doubt), motion, packed_rules(), disk.natural, W)


def test_half_a_passage_is_nearly_a_fall():
    """On F itself the fall takes half the time of a passage beside it."""
    disk = BODIES["uniform"]
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    beside = motion_through(VERTICAL, 1.0, 0.7, 1e-200, disk.natural)
    _, row = passage(Start(VERTICAL, False, 0.0), beside, 1e-11, packed_rules(), disk.natural, W)
    on_f = falling(disk, 0.7, 0.5 * disk.body.M)
    assert 2.0 * on_f.time == pytest.approx(row.time, abs=1e-12)
    assert 2.0 * on_f.chi == pytest.approx(row.chi - disk.race_limit, abs=1e-11)


@pytest.mark.parametrize("kinetic", [1e-4, 1e-12, 1e-40])
def test_a_slow_fall_without_spin_is_an_elliptic_integral_in_every_digit(body, kinetic):
    """However slowly it begins: its kinetic energy is given, and no difference of energies."""
    found = falling(body, 0.0, kinetic)
    exact = math.sqrt(2.0 * body.body.M / kinetic) * ellipkinc(0.25 * math.pi, -2.0 / kinetic)
    assert abs(found.time - exact) <= found.error
    assert found.error <= 1e-12 * exact


@pytest.mark.parametrize("X", [0.05, 0.7])
def test_a_fall_that_begins_at_rest_joins_those_that_cross_the_vertical(X):
    """The time is a smooth function of the energy, on both sides of that of a rest at the vertical."""
    disk, step = BODIES["hoop"], 1e-7 * X * X
    times = [falling(disk, X, moving).time for moving in (-2.0 * step, -step, step, 2.0 * step)]
    middle = falling(disk, X, 1e-26).time
    # A start with a speed saves a time in proportion to it; one that comes later is a smooth function of its tilt.
    roots = np.sqrt(step) * np.array([1.0, math.sqrt(2.0)])
    slopes = (middle - np.array(times[2:])) / roots
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-2)
    assert abs(times[1] - middle) < 1e-5 / X
    assert abs(times[0] - 2.0 * times[1] + middle) < 1e-2 * abs(times[1] - middle)


@pytest.mark.parametrize("lacks", [0.02, 0.3])
def test_the_series_beside_a_rest_and_the_one_beside_the_vertical_agree_with_the_potential(lacks):
    """A fall from rest against the same fall begun later, at speed, where E - V has its digits; one above, one
    below the end of the vertical's series."""
    disk = BODIES["uniform"]
    on_f = falling(disk, 0.9, -lacks)
    above = float(vertical_above_flat(disk, np.array([0.9 * disk.body.r0]))[0])
    motion = Motion(0.9, 0.0, above - lacks)
    theta = np.linspace(0.0, 0.5 * math.pi, 4001)[1:]
    left = np.array([motion.level - point(2.0 * math.sin(0.5 * t), 0.9, 0.0, disk.natural).V for t in theta])
    start = np.interp(0.0, -left, theta)
    assert left[theta < start - 1e-3].min() > 0.0
    # Midpoints of theta = start (1 - x^2), whose ends are off by less than a thousandth
    x = (np.arange(400) + 0.5) / 400.0
    places = start * (1.0 - x * x)
    left = np.array([motion.level - point(2.0 * math.sin(0.5 * t), 0.9, 0.0, disk.natural).V for t in places])
    time = np.sum(2.0 * start * x / 400.0 / np.sqrt(2.0 * disk.body.inv_M * left))
    assert on_f.time == pytest.approx(time, rel=2e-3)
    assert on_f.error < 1e-11


def test_what_is_not_known_of_the_start_is_told():
    disk = BODIES["thick"]
    known, blurred = falling(disk, 0.1, 1e-6), falling(disk, 0.1, 1e-6, 1e-12)
    moved = falling(disk, 0.1, 1e-6 + 1e-12)
    assert blurred.chi == pytest.approx(known.chi, rel=1e-12)
    assert abs(moved.time - known.time) <= blurred.error
    assert known.error < 0.1 * blurred.error


@pytest.mark.parametrize("kinetic", [1e-4, 1e-8, 1e-14])
def test_a_slow_fall_that_begins_below_the_vertical_knows_what_rounding_costs_it(kinetic):
    """Its energy is a sum with most of its kinetic energy rounded off; 30 digits follow the same sum."""
    disk, h = BODIES["uniform"], 1.0
    level = point(h, 0.0, 0.0, disk.natural).V + kinetic
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    found = fall(h, Departure(math.nan, 0.0), Motion(0.0, 0.0, level), packed_rules(), disk.natural, W)
    with mpmath.workdps(30):
        theta, M = 2 * mpmath.asin(mpmath.mpf(h) / 2), mpmath.mpf(disk.body.M)
        moving = level - mpmath.sin(theta)

        def rate(x):
            """dt/dx, with x^2 the tilt fallen through."""
            gained = 2 * mpmath.cos(theta - x * x / 2) * mpmath.sin(x * x / 2)
            return 2 * x * mpmath.sqrt(M / (2 * (moving + gained)))

        slow = mpmath.sqrt(moving)
        exact = mpmath.quad(rate, sorted([0, slow / 4, slow, 4 * slow, 16 * slow, mpmath.sqrt(theta)]))
    assert abs(found.time - exact) <= found.error <= 1e-6
