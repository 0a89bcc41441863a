"""Passages and falls by tables against arcs, sample by sample, ordinary and hostile."""

import re

import numba
import numpy as np
import pytest
from conftest import BODIES
from passing import batch, draw

import explorer as ex
from explorer.motion.fall_integrals import departures_of_moving, falls_as_arcs
from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.near_flat import passages
from kernels.near_flat.tables import Low, Rules
from kernels.types import Vector

ALL = {
    **BODIES,
    "slightest": ex.Disk(I1=0.05, I3=0.1),
    "massive-core": ex.Disk(I1=1e3, I3=2e3),
    "thin-axis": ex.Disk(I1=0.4, I3=4e-4),
}


@pytest.mark.parametrize("wild", [False, True], ids=["ordinary", "wild"])
@pytest.mark.parametrize("name", ALL)
def test_tables_and_arcs_agree_within_their_stated_errors(name, wild):
    samples = draw(np.random.default_rng(3), 3000, wild)
    for accuracy in (1e-11, 1e-6):
        fast, fast_status = batch(ALL[name], *samples, accuracy, True)
        slow, slow_status = batch(ALL[name], *samples, accuracy, False)
        # Where an estimate lies next to the accuracy asked, one may give it and the other not.
        assert np.mean(fast_status != slow_status) < 0.02
        ok = (fast_status == 0) & (slow_status == 0)
        angle = np.fmax(abs(fast[1] - slow[1]), abs(fast[2] - slow[2]))[ok]
        scale = np.fmax(abs(fast[3] / slow[3] - 1), abs(fast[0] / slow[0] - 1))[ok]
        assert (angle <= 3 * (fast[5] + slow[5])[ok]).all()
        assert (scale <= 3 * (fast[6] + slow[6])[ok] + 1e-14).all()
        assert (np.sign(fast[7][ok]) == np.sign(slow[7][ok])).all()


@pytest.mark.parametrize("accuracy", [1e-11, 1e-9, 1e-6, 1e-3])
def test_far_from_f_tables_know_where_they_do_not_serve(accuracy):
    """There and with little I3 the turning point is far from the law of first order."""
    rng = np.random.default_rng(8)
    for share in (0.06, 0.12, 0.2755, 0.4):
        disk = ex.Disk(I1=0.25, I3=0.25 * share)
        eta_hat = rng.uniform(0.5, 2.0, 5000) * rng.choice([-1.0, 1.0], 5000)
        samples = rng.uniform(-2, 2, 5000), eta_hat, rng.uniform(0.3, 3, 5000)
        fast, fast_status = batch(disk, *samples, accuracy, True)
        exact, exact_status = batch(disk, *samples, 1e-11, False)
        ok = (fast_status == 0) & (exact_status == 0)
        errors = fast[:, ok] - exact[:, ok]
        wrong = np.max([abs(errors[1]), abs(errors[2]), abs(errors[3] / exact[3, ok])], axis=0)
        estimate = np.fmax(fast[5], fast[6])[ok]
        assert (wrong <= 3 * estimate + 1e-12).all(), share
        assert (wrong <= accuracy + 64 * 2.2e-16 * (abs(exact[1]) + abs(exact[2]))[ok]).all(), share


@pytest.mark.parametrize(("accuracy", "least"), [(1e-11, 0.999), (1e-6, 0.96)])
@pytest.mark.parametrize("name", ["uniform", "hoop", "matching"])
def test_ordinary_passages_are_left_to_the_tables(name, accuracy, least):
    """Of the first tables that are asked: the others serve what is left."""
    rng = np.random.default_rng(4)
    disk, n, out = BODIES[name], 20_000, np.empty((8, 20_000))
    s3, speed = rng.uniform(-2, 2, n), rng.uniform(0.5, 2, n)
    eta_hat = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-280, -2, n)
    crossings = passages.Crossings(s3, eta_hat * disk.body.I3 * disk.body.r0, speed)
    passages.passage_batch(crossings, disk.tables[0 if accuracy == 1e-6 else 1], disk.natural, out)
    assert (np.maximum(out[5], out[6]) <= accuracy * np.fmax(1.0, abs(out[1]))).mean() > least


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_falls_by_tables_and_as_arcs_agree(name):
    disk, n = BODIES[name], 2000
    rng = np.random.default_rng(7)
    s3, kinetic = rng.uniform(-3, 3, n), 0.5 * disk.body.M * rng.uniform(0.05, 3, n) ** 2
    departures = departures_of_moving(disk, s3, np.zeros(n), kinetic, kinetic)
    arcs = falls_as_arcs(disk, departures, np.arange(n), 0.0, 1e-13)
    assert (arcs[3] <= 1e-9).all()
    for tables in disk.tables:
        found = np.empty((4, n))
        passages.fall_batch(departures, tables, disk.natural, found)
        served = np.isfinite(found[3])
        assert served.mean() > 0.8
        assert (abs(found[:3] - arcs[:3]) <= 3 * (found[3] + arcs[3]))[:, served].all()


@pytest.mark.parametrize("accuracy", [1e-9, 1e-6])
def test_a_sample_does_not_depend_on_its_neighbours_or_its_lane(accuracy):
    rng = np.random.default_rng(5)
    samples = draw(rng, 999, True)
    out, status = batch(BODIES["uniform"], *samples, accuracy, True)
    order = rng.permutation(999)
    again, again_status = batch(BODIES["uniform"], *(column[order] for column in samples), accuracy, True)
    assert np.array_equal(again, out[:, order], equal_nan=True)
    assert np.array_equal(again_status, status[order])
    one = batch(BODIES["uniform"], *(column[17:18] for column in samples), accuracy, True)[0]
    assert np.array_equal(one[:, 0], out[:, 17], equal_nan=True)


def test_bad_neighbours_change_nothing():
    samples = [np.ascontiguousarray(column) for column in draw(np.random.default_rng(6), 64, False)]
    disk = BODIES["hoop"]
    good, _ = batch(disk, *samples, 1e-9, True)
    for column, value in zip(samples, (1e200, 1e300, 1e160), strict=True):
        spoiled = [c.copy() for c in samples]
        spoiled[[c is column for c in samples].index(True)][::7] = value
        out, status = batch(disk, *spoiled, 1e-9, True)
        rest = np.arange(64) % 7 != 0
        assert np.array_equal(out[:, rest], good[:, rest])
        assert (status[~rest] != 0).all() or np.isfinite(out[:, ~rest]).all()


def test_samples_on_f_fall():
    disk, one = BODIES["uniform"], np.ones(4)
    found = ex.passages(disk, one, [1e-3, 0.0, np.nan, 0.0], one)
    assert found.status.tolist() == [ex.Status.OK, ex.Status.FALLS, ex.Status.BAD_INPUT, ex.Status.FALLS]
    assert np.isnan(found.delta_chi).tolist() == [False, True, True, True]


def test_a_window_that_the_motion_does_not_reach_is_bad_input():
    found = ex.passages(BODIES["uniform"], 1.0, 2.0, 1.0, window=1e-3)
    assert found.status == ex.Status.BAD_INPUT
    assert np.isnan(found.delta_chi)


def test_the_lanes_are_really_vectorised():
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Rules, Body, Low)))
    options = passages.near_panel.targetoptions
    fresh = numba.njit(signature, fastmath=options["fastmath"], error_model="numpy")(passages.near_panel.py_func)
    (assembly,) = fresh.inspect_asm().values()
    found = re.findall(r"^\s+v?f?n?m?(?:add|sub|mul)\w*(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 10 * found.count("sd")
