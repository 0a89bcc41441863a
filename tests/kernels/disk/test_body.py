"""The dimensionless constants of a disk."""

import math

import pytest

from kernels.disk.body import make_disk

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
