"""Motions put together from arcs are those that rules, tables, legs and series find."""

import numpy as np
import pytest
from motions_by_arcs import between, orbits_of, searched
from mpmath import mp, mpf

import explorer as ex
from kernels.arcs import exponentials
from kernels.arcs.potential import make_chart
from kernels.arcs.turning_points import Place, Starts, inward_batch


def half_passage(disk, sigma3_bar, eta_hat, speed, accuracy):
    """(tilt at the turning point, half of the passage from the vertical), natural units."""
    b, chart = disk.body, make_chart(disk.natural)
    X, Y, none = np.array([sigma3_bar / b.r0]), np.array([b.k * b.r0 * eta_hat]), np.zeros(1)
    K, sigma4 = np.array([0.5 * b.M * speed * speed]), (X * b.dr0 - Y / b.r0) / b.k
    start = Starts(X, Y, K, none + 1.0, none, X * b.r0, sigma4)
    turn = searched(inward_batch, start, chart)
    bend = b.M * (X * b.r0) ** 2 + b.J * b.k * sigma4**2 - 1.0
    top = Place(none, none + 1.0, none, X * b.r0, sigma4, K, b.J * X * b.r0 * sigma4, bend, none, none * np.nan)
    return 2.0 * np.arctan(turn.r[0]), between(X, Y, turn.d, turn, top, turn.crest, accuracy, chart)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-11])
def test_passages_agree_with_25_digits(reference_passages, accuracy):
    for row in reference_passages:
        disk = ex.Disk(m=row["m"], r=row["r"], g=row["g"], I1=row["I1"], I3=row["I3"])
        unit = disk.rate_unit
        start = row["sigma3_bar"] / unit, row["eta_hat"] / unit, row["phidot"] / unit
        theta, half = half_passage(disk, *start, accuracy)
        assert theta == pytest.approx(row["theta_min"], rel=1e-13, abs=0.0)
        off = abs(2.0 * half.chi[0] - row["delta_chi"])
        assert off <= max(accuracy, 1e-13 * abs(row["delta_chi"]))
        assert 2.0 * half.time[0] / unit == pytest.approx(row["duration"], rel=max(accuracy, 1e-13))


def test_periods_and_smallest_tilts_agree_with_today_s(body):
    random = np.random.default_rng(5)
    phi, phidot, sigma3, sigma4 = random.uniform(-1.2, 1.2, (4, 300))
    unit = body.rate_unit
    states = ex.phi_to_states(body, phi, phidot * unit, sigma3 * unit, sigma4 * unit)
    known = ex.periods(states, accuracy=1e-9)
    found, rows, status = orbits_of(states, 1e-9)
    good = known.status[rows] == 0
    assert np.array_equal(status == 0, known.status != ex.Status.FALLS)
    period = 2.0 * (found.here.time + np.nan_to_num(found.there.time)) * body.time_unit
    chi = 2.0 * (found.here.chi + np.nan_to_num(found.there.chi))
    theta = np.fmin(found.theta_here, found.theta_there)
    assert np.array_equal(found.crosses[good], known.crosses[rows][good])
    assert np.allclose(period[good], known.period[rows][good], rtol=4e-9, atol=0.0)
    assert np.allclose(chi[good], known.chi[rows][good], rtol=0.0, atol=4e-9)
    assert np.allclose(theta[good], known.theta_min[rows][good], rtol=1e-8, atol=0.0)


@pytest.mark.parametrize("x", [-600.0, -40.0, -0.3, -1e-9, 1e-300, 1e-17, 0.2, 3.0, 600.0])
def test_the_exponential_is_right_to_rounding_with_and_without_one(x):
    power, grown = exponentials.exponential(x)
    assert power == pytest.approx(float(mp.exp(mpf(x))), rel=5e-16, abs=0.0)
    assert grown == pytest.approx(float(mp.expm1(mpf(x))), rel=5e-16, abs=0.0)


@pytest.mark.parametrize("x", [1e-300, 0.1, 0.7, 0.999, 1.0, 1.4143, 3e200])
def test_the_logarithm_is_right_to_rounding(x):
    assert exponentials.logarithm(x) == pytest.approx(float(mp.log(mpf(x))), rel=5e-16, abs=1e-17)
