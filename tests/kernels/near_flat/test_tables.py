"""Tables of what a passage needs of the body alone."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels.disk import chaplygin, polynomials
from kernels.near_flat import tables
from kernels.near_flat.tables import Fixed


@pytest.mark.parametrize("name", ["uniform", "thick"])
def test_the_low_series_are_those_of_the_whole_range(name):
    disk = BODIES[name]
    for S in np.linspace(1e-6, 0.5 * tables.HANDOVER**2, 20):
        whole = chaplygin.solutions(S, math.log(S), disk.body.c, disk.natural.series)
        t = 16.0 * S - 1.0
        low = disk.tables[0].low
        got = [polynomials.horner(row, t) for row in (low.rho_over_S, low.excess, low.inv_shape)]
        drho, inv_shape = 1.0 + S * got[1], 1.0 / math.sqrt(1.0 - 0.5 * S)
        assert (got[0], drho, got[2]) == pytest.approx((whole.rho_over_S, whole.drho, inv_shape), rel=1e-15)
        D = 0.5 * disk.body.c * S * got[0] * math.log(S) + polynomials.horner(low.v, t)
        assert pytest.approx(whole.D, rel=3e-15) == D


@pytest.mark.parametrize("fine", [0, 1])
def test_weights_of_time_sum_to_the_tilts_they_cover(fine):
    rules = BODIES["uniform"].tables[fine].rules
    outer, fall = Fixed(*rules.outer[:8]), Fixed(*rules.fall[:8])
    assert outer.time.sum() == pytest.approx(0.5 * math.pi - 2.0 * math.asin(0.5 * tables.HANDOVER), rel=1e-14)
    assert fall.time.sum() == pytest.approx(0.5 * math.pi, rel=1e-14)
    assert rules.inner[tables.WEIGHT].sum() == pytest.approx(1.0, rel=1e-14)


def test_a_slender_body_goes_without_tables():
    assert ex.Disk(I1=0.9 * tables.LEAST_I1, I3=0.05).tables == ()
    assert len(ex.Disk(I1=tables.LEAST_I1, I3=0.05).tables) == 2
