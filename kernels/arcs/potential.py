"""The potential along a motion, only ever as its difference from an end of an arc: no digit of E - V is lost.

With x = ln tan(theta/2) on the nearer face and the time s of the blown-up field, dt = q ds (`disk.field`),

    dx/ds = p,    M p^2 / 2 = K(x) = E - V(x),    V = I1 ratio^2 / 2 + J sigma4^2 / 2 + q,    ratio = sigma3/q

Flat is x = -inf, the vertical x = 0. K at a distance d from an end is K there less V - V_end, and that difference
is made of products:

    V - V_end = I1 d_ratio (ratio + ratio_end) / 2 + J d_sigma4 (sigma4 + sigma4_end) / 2 + d_q

Differences of Chaplygin's polynomials P are P[S, S_end] (S - S_end): one Horner scheme gives the coefficients of
the divided difference at the end, a second one its value at a point. An end carries sigma3 and sigma4 as they were
given, or as they were found from another end. Along arcs this file alone evaluates V; a body with thickness would
change it, and in `turning_points` the bound of V'' and the shape of the wall at flat.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import device, subroutine
from kernels.disk import chaplygin
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.elementary import exponential, log_ratio, logarithm
from kernels.disk.polynomials import economise
from kernels.records import reader
from kernels.types import Matrix, Vector

LANES = 16
DEGREE = chaplygin.DEGREE
DIVIDED = 4 * DEGREE  # coefficients of the divided differences of four polynomials
_LN2 = math.log(2.0)


class ArcDisk(NamedTuple):
    """A body as arcs need it.

    series: (4, DEGREE + 1) ascending powers of 2S - 1 of rho/S, rho' - 1, v and v' - v'(0). All change by what is
    of the order of c, so that differences can be divided by k however small I3 is.
    """

    body: Body
    series: Matrix


class FaceMotion(NamedTuple):
    """A motion on one face: sigma3 = X rho + Y D, k sigma4 = X rho' + Y D' with the sigma4 of that face."""

    X: float
    Y: float


class End(NamedTuple):
    """A point of a motion from which differences are taken: the state, and the solutions there.

    r: tan(theta/2); w: 1 - r^2, with all its digits beside the vertical; inv: 1/(1 + r^2).
    """

    r: float
    w: float
    sigma3: float
    sigma4: float
    S: float
    log_S: float
    inv: float
    q: float
    inv_q: float
    rho_over_S: float
    inv_g: float
    drho: float
    D: float
    ratio: float


# Rows of a work array that hold the ends of a group: records, then the coefficients of the divided differences.
R, W, SIGMA3, SIGMA4, S, LOG_S, INV, Q, INV_Q, RHO_OVER_S, INV_G, DRHO, D, RATIO = range(0, 14 * LANES, LANES)
_COEFFICIENTS = 14 * LANES
END_ROWS = _COEFFICIENTS + DIVIDED * LANES
end_of = reader(End, LANES)


class Point(NamedTuple):
    """A point at some distance from an end; rise: V less that of the end; size: of the terms it is a sum of."""

    r: float
    w: float
    q: float
    z: float
    sigma3: float
    sigma4: float
    ratio: float
    rise: float
    size: float


def make_arc_disk(disk: NaturalDisk) -> ArcDisk:
    """The series of a body for arcs."""
    rows, _r0, _dr0 = chaplygin.power_series(disk.body.c)
    start = np.array([0.0, 1.0, 0.0, rows[3][0]])
    small = [np.append(row[0] - first, row[1:]) for row, first in zip(rows[:4], start, strict=True)]
    return ArcDisk(disk.body, np.ascontiguousarray([_of_slope(row) for row in small]))


def _of_slope(row: Vector) -> Vector:
    """Ascending powers of S -> those of 2S - 1, by way of the slope: differences need as many digits as values.

    Of the polynomial nearest to the values the slope errs twenty times as much at flat and at the vertical.
    """
    slope = economise(row[1:] * np.arange(1, row.size), DEGREE - 1)
    return np.append(economise(row, DEGREE)[0], slope / (2.0 * np.arange(1, DEGREE + 1)))


@device
def put_end(A: Vector, at: int, i: int, r: float, w: float, sigma3: float, sigma4: float) -> None:
    """What is given of the end of lane i into rows `at` and following, for `make_ends`."""
    A[at + R + i], A[at + W + i], A[at + SIGMA3 + i], A[at + SIGMA4 + i] = r, w, sigma3, sigma4


@subroutine
def make_ends(A: Vector, at: int, disk: ArcDisk) -> None:
    """The ends in rows `at` and following of a work array, from their r, w, sigma3 and sigma4."""
    E, series = A[at:], disk.series
    for i in range(LANES):
        r, w = E[R + i], E[W + i]
        larger = 1.0 + r * r
        inv = 1.0 / larger
        E[S + i], E[INV + i] = 2.0 * r * (r * inv), inv
        E[Q + i], E[INV_Q + i] = 2.0 * r * inv, 0.5 * larger / r
        E[RATIO + i] = E[SIGMA3 + i] * E[INV_Q + i]
        # ln S = ln(1 - z) without cancellation: far from the vertical by itself, beside it from z.
        z = w * inv
        far = _LN2 + 2.0 * logarithm(r) - logarithm(larger)
        beside = log_ratio(-z / (2.0 - z))
        E[LOG_S + i] = beside if z < 0.5 else far
    C = E[_COEFFICIENTS:]
    b, c, d = DEGREE * LANES, 2 * DEGREE * LANES, 3 * DEGREE * LANES
    for row in range(4):
        C[(row * DEGREE + DEGREE - 1) * LANES : (row + 1) * DEGREE * LANES] = series[row, DEGREE]
    for j in range(DEGREE - 1, 0, -1):
        k, s0, s1, s2, s3 = j * LANES, series[0, j], series[1, j], series[2, j], series[3, j]
        for i in range(k, k + LANES):
            t = 2.0 * E[S + i - k] - 1.0
            C[i - LANES] = C[i] * t + s0
            C[i + b - LANES] = C[i + b] * t + s1
            C[i + c - LANES] = C[i + c] * t + s2
            C[i + d - LANES] = C[i + d] * t + s3
    for i in range(LANES):
        t = 2.0 * E[S + i] - 1.0
        g = C[i] * t + series[0, 0]
        drho = 1.0 + (C[DEGREE * LANES + i] * t + series[1, 0])
        v = C[2 * DEGREE * LANES + i] * t + series[2, 0]
        E[RHO_OVER_S + i], E[INV_G + i], E[DRHO + i] = g, 1.0 / g, drho
        E[D + i] = 0.5 * disk.body.c * E[S + i] * g * E[LOG_S + i] + v


@device
def potential(q: float, ratio: float, sigma4: float, b: Body) -> float:
    """V itself, for bounds and first guesses."""
    return 0.5 * b.I1 * ratio * ratio + 0.5 * b.J * sigma4 * sigma4 + q


@device
def slope_and_bend(q: float, z: float, ratio: float, sigma4: float, b: Body) -> tuple[float, float]:
    """V' and V'' in x."""
    turn, spin = z * ratio, q * sigma4
    slope = b.J * ratio * spin - b.I1 * ratio * turn + q * z
    rest = b.J * b.k * spin * spin + q * (z - q) * (z + q)
    return slope, b.M * (q * ratio) * (q * ratio) + 2.0 * turn * (b.I1 * turn - b.I3 * spin) + rest


