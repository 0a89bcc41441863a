"""Both turning points in lanes: E = V there, V below E between, and a barrier between two tilts is not jumped."""

import numpy as np
import pytest
from conftest import BODIES
from passing import orbits_anywhere

from kernels.integrals.ends import Ends, barrier_between, end_batch
from kernels.integrals.point import VERTICAL, Orbits, Point, point_batch
from kernels.status import Status


def ends_of(disk, orbits, status=None):
    out = np.empty((5, orbits.h.size))
    status = np.zeros(orbits.h.size, np.int8) if status is None else status
    end_batch(orbits, disk.leg_tables, disk.natural, out, status)
    return Ends(*out)


def potential(disk, h, X, Y):
    out = np.empty((7, h.size))
    point_batch(h, X, Y, disk.natural, out)
    return Point(*out).V


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_motion_is_between_its_ends_and_turns_there(name):
    disk, n = BODIES[name], 300
    b, orbits = disk.body, orbits_anywhere(disk, n, 1)
    ends = ends_of(disk, orbits)
    known = ~np.isnan(ends.here)
    crosses = np.isfinite(ends.there)
    assert known.mean() > 0.95
    assert 0.1 < crosses.mean() < 0.9
    for i in np.flatnonzero(known):
        X, Y, level = orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1, ends.level[i]
        assert ends.here[i] <= orbits.h[i] * (1.0 + 1e-12)
        assert orbits.h[i] <= ends.outer[i] * (1.0 + 1e-12)
        way = np.linspace(ends.here[i], ends.outer[i], 300)
        left = level - potential(disk, way, X, Y)
        assert (left[1:-1] > -1e-10 * (1.0 + level)).all()
        assert left[0] == pytest.approx(0.0, abs=1e-10 * (1.0 + level))
        if crosses[i]:
            assert ends.outer[i] == VERTICAL
            assert left[-1] == pytest.approx(ends.moving[i], abs=1e-10 * (1.0 + level))
            beyond = np.linspace(ends.there[i], VERTICAL, 300)
            left = level - potential(disk, beyond, X, orbits.far[i] / b.I1)
            assert (left[1:] > -1e-10 * (1.0 + level)).all()
        assert left[0 if crosses[i] else -1] == pytest.approx(0.0, abs=1e-10 * (1.0 + level))


def test_lanes_do_not_depend_on_their_neighbours():
    disk = BODIES["uniform"]
    orbits, order = orbits_anywhere(disk, 101, 2), np.random.default_rng(3).permutation(101)
    one, other = ends_of(disk, orbits), ends_of(disk, Orbits(*(column[order] for column in orbits)))
    for column, shuffled in zip(one, other, strict=True):
        np.testing.assert_array_equal(column[order], shuffled)
    alone = ends_of(disk, Orbits(*(column[7:8].copy() for column in orbits)))
    assert [column[7] for column in one] == pytest.approx([column[0] for column in alone], rel=0, nan_ok=True)


def test_near_flat_the_end_is_that_of_first_order():
    disk, n = BODIES["hoop"], 4
    b, eta = disk.body, np.array([1e-9, -1e-100, 1e-200, -1e-300])
    bar = np.ones(n)
    orbits = Orbits(np.full(n, VERTICAL), np.full(n, -1.0), bar, eta, 2.0 * b.I1 * b.dr0 * bar - eta, np.zeros(n))
    ends = ends_of(disk, orbits)
    np.testing.assert_allclose(ends.here, abs(eta) / b.I1 * np.sqrt(0.5 * b.I1 / ends.level), rtol=1e-8)


def test_what_is_not_ok_or_no_number_stays_unknown():
    disk = BODIES["uniform"]
    orbits = orbits_anywhere(disk, 40, 4)
    orbits.h[3], orbits.rate[4] = np.nan, np.inf
    status = np.zeros(40, np.int8)
    status[5] = Status.BAD_INPUT
    ends = ends_of(disk, orbits, status)
    assert np.isnan(ends.here[[3, 4, 5]]).all()
    assert np.isfinite(ends.here[6:]).mean() > 0.9


@pytest.mark.parametrize(
    ("gap", "dV", "next_gap", "next_dV", "expected"),
    [
        (0.1, 1.0, 0.1, -1.0, True),  # tangents meet at 0.5 above
        (0.6, 1.0, 0.6, -1.0, False),  # and stay below the level
        (0.1, -1.0, 0.1, 1.0, False),  # a well
        (-0.1, 1.0, 0.1, -1.0, False),  # barred there already
    ],
)
def test_a_barrier_is_where_tangents_pass_the_level(gap, dV, next_gap, next_dV, expected):
    assert barrier_between(gap, dV, next_gap, next_dV, 1.0) == expected
