"""The disk's dimensionless constants and its Chaplygin series, computed once and passed to every kernel."""

import math
from typing import NamedTuple

from kernels.disk.chaplygin import Series, make_series


class Body(NamedTuple):
    """Constants of one disk in natural units (m = r = g = 1); all dimensionless."""

    I1: float
    I3: float
    M: float
    J: float
    kappa: float
    c: float
    inv_kappa2: float  # I1 / M
    J_over_M: float
    inv_M: float  # m g r / M
    inv_J: float  # m r^2 / J
    k: float  # I3 / I1
    r0: float  # r(0)
    dr0: float  # r'(0)


class NaturalDisk(NamedTuple):
    """What kernels know of a disk: its constants, and Chaplygin's series.

    Made by :func:`make_disk`, which does not validate: ``explorer.Disk`` does.
    """

    body: Body
    series: Series


def make_disk(I1: float, I3: float) -> NaturalDisk:
    """The disk with the moments of inertia I1/(m r^2) and I3/(m r^2)."""
    M, J = I1 + 1.0, I3 + 1.0
    c = I3 / (J * I1)
    series, r0, dr0 = make_series(c)
    body = Body(
        I1=I1,
        I3=I3,
        M=M,
        J=J,
        kappa=math.sqrt(M / I1),
        c=c,
        inv_kappa2=I1 / M,
        J_over_M=J / M,
        inv_M=1.0 / M,
        inv_J=1.0 / J,
        k=I3 / I1,
        r0=r0,
        dr0=dr0,
    )
    return NaturalDisk(body, series)