@device
def quotients(A: Vector, first: int, t: float) -> tuple[float, float, float, float]:
    """The four divided differences at 2S - 1 = t, even and odd powers apart: chains short enough to unroll."""
    square = t * t
    b, c, d = DEGREE * LANES, 2 * DEGREE * LANES, 3 * DEGREE * LANES
    k = first + (DEGREE - 2) * LANES
    a0, b0, c0, d0 = A[k], A[k + b], A[k + c], A[k + d]
    k = first + (DEGREE - 1) * LANES
    a1, b1, c1, d1 = A[k], A[k + b], A[k + c], A[k + d]
    for j in range(DEGREE - 4, -1, -2):
        k = first + j * LANES
        a0 = a0 * square + A[k]
        b0 = b0 * square + A[k + b]
        c0 = c0 * square + A[k + c]
        d0 = d0 * square + A[k + d]
    for j in range(DEGREE - 3, 0, -2):
        k = first + j * LANES
        a1 = a1 * square + A[k]
        b1 = b1 * square + A[k + b]
        c1 = c1 * square + A[k + c]
        d1 = d1 * square + A[k + d]
    return a0 + t * a1, b0 + t * b1, c0 + t * c1, d0 + t * d1


@device
def point_at(A: Vector, at: int, i: int, d: float, inward: bool, motion: FaceMotion, b: Body) -> Point:
    """The point at the distance d from the end of lane i in rows `at` and following.

    inward: towards flat, or away from it; a constant.
    """
    end = end_of(A, at, i)
    times, grown = exponential(-d if inward else d)
    r = end.r * times
    larger = 1.0 + r * r
    inv, inv_r, larger_end = 1.0 / larger, 1.0 / r, 1.0 + end.r * end.r
    de = end.r * grown * (r + end.r)
    S_here, dS = 2.0 * r * r * inv, 2.0 * de * inv * end.inv
    share = de * end.inv
    dlog = (-2.0 * d if inward else 2.0 * d) - log_ratio(share / (2.0 + share))
    g, rho1, v, dv = quotients(A, at + _COEFFICIENTS + i, 2.0 * S_here - 1.0)
    scale, half_c = 2.0 * dS, 0.5 * b.c
    dg, ddrho, dv0, ddv = g * scale, rho1 * scale, v * scale, dv * scale
    log_S, rho_end = end.log_S + dlog, end.S * end.rho_over_S
    drho = S_here * dg + dS * end.rho_over_S
    dD = half_c * (drho * log_S + rho_end * dlog) + dv0
    ddD = half_c * (ddrho * log_S + end.drho * dlog + dg) + ddv
    dsigma4 = (motion.X * ddrho + motion.Y * ddD) * (1.0 / b.k)
    q, inv_q = 2.0 * r * inv, 0.5 * larger * inv_r
    # r r_end - 1 and 1 - r^2: differences of what is alike where the end is beside the vertical: from w there.
    upright = end.w < 0.5
    product = grown - end.w * times if upright else r * end.r - 1.0
    w = end.w * times * times - grown * (2.0 + grown) if upright else 1.0 - r * r
    dcosh = 0.5 * grown * product * inv_r
    if inward:
        # sigma3 goes like S there: as a share of that of the end, and the part of Y.
        # Of S itself nothing may be left.
        shrunk = times * times * larger_end * inv
        part = shrunk * dg * end.inv_g + grown * (times + 1.0) * inv
        of_Y = motion.Y * (dD - end.D * part)
        dsigma3 = end.sigma3 * part + of_Y
        sigma3 = end.sigma3 * (shrunk * (end.rho_over_S + dg) * end.inv_g) + of_Y
        dratio = dsigma3 * end.inv_q + sigma3 * dcosh
    else:
        dsigma3 = motion.X * drho + motion.Y * dD
        sigma3 = end.sigma3 + dsigma3
        dratio = dsigma3 * inv_q + end.sigma3 * dcosh
    sigma4, ratio = end.sigma4 + dsigma4, sigma3 * inv_q
    of_ratio = 0.5 * b.I1 * dratio * (ratio + end.ratio)
    of_spin = 0.5 * b.J * dsigma4 * (sigma4 + end.sigma4)
    of_height = -dcosh * q * end.q
    # What cancels within the changes of sigma3 and sigma4, beside the upright equilibrium, counts as well.
    of_parts = abs(sigma4) + 0.5 * b.I1 * abs(ratio + end.ratio) * (end.inv_q if inward else inv_q)
    within = 4.0 * abs(dS) * (abs(motion.X) + abs(motion.Y)) * of_parts
    size = abs(of_ratio) + abs(of_spin) + abs(of_height) + within
    return Point(r, w, q, w * inv, sigma3, sigma4, ratio, of_ratio + of_spin + of_height, size)
