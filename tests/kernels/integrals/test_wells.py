"""The well of a motion: its series, its bottom and its turning points. Whole wells are tested with `wobbles`."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels.integrals import nodes, wells
from kernels.integrals.point import Point, point_batch

TERMS = 30


def points(disk, h, X, Y):
    out = np.empty((7, len(h)))
    point_batch(np.asarray(h), X, Y, disk.natural, out)
    return Point(*out)


def with_levels(*coefficients):
    """A work array that holds V by its powers, from the first on."""
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    W[wells.LEVEL + 1 : wells.LEVEL + 1 + len(coefficients)] = coefficients
    return W


def level(W, x):
    return wells.value(W, wells.LEVEL, wells.LEVEL + TERMS, x)


@pytest.mark.parametrize(("name", "tilt"), [("uniform", 0.3), ("hoop", 1e-5), ("thick", 1.3)])
def test_the_series_are_the_motion_at_other_tilts(name, tilt):
    disk, b = BODIES[name], BODIES[name].body
    known = ex.constants(ex.steady_motions(disk, tilt, 1.4 / math.sqrt(tilt)).states)
    X, Y = known.sigma3_bar[0] / b.r0, known.eta_hat_plus[0] * b.k * b.r0
    x = np.linspace(-0.3, 0.2, 6)
    h = 2.0 * np.sin(np.arctan(math.tan(0.5 * tilt) * np.exp(x)))
    (here,) = (points(disk, [2.0 * math.sin(0.5 * tilt)], X, Y),)
    there = points(disk, h, X, Y)
    W = with_levels()
    W[wells.Q], W[wells.Z] = math.sin(tilt), math.cos(tilt)
    W[wells.RHO], W[wells.SIGMA4] = here.ratio[0], here.sigma4[0]
    wells.expand(W, TERMS, b)
    for row, expected in (
        (wells.Q, h * there.shape),
        (wells.Z, 1.0 - there.S),
        (wells.RHO, there.ratio),
        (wells.SIGMA4, there.sigma4),
        (wells.LEVEL, there.V - here.V[0]),
    ):
        found = [wells.value(W, row, row + TERMS, at) for at in x]
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13 * abs(expected).max())
    slope, _ = wells.slope_and_bend(W, TERMS, 0.0)
    assert slope == pytest.approx(here.slope[0] * here.shape[0] ** 2, abs=1e-12 * abs(there.V).max())


def test_the_bottom_is_where_v_is_least_on_the_way_down():
    assert wells.bottom(with_levels(0.0, 1.0), TERMS) == 0.0
    # V = (x - a)^2 but for a constant; no shift is too small.
    for a in (0.3, -0.3, 1e-8, -1e-200):
        assert wells.bottom(with_levels(-2.0 * a, 1.0), TERMS) == pytest.approx(a, rel=1e-15)
    # V' = (x + 0.1)(x - 0.1)(x - 0.2): from between the first two it leads down to the second.
    assert wells.bottom(with_levels(-0.002 * -1.0, -0.005, -0.2 / 3.0, 0.25), TERMS) == pytest.approx(
        -0.1, rel=1e-14
    )
    assert math.isnan(wells.bottom(with_levels(1.0, 0.01), TERMS))


@pytest.mark.parametrize("height", [1e-300, 1e-40, 1e-6, 0.01])
def test_turning_points_leave_a_share_without_roots(height):
    """V - height = (x - inner)(x - outer) share, at every x and however low the wobble."""
    W = with_levels(0.0, 1.0, -0.7, 0.9, 0.2)
    inner, outer = -wells.turning(W, TERMS, height, -1.0), wells.turning(W, TERMS, height, 1.0)
    assert inner < 0.0 < outer
    for end in (inner, outer):
        assert level(W, end) == pytest.approx(height, rel=1e-14)
    wells.divide(W, TERMS, inner, outer)
    for x in (*np.linspace(inner, outer, 5)[1:-1], 0.3):
        share = wells.value(W, wells.SHARE, wells.SHARE + TERMS - 2, x)
        assert (x - inner) * (x - outer) * share == pytest.approx(level(W, x) - height, rel=1e-12)


def test_without_any_height_the_share_is_half_the_second_derivative():
    W = with_levels(0.0, 1.3, -0.7, 0.9)
    assert wells.turning(W, TERMS, 0.0, 1.0) == 0.0
    wells.divide(W, TERMS, 0.0, 0.0)
    assert W[wells.SHARE] == 1.3
    assert wells.value(W, wells.SHARE, wells.SHARE + TERMS - 2, 0.1) == pytest.approx(
        level(W, 0.1) / 0.01, rel=1e-14
    )


def test_beyond_a_barrier_there_is_no_turning_point():
    """V = x^2 - x^3 has its barrier at 2/3, 4/27 above the bottom."""
    W = with_levels(0.0, 1.0, -1.0)
    assert wells.turning(W, TERMS, 0.14, 1.0) < 2.0 / 3.0
    assert math.isnan(wells.turning(W, TERMS, 0.15, 1.0))
    assert wells.turning(W, TERMS, 0.15, -1.0) > 0.0
    # Beyond WIDEST the series are not to be trusted.
    assert math.isnan(wells.turning(with_levels(0.0, 1.0), TERMS, 9.0, 1.0))


@pytest.mark.parametrize("last", [1e-9, -1e-9])
def test_beyond_its_series_a_low_well_has_no_turning_point(last):
    """A parabola as low as this ends far beyond WIDEST, where the last terms of the series are all there is."""
    W = with_levels(0.0, 9e-4, *[0.0] * (TERMS - 3), last)
    for way in (1.0, -1.0):
        assert math.isnan(wells.turning(W, TERMS, 1.36, way))
    # V' = -1e-3 - 0.5 x^2 + 12 x^5: its slope falls first, and the bottom is beyond.
    W = with_levels(-1e-3, 0.0, -0.5 / 3.0, 0.0, 0.0, 2.0)
    slope, bend = wells.slope_and_bend(W, TERMS, wells.bottom(W, TERMS))
    assert abs(slope) < 1e-14
    assert bend > 0.0
