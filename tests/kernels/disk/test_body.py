"""The dimensionless constants of a disk."""

import math

import mpmath as mp
import numpy as np
import pytest

from kernels.disk.body import make_disk, make_upright
from kernels.disk.chaplygin import solutions
from kernels.integrals.point import VERTICAL, point

# I1, I3, kappa, r(0), r'(0) of the disks of the paper (mathematics of section 5.2, eqs 5.11, 5.12).
DISKS = {
    "uniform": (1 / 4, 1 / 2, math.sqrt(5), 1.4690645964539924, 2.1406983534237100),
    "hoop": (1 / 2, 1.0, math.sqrt(3), 1.3399836124079462, 1.8121040956130957),
    "matching": (1 / 3, 2 / 3, 2.0, 1.4164294327681471, 2.0055031816314819),
}


@pytest.mark.parametrize("name", DISKS)
def test_a_disk_has_the_race_number_and_the_values_at_the_vertical_of_the_paper(name):
    I1, I3, *expected = DISKS[name]
    b = make_disk(I1, I3).body
    assert (b.kappa, b.r0, b.dr0) == pytest.approx(tuple(expected), rel=1e-15)


def test_a_disk_without_axial_inertia_has_solutions_without_a_logarithm():
    """c = 0: rho = S and D = 1 - S."""
    disk = make_disk(0.3, 0.0)
    assert (disk.body.c, disk.body.r0, disk.body.dr0) == (0.0, 1.0, 1.0)


@pytest.mark.parametrize("name", DISKS)
def test_told_from_the_vertical_the_potential_of_a_motion_is_less_by_a_constant(name):
    """That is the part by sigma4 there; tilts, slopes and sigma4 are the same."""
    disk = make_disk(*DISKS[name][:2])
    upright, b = make_upright(disk), disk.body
    X, Y = 0.7, -0.2
    spin, flat = (X * b.dr0 - Y / b.r0) / b.k, X / b.k
    for h in (1e-3, 0.3, 1.0, VERTICAL):
        one, other = point(h, X, Y, disk), point(h, X, Y, upright)
        below = 0.5 * b.J * (spin**2 - flat**2)
        assert one.V - below == pytest.approx(other.V, rel=1e-12)
        assert (one.ratio, one.sigma4, one.slope) == pytest.approx(
            (other.ratio, other.sigma4, other.slope), rel=1e-12
        )
    assert pytest.approx(0.5 * b.I1 * (X * b.r0) ** 2 + 1.0, rel=1e-14) == other.V


@pytest.mark.parametrize("I3", [0.1, 1e-4, 1e-8])
def test_told_from_the_vertical_both_solutions_keep_their_digits_however_little_i3_is(I3):
    """rho' - r'(0) and D' + 1/r(0) are of the order of I3; by mpmath's hypergeometric functions."""
    disk, upright = make_disk(0.25, I3), make_upright(make_disk(0.25, I3))
    c, (excess, anchor) = disk.body.c, (upright.series[4], upright.body.anchor)
    with mp.workdps(40):
        exact = mp.mpf(I3) / (1 + mp.mpf(I3)) / mp.mpf(0.25)
        root = mp.sqrt(1 - 4 * exact)

        def drho(S):
            return mp.hyp2f1((1 + root) / 2, (1 - root) / 2, 1, S / 2).real

        dr0 = drho(mp.mpf(1))
        r0 = mp.hyp2f1((1 + root) / 2, (1 - root) / 2, 2, mp.mpf(1) / 2).real
        for S in (1e-4, 0.3, 0.9, 1.0):
            dD = 1 / r0 - (drho(2 - mp.mpf(S)) + drho(mp.mpf(S))) / (2 * r0 * dr0)
            got = solutions(S, math.log(S), c, upright.series)
            assert got.dD == pytest.approx(float(dD), rel=1e-14, abs=1e-15 * c)
            rise = S * np.polynomial.polynomial.polyval(2.0 * S - 1.0, excess) - anchor.excess
            assert rise == pytest.approx(float(drho(mp.mpf(S)) - dr0), rel=1e-14, abs=1e-15 * c)
    assert (anchor.drho, anchor.dD) == (disk.body.dr0, -1.0 / disk.body.r0)
