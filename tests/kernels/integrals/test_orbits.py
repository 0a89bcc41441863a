"""Whole periods, and the smallest tilt of a motion."""

import math

import numpy as np
import pytest
from conftest import BODIES
from passing import across

from explorer.phase.gauss import packed_rules
from kernels.integrals.ends import EndRow, Ends, end_batch
from kernels.integrals.orbits import OrbitRow, orbit_batch, tilt_batch
from kernels.integrals.passages import Crossings
from kernels.integrals.point import VERTICAL, Orbits
from kernels.integrals.quadrature import PassageRow
from kernels.status import Status


def motions(disk, n, seed=2):
    """At the vertical, with eta on both sides as one motion has them."""
    rng = np.random.default_rng(seed)
    bar, near, rate = rng.uniform(-2.0, 2.0, n), rng.uniform(-0.3, 0.3, n), rng.uniform(0.3, 2.0, n)
    far = 2.0 * disk.body.I1 * disk.body.dr0 * bar - near
    return Orbits(np.full(n, VERTICAL), rate, bar, near, far, np.zeros(n))


def periods(disk, orbits, target=1e-10):
    out, status = np.full((8, orbits.h.size), np.nan), np.zeros(orbits.h.size, np.int8)
    orbit_batch(orbits, target, packed_rules(), disk.natural, out, status)
    return OrbitRow(*out), status


def tilts(disk, orbits, target=1e-10, status=None, in_lanes=False):
    """Smallest tilts and statuses, by turning points from lanes or one at a time."""
    n = orbits.h.size
    ends, status = np.full((len(EndRow._fields), n), np.nan), np.zeros(n, np.int8) if status is None else status
    if in_lanes:
        end_batch(orbits, disk.leg_tables, disk.natural, ends, status)
    theta = np.empty(n)
    tilt_batch(orbits, Ends(*ends), target, disk.natural, theta, status)
    return theta, status


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_a_period_across_the_vertical_is_a_passage_on_either_face(name):
    disk = BODIES[name]
    orbits = motions(disk, 50)
    period, status = periods(disk, orbits)
    sides = []
    for eta in (orbits.near, orbits.far):
        passed = np.zeros(50, np.int8)
        crossings = Crossings(orbits.sigma3_bar, eta, orbits.rate)
        out = across(disk, crossings, VERTICAL, 1e-10, passed)
        assert (passed == Status.OK).sum() >= 49
        sides.append(PassageRow(*out))
    here, there = sides
    ok = status == Status.OK
    assert ok.sum() >= 49  # rounding may forbid the accuracy
    np.testing.assert_allclose(period.time[ok], (here.time + there.time)[ok], rtol=1e-9)
    np.testing.assert_allclose(period.chi[ok], (here.chi + there.chi)[ok], atol=1e-9)
    np.testing.assert_allclose(period.psi[ok], (here.psi - there.psi)[ok], atol=1e-9)
    np.testing.assert_allclose(period.theta_here, here.theta_min, rtol=1e-11)
    np.testing.assert_allclose(period.theta_there, there.theta_min, rtol=1e-11)


def test_the_smallest_tilt_needs_no_integral():
    disk = BODIES["hoop"]
    orbits = motions(disk, 50)
    period, _ = periods(disk, orbits)
    theta, status = tilts(disk, orbits)
    assert (status == Status.OK).all()
    np.testing.assert_allclose(theta, np.fmin(period.theta_here, period.theta_there), rtol=1e-14)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_turning_points_from_lanes_give_the_tilts_of_those_found_one_at_a_time(name):
    """Across the vertical and below it, down to |eta| = 1e-300, to rounding; wobbles too."""
    disk, n, rng = BODIES[name], 400, np.random.default_rng(8)
    bar, near = rng.uniform(-2.0, 2.0, n), 10.0 ** rng.uniform(-300.0, -0.5, n) * rng.choice([-1.0, 1.0], n)
    near[::2] = rng.uniform(-0.5, 0.5, n // 2)
    h = np.where(abs(near) < 1e-2, VERTICAL, rng.uniform(0.3, VERTICAL, n))
    rate = rng.uniform(0.3, 2.0, n) * np.where(h < VERTICAL, rng.choice([1e-6, 1e-3, 1.0], n), 1.0)
    far = 2.0 * disk.body.I1 * disk.body.dr0 * bar - near
    orbits = Orbits(h, rate, bar, near, far, 1.0 - 0.5 * h * h)
    one_by_one, status = tilts(disk, orbits)
    in_lanes, codes = tilts(disk, orbits, in_lanes=True)
    np.testing.assert_array_equal(codes, status)
    assert (status == Status.OK).mean() > 0.98
    # One at a time ln h is what is found: at 1e-300 its last digit is 1e-13 of h.
    np.testing.assert_allclose(in_lanes, one_by_one, rtol=1e-12)


@pytest.mark.parametrize("in_lanes", [False, True])
def test_a_motion_is_flattest_where_it_rests_if_it_rises_from_there(in_lanes):
    disk, one = BODIES["uniform"], np.ones(1)
    constants = 0.3 * one, -0.02 * one, 0.3 * one
    flattest, _ = tilts(disk, Orbits(0.4 * one, 0.05 * one, *constants, 0.92 * one))
    h = 2.0 * np.sin(0.5 * flattest)
    theta, status = tilts(disk, Orbits(h, 0.0 * one, *constants, 1.0 - 0.5 * h * h), in_lanes=in_lanes)
    assert status[0] == Status.OK
    np.testing.assert_allclose(theta, flattest, rtol=1e-12)


def test_a_motion_that_stays_on_one_face_never_comes_near_the_other():
    disk, one = BODIES["uniform"], np.ones(1)
    period, status = periods(disk, Orbits(0.4 * one, 0.05 * one, 0.3 * one, -0.02 * one, 0.3 * one, 0.92 * one))
    assert status[0] == Status.OK
    assert math.isnan(period.theta_there[0])
    assert 0.0 < period.theta_here[0] < 2.0 * math.asin(0.2)


def test_samples_marked_beforehand_are_skipped():
    disk = BODIES["uniform"]
    orbits, marked = motions(disk, 4), np.array([2, 0, 1, 0], np.int8)
    out, status = np.full((8, 4), np.nan), marked.copy()
    orbit_batch(orbits, 1e-9, packed_rules(), disk.natural, out, status)
    theta, tilted = tilts(disk, orbits, status=marked.copy())
    for codes, numbers in ((status, out[2]), (tilted, theta)):
        np.testing.assert_array_equal(codes, marked)
        np.testing.assert_array_equal(np.isnan(numbers), marked != 0)
