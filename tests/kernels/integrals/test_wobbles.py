"""Wobbles about steady motion: against forty digits, from no wobble at all to where the rules take over."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.gauss import packed_rules
from kernels.integrals.bounces import BounceRow, bounce_batch
from kernels.integrals.orbits import OrbitRow, orbit_batch
from kernels.integrals.point import VERTICAL, Orbits, Point, point_batch
from kernels.status import Status

ROWS = json.loads((Path(__file__).parents[2] / "reference" / "wobbles.json").read_text(encoding="utf-8"))
DISKS = {row["body"]: ex.Disk(I1=row["I1"], I3=row["I3"]) for row in ROWS}


def name_of(row):
    return f"{row['body']}-{row['theta']}-{row['swing']}"


def starts(disk, theta, rate, bar, eta_hat):
    """Motions as the kernels take them, from their tilts on face +1."""
    b, theta, bar = disk.body, np.asarray(theta), np.asarray(bar)
    near = np.asarray(eta_hat) * b.I3 * b.r0
    h, far = 2.0 * np.sin(0.5 * theta), 2.0 * b.I1 * b.dr0 * bar - near
    columns = np.broadcast_arrays(h, rate, bar, near, far, np.cos(theta))
    return Orbits(*(np.array(column, float) for column in np.atleast_1d(*columns)))


def batch(kernel, row, disk, orbits, target):
    out = np.full((len(row._fields), orbits.h.size), np.nan)
    status = np.zeros(orbits.h.size, np.int8)
    kernel(orbits, target, packed_rules(), disk.natural, out, status)
    return row(*out), status


def of_row(row):
    names = ("theta", "rate", "sigma3_bar", "eta_hat")
    return DISKS[row["body"]], starts(DISKS[row["body"]], *(row[name] for name in names))


@pytest.mark.parametrize("row", ROWS, ids=name_of)
def test_periods_are_those_of_forty_digits_and_their_errors_are_told(row):
    disk, orbits = of_row(row)
    found, status = batch(orbit_batch, OrbitRow, disk, orbits, 1e-9)
    assert status[0] == Status.OK
    angle = max(abs(found.chi[0] - float(row["chi"])), abs(found.psi[0] - float(row["psi"])))
    time = abs(found.time[0] / float(row["period"]) - 1.0)
    assert angle < 1e-9
    assert time < 1e-9
    assert angle <= found.angle_error[0]
    assert time <= found.time_error[0]
    least = min(float(row["inner"]), math.pi - float(row["outer"]))
    assert np.fmin(found.theta_here[0], found.theta_there[0]) == pytest.approx(least, rel=1e-9)


@pytest.mark.parametrize("row", [row for row in ROWS if row["swing"] in (0.0, 1e-5, 0.1)], ids=name_of)
def test_the_bounces_of_a_wobble_are_its_period_in_parts(row):
    disk, orbits = of_row(row)
    found, status = batch(bounce_batch, BounceRow, disk, orbits, 1e-9)
    assert status[0] == Status.OK
    there = np.isfinite(found.theta_there[0])
    assert there == (row["swing"] > 0.0 and float(row["inner"]) < 0.5 * math.pi < float(row["outer"]))
    beyond = np.nan_to_num([found.time_there[0], found.chi_there[0], found.psi_there[0]])
    assert found.time_here[0] + beyond[0] == pytest.approx(float(row["period"]), rel=1e-9)
    assert found.chi_here[0] + beyond[1] == pytest.approx(float(row["chi"]), abs=1e-9)
    assert found.psi_here[0] - beyond[2] == pytest.approx(float(row["psi"]), abs=1e-9)


def test_a_push_too_small_for_doubles_leaves_the_steady_motion():
    row = next(row for row in ROWS if row["swing"] == 0.0)
    disk, still = of_row(row)
    periods = [
        batch(orbit_batch, OrbitRow, disk, still._replace(rate=np.array([rate])), 1e-12)
        for rate in (0.0, 1e-300, 1e-160, -1e-30)
    ]
    for found, status in periods:
        assert status[0] == Status.OK
        assert found.time[0] == periods[0][0].time[0]
        assert found.chi[0] == periods[0][0].chi[0]


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_series_and_rules_agree_where_both_hold_the_motion(name):
    """One motion, seen from its bottom and from high up: the parabola there hands one to series, one to rules."""
    disk, rng, n = BODIES[name], np.random.default_rng(5), 300
    tilt, precession = rng.uniform(0.2, 1.1, n), rng.uniform(1.0, 3.0, n)
    known = ex.constants(ex.steady_motions(disk, tilt, precession).states)
    low = starts(disk, tilt, rng.uniform(0.1, 0.6, n) * tilt, known.sigma3_bar, known.eta_hat_plus)
    h = low.h * np.exp(rng.uniform(-0.4, 0.4, n))
    left = np.empty(n)
    for i in range(n):
        out = np.empty((7, 2))
        X, Y = low.sigma3_bar[i] / disk.body.r0, low.near[i] / disk.body.I1
        point_batch(np.array([low.h[i], h[i]]), X, Y, disk.natural, out)
        before, after = Point(*out).V
        left[i] = low.rate[i] ** 2 + 2.0 * disk.body.inv_M * (before - after)
    there = (left > 0.0) & (h < VERTICAL)
    seen = np.where(there, h, low.h)
    rate = np.sqrt(np.where(there, left, low.rate**2))
    high = low._replace(h=seen, rate=rate, z=1.0 - 0.5 * seen * seen)
    (one, status), (other, others) = (batch(orbit_batch, OrbitRow, disk, each, 1e-7) for each in (low, high))
    assert (status == Status.OK).all()
    assert (others == Status.OK).all()
    told = one.angle_error + other.angle_error
    assert (abs(one.chi - other.chi) <= told).all()
    assert (abs(one.psi - other.psi) <= told).all()
    assert (abs(one.time / other.time - 1.0) <= one.time_error + other.time_error).all()
    # Rules say that they know less.
    more, less = np.sort([one.angle_error, other.angle_error], axis=0)
    assert (there & (less > 5.0 * more)).sum() > 5


def test_the_time_to_the_flattest_moment_is_that_of_a_cosine_where_the_wobble_is_small():
    row = next(row for row in ROWS if row["swing"] == 0.0)
    disk, still = of_row(row)
    period = float(row["period"])
    # From the bottom it takes a quarter of a period on the way down, three on the way up.
    down, up = (
        batch(bounce_batch, BounceRow, disk, still._replace(rate=np.array([r])), 1e-9)[0] for r in (-1e-6, 1e-6)
    )
    assert down.first[0] == pytest.approx(0.25 * period, rel=1e-5)
    assert up.first[0] == pytest.approx(0.75 * period, rel=1e-5)
    assert batch(bounce_batch, BounceRow, disk, still, 1e-9)[0].first[0] <= period
