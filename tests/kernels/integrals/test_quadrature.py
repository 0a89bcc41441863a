"""One passage as an integral."""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer.phase.gauss import packed_rules
from kernels.integrals import nodes
from kernels.integrals.point import VERTICAL, Motion, motion_through
from kernels.integrals.quadrature import Start, passage
from kernels.status import Status


def through(disk, X, Y, rate, target=1e-11):
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    motion = motion_through(VERTICAL, rate, X, Y, disk.natural)
    return passage(Start(VERTICAL, rate == 0.0, 0.0), motion, target, packed_rules(), disk.natural, W)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_two_sides_of_the_falling_set_differ_by_two_kappa_pi(name):
    """The race, eq. (7.9), at the smallest eta that doubles hold."""
    disk = BODIES[name]
    (_, plus), (_, minus) = (through(disk, 0.7, sign * 1e-290, 1.0) for sign in (1.0, -1.0))
    assert plus.chi - minus.chi == pytest.approx(2.0 * disk.race_limit, abs=1e-11)
    assert plus.time == pytest.approx(minus.time, rel=1e-12)
    assert (plus.way > 0.0) & (minus.way < 0.0)


@pytest.mark.parametrize("Y", [0.3, 1e-3, -1e-100])
def test_the_error_that_is_stated_covers_what_a_sharper_accuracy_changes(Y):
    disk = BODIES["hoop"]
    (rough_status, rough), (_, fine) = (through(disk, 0.9, Y, 0.8, target) for target in (1e-3, 1e-12))
    assert rough_status == Status.OK
    assert max(abs(rough.chi - fine.chi), abs(rough.psi - fine.psi)) <= rough.angle_error + fine.angle_error
    assert abs(rough.time / fine.time - 1.0) <= rough.time_error + fine.time_error
    assert rough.angle_error < 1e-3


def test_an_accuracy_that_rounding_forbids_is_not_claimed():
    """A start so slow that the time is lost in rounding."""
    status, _ = through(BODIES["uniform"], 0.0, 1e-3, 1e-9)
    assert status == Status.STEP_LIMIT


def test_a_motion_that_moves_away_from_flat_is_no_passage():
    disk = BODIES["uniform"]
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    start, motion = Start(VERTICAL, False, 0.0), Motion(0.7, 1e-3, 0.1)
    status, row = passage(start, motion, 1e-9, packed_rules(), disk.natural, W)
    assert status == Status.BAD_INPUT
    assert math.isnan(row.chi)
