"""Tables of what a passage needs of the body alone."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels.disk import chaplygin, polynomials
from kernels.integrals import tables
from kernels.integrals.tables import Fixed, fixed

DISKS = {**BODIES, "rim": ex.Disk(I1=1e-4, I3=2e-4)}


@pytest.mark.parametrize("name", ["uniform", "thick", "rim"])
def test_the_low_series_are_those_of_the_whole_range(name):
    disk = DISKS[name]
    for S in np.linspace(1e-6, 0.5 * tables.HANDOVER**2, 20):
        whole = chaplygin.solutions(S, math.log(S), disk.body.c, disk.natural.series)
        t = 16.0 * S - 1.0
        low = disk.tables.low
        got = [polynomials.horner(row, t) for row in (low.rho_over_S, low.drho)]
        assert got == pytest.approx([whole.rho_over_S, whole.drho], rel=1e-15)
        D = 0.5 * disk.body.c * S * got[0] * math.log(S) + polynomials.horner(low.v, t)
        assert pytest.approx(whole.D, rel=3e-15) == D


def test_weights_of_time_sum_to_the_tilts_they_cover():
    of_body = BODIES["uniform"].tables
    for grade in (of_body.coarse, of_body.middle, of_body.fine):
        outer, fall = Fixed(*grade.outer[:8]), Fixed(*grade.fall[:8])
        assert outer.time.sum() == pytest.approx(0.5 * math.pi - 2.0 * math.asin(0.5 * tables.HANDOVER), rel=1e-14)
        assert fall.time.sum() == pytest.approx(0.5 * math.pi, rel=1e-14)
        assert grade.inner[tables.WEIGHT].sum() == pytest.approx(1.0, rel=1e-14)


def test_a_coarse_grade_has_a_fifth_of_the_nodes_that_cost_most_and_half_of_the_others():
    of_body = BODIES["hoop"].tables
    assert 5 * of_body.coarse.inner.shape[1] <= of_body.fine.inner.shape[1]
    assert 2 * of_body.coarse.outer.shape[1] <= of_body.fine.outer.shape[1]
    assert of_body.coarse.limits.rounds < of_body.middle.limits.rounds < of_body.fine.limits.rounds


def test_a_short_rule_is_trusted_less_where_kappa_is_large():
    missed = [ex.Disk(I1=I1, I3=I1).tables.coarse.limits.missed for I1 in (1.0, 0.02, 1e-4)]
    assert missed[0] < 0.01 < missed[2]
    assert missed[0] < missed[1] < missed[2]


def test_a_node_is_read_by_the_names_of_its_rows():
    table = BODIES["thick"].tables.fine.outer
    assert fixed(table, 3) == tuple(table[:8, 3])
