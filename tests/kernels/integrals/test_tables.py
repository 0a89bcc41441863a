"""Tables of what a passage needs of the body alone."""

import math
from itertools import pairwise

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels.disk import chaplygin, polynomials
from kernels.integrals import tables
from kernels.integrals.grades import grade_at
from kernels.integrals.tables import GRADES, Fixed

DISKS = {**BODIES, "rim": ex.Disk(I1=1e-4, I3=2e-4)}


@pytest.mark.parametrize("name", ["uniform", "thick", "rim"])
def test_the_low_series_are_those_of_the_whole_range(name):
    disk = DISKS[name]
    for S in np.linspace(1e-6, 0.5 * tables.HANDOVER**2, 20):
        whole = chaplygin.solutions(S, math.log(S), disk.body.c, disk.natural.series)
        t = 16.0 * S - 1.0
        low = disk.tables.low
        got = [polynomials.horner(row, t) for row in (low.rho_over_S, low.excess, low.inv_shape)]
        drho, inv_shape = 1.0 + S * got[1], 1.0 / math.sqrt(1.0 - 0.5 * S)
        assert (got[0], drho, got[2]) == pytest.approx((whole.rho_over_S, whole.drho, inv_shape), rel=1e-15)
        D = 0.5 * disk.body.c * S * got[0] * math.log(S) + polynomials.horner(low.v, t)
        assert pytest.approx(whole.D, rel=3e-15) == D


def test_short_series_are_those_of_the_whole_range_to_their_digits():
    disk = DISKS["uniform"]
    series = disk.tables.short
    for S in np.linspace(1e-6, 0.125, 20):
        whole = chaplygin.solutions(S, math.log(S), disk.body.c, disk.natural.series)
        rows, inv_shape = (series.rho_over_S, series.excess, series.inv_shape), 1.0 / math.sqrt(1.0 - 0.5 * S)
        g, excess, shape = (polynomials.horner(row, series.per_S * S - 1.0) for row in rows)
        found, wanted = (g, 1.0 + S * excess, shape), (whole.rho_over_S, whole.drho, inv_shape)
        assert found == pytest.approx(wanted, rel=1e-6)


def test_weights_of_time_sum_to_the_tilts_they_cover():
    of_body = BODIES["uniform"].tables
    for number in range(GRADES):
        grade = grade_at(of_body, number)
        outer, fall = Fixed(*grade.outer[:8]), Fixed(*grade.fall[:8])
        assert outer.time.sum() == pytest.approx(0.5 * math.pi - 2.0 * math.asin(0.5 * tables.HANDOVER), rel=1e-14)
        assert fall.time.sum() == pytest.approx(0.5 * math.pi, rel=1e-14)
        assert grade.inner[tables.WEIGHT].sum() == pytest.approx(1.0, rel=1e-14)


def test_a_finer_grade_has_more_nodes_and_leaves_less_out():
    grades = [grade_at(BODIES["hoop"].tables, number) for number in range(GRADES)]
    assert len(grades) == len(tables.TARGETS) == 11
    for coarse, fine in pairwise(grades):
        assert all(a.shape[1] <= b.shape[1] for a, b in zip(coarse[:3], fine[:3], strict=True))
        assert sum(a.shape[1] for a in coarse[:3]) < sum(b.shape[1] for b in fine[:3])
        assert coarse.limits.depth < fine.limits.depth
        assert coarse.limits.missed > fine.limits.missed
    assert 5 * grades[1].inner.shape[1] <= grades[-1].inner.shape[1]


def test_a_short_rule_is_trusted_less_where_kappa_is_large():
    missed = [grade_at(ex.Disk(I1=I1, I3=I1).tables, 1).limits.missed for I1 in (1.0, 0.02, 1e-4)]
    assert missed[0] < 0.01 < missed[2]
    assert missed[0] < missed[1] < missed[2]
