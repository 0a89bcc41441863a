"""Passages by tables against adaptive quadrature, sample by sample, ordinary and hostile."""

import math
import re

import numba
import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels._jit import numba_type
from kernels.disk import chaplygin, elementary, polynomials
from kernels.disk.body import Body
from kernels.integrals import passages, tables, tabulated
from kernels.integrals.point import VERTICAL
from kernels.integrals.tables import Low
from kernels.types import Matrix, Vector

EXTREME_BODIES = {
    "rim": ex.Disk(I1=1e-4, I3=2e-4),
    "massive-core": ex.Disk(I1=1e3, I3=2e3),
    "thin-axis": ex.Disk(I1=0.4, I3=4e-4),
}
ALL = {**BODIES, **EXTREME_BODIES}


def batch(disk, sigma3_bar, eta_hat, speed, accuracy, by_tables):
    """out and status; without tables by asking for a window one rounding below the vertical."""
    n = sigma3_bar.size
    out, status = np.empty((8, n)), np.zeros(n, np.int8)
    eta = eta_hat * disk.body.I3 * disk.body.r0
    h_end = VERTICAL if by_tables else math.nextafter(VERTICAL, 0.0)
    crossings = passages.Crossings(sigma3_bar, eta, speed)
    passages.passage_batch(crossings, h_end, accuracy, disk.quadrature, disk.natural, out, status)
    return out, status


def draw(rng, n, wild):
    sign = rng.choice([-1.0, 1.0], n)
    eta_hat = sign * 10.0 ** rng.uniform(-12 if wild else -8, 0, n)
    if wild:
        return 10.0 ** rng.uniform(-3, 3, n) * rng.choice([-1.0, 1.0], n), eta_hat, 10.0 ** rng.uniform(-2, 3, n)
    return rng.uniform(-2, 2, n), eta_hat, rng.uniform(0.3, 3, n)


@pytest.mark.parametrize("wild", [False, True], ids=["ordinary", "wild"])
@pytest.mark.parametrize("name", ALL)
def test_tables_and_adaptive_quadrature_agree_within_their_stated_errors(name, wild):
    samples = draw(np.random.default_rng(3), 3000, wild)
    for accuracy in (1e-11, 1e-6):
        fast, fast_status = batch(ALL[name], *samples, accuracy, True)
        slow, slow_status = batch(ALL[name], *samples, accuracy, False)
        # Where an estimate lies next to the accuracy asked, one may give it and the other not.
        assert np.mean(fast_status != slow_status) < 0.02
        ok = (fast_status == 0) & (slow_status == 0)
        angle = np.fmax(abs(fast[1] - slow[1]), abs(fast[2] - slow[2]))[ok]
        scale = np.fmax(abs(fast[3] / slow[3] - 1), abs(fast[0] / slow[0] - 1))[ok]
        assert (angle <= 10 * (fast[5] + slow[5])[ok] + 1e-13).all()
        assert (scale <= 10 * (fast[6] + slow[6])[ok] + 1e-13).all()
        assert (fast[5:7][:, ok] >= 0.0).all()
        assert (slow[5:7][:, ok] >= 0.0).all()
        assert (np.sign(fast[7][ok]) == np.sign(slow[7][ok])).all()


@pytest.mark.parametrize("name", ["uniform", "hoop", "matching"])
def test_ordinary_passages_are_all_left_to_the_tables(name):
    rng = np.random.default_rng(4)
    disk, n = BODIES[name], 20_000
    s3, speed = rng.uniform(-2, 2, n), rng.uniform(0.5, 2, n)
    eta_hat = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-280, -2, n)
    fast = batch(disk, s3, eta_hat, speed, 1e-11, True)[0]
    slow = batch(disk, s3[:500], eta_hat[:500], speed[:500], 1e-11, False)[0]
    assert not (fast[5, :500] == slow[5]).any()  # estimates of two kinds
    assert (fast[5] <= 1e-11 * np.fmax(1.0, abs(fast[1]))).all()


def test_a_sample_does_not_depend_on_its_neighbours_or_its_lane():
    rng = np.random.default_rng(5)
    samples = draw(rng, 999, True)
    out, status = batch(BODIES["uniform"], *samples, 1e-9, True)
    order = rng.permutation(999)
    again, again_status = batch(BODIES["uniform"], *(column[order] for column in samples), 1e-9, True)
    assert np.array_equal(again, out[:, order], equal_nan=True)
    assert np.array_equal(again_status, status[order])
    one = batch(BODIES["uniform"], *(column[17:18] for column in samples), 1e-9, True)[0]
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


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "coin"])
def test_falls_by_tables_and_by_one_rule_agree(name):
    disk, n = BODIES[name], 2000
    rng = np.random.default_rng(7)
    b = disk.body
    s3, speed = rng.uniform(-3, 3, n), rng.uniform(0.05, 3, n)
    sigma4 = b.dr0 * s3 / (b.k * b.r0)
    energy = 0.5 * (b.M * speed**2 + b.I1 * s3**2 + b.J * sigma4**2) + 1.0
    found = []
    for h_end in (VERTICAL, math.nextafter(VERTICAL, 0.0)):
        out = np.empty((4, n))
        passages.fall_batch(s3, energy, h_end, disk.quadrature, disk.natural, out)
        found.append(out)
    allowed = 10 * (found[0][3] + found[1][3]) + 1e-13
    assert (abs(found[0][:3] - found[1][:3]) <= allowed).all()
    assert (found[0][3] <= 1e-9).all()


def test_the_elementary_functions_are_at_rounding():
    d = np.linspace(0.0, elementary.DEEPEST, 500)
    got = [elementary.exp_fall(x) for x in d]
    np.testing.assert_allclose(got, np.exp(-d), rtol=8e-15)
    s = np.linspace(-1 / 3, 1 / 3, 501)
    np.testing.assert_allclose(
        [elementary.log_ratio(x) for x in s], np.log1p(s) - np.log1p(-s), rtol=1e-14, atol=0
    )
    x = np.linspace(0.0, 0.44, 200)
    np.testing.assert_allclose([elementary.arctan(v) for v in x], np.arctan(x), rtol=4e-16, atol=0)


@pytest.mark.parametrize("name", ["uniform", "thick", "rim"])
def test_the_low_series_are_those_of_the_whole_range(name):
    disk = ALL[name]
    for S in np.linspace(1e-6, 0.5 * tables.HANDOVER**2, 20):
        whole = chaplygin.solutions(S, math.log(S), disk.body.c, disk.natural.series)
        t = 16.0 * S - 1.0
        low = disk.quadrature.tables.low
        got = [polynomials.horner(row, t) for row in (low.rho_over_S, low.drho)]
        assert got == pytest.approx([whole.rho_over_S, whole.drho], rel=1e-15)
        D = 0.5 * disk.body.c * S * got[0] * math.log(S) + polynomials.horner(low.v, t)
        assert pytest.approx(whole.D, rel=3e-15) == D


def test_the_lanes_are_really_vectorised():
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Matrix, Body, Low)))
    options = tabulated.near_panel.targetoptions
    fresh = numba.njit(signature, fastmath=options["fastmath"], error_model="numpy")(tabulated.near_panel.py_func)
    (assembly,) = fresh.inspect_asm().values()
    found = re.findall(r"^\s+v?f?n?m?(?:add|sub|mul)\w*(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 10 * found.count("sd")
