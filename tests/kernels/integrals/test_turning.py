"""Turning points of motions, inwards and outwards."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.integrals import nodes
from kernels.integrals.point import VERTICAL, Motion, kinetic, motion_through, point
from kernels.integrals.turning import turning_point, turning_point_outward


def room():
    return np.zeros(nodes.ROWS * nodes.ROOM)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_a_motion_has_no_speed_at_its_turning_point_and_some_all_the_way_there(name):
    natural = BODIES[name].natural
    for X, Y, rate in ((0.7, 1e-2, 1.0), (-1.3, -1e-6, 0.2), (0.1, 0.3, 2.0), (0.9, 1e-250, 0.5)):
        motion = motion_through(VERTICAL, rate, X, Y, natural)
        h = turning_point(VERTICAL, False, motion, natural, room())
        assert abs(motion.level - point(h, X, Y, natural).V) <= 1e-12 * (1.0 + abs(motion.level))
        assert all(kinetic(between, motion, natural) > 0.0 for between in np.geomspace(1.001 * h, VERTICAL, 50))
        assert kinetic(0.999 * h, motion, natural) < 0.0


def test_both_turning_points_of_a_motion_that_never_crosses_the_vertical_are_found_from_between():
    natural = BODIES["uniform"].natural
    motion = motion_through(0.4, 0.05, 0.2, -0.1, natural)
    inner = turning_point(0.4, False, motion, natural, room())
    outer = turning_point_outward(0.4, motion, natural)
    assert inner < 0.4 < outer < VERTICAL
    for h in (inner, outer):
        assert pytest.approx(motion.level, rel=1e-12) == point(h, 0.2, -0.1, natural).V


def test_a_motion_that_reaches_the_vertical_has_no_outer_turning_point():
    natural = BODIES["uniform"].natural
    assert math.isnan(turning_point_outward(0.4, motion_through(0.4, 3.0, 0.2, -0.1, natural), natural))


def test_a_start_where_the_motion_cannot_be_has_no_turning_point():
    natural = BODIES["uniform"].natural
    below = Motion(0.7, 1e-3, 0.5 * point(VERTICAL, 0.7, 1e-3, natural).V)
    assert math.isnan(turning_point(VERTICAL, False, below, natural, room()))


def test_a_motion_just_below_the_crest_of_its_potential_turns_back_before_it():
    """The crest lies between two of the few tilts that are looked at first."""
    natural, X, Y = BODIES["uniform"].natural, 0.2, 1.0
    h = np.linspace(1.3, VERTICAL, 401)
    V = np.array([point(each, X, Y, natural).V for each in h])
    crest = V.argmax()
    assert 0 < crest < 400
    level = V[crest] * (1.0 - 1e-5)
    assert level > V[-1]
    found = turning_point(VERTICAL, False, Motion(X, Y, level), natural, room())
    assert h[crest] < found < VERTICAL
    assert pytest.approx(level, rel=1e-12) == point(found, X, Y, natural).V
