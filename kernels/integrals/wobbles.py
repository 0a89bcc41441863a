"""Wobbles about steady motion by quadrature: whole periods and their parts, down to no wobble at all.

Between the turning points of `wells`, x = middle + half-width sin(phase), and

    ds = sqrt(M / (2 share)) dphase,   dt = q ds,   dchi = rho ds,   dpsi = (z rho - q sigma4) ds

have nothing singular: where the turning points meet they are those of the linear wobble about the steady motion.
"""

import math
from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.falling import potential_at_anchor
from kernels.integrals.point import Motion
from kernels.integrals.quadrature import FLOOR, PassageRow, Rules, good_enough, missed
from kernels.integrals.wells import RHO, SHARE, SIGMA4, Q, Well, Z, outside, value
from kernels.status import Status
from kernels.types import Matrix, Vector

_OK = int(Status.OK)
_LIMIT = int(Status.STEP_LIMIT)
_QUARTER = 0.5 * math.pi
_LEAST = 1e-300
_BESIDE = 4.0  # units of rounding
NOT_THERE = PassageRow(math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Arc(NamedTuple):
    """Part of a period, between two phases, -pi/2 the flattest moment; doubt: relative, from where it ends."""

    low: float
    high: float
    doubt: float


class Turned(NamedTuple):
    """What the way along an arc and back adds to angles, time and s; least: of the share on it."""

    chi: float
    psi: float
    time: float
    span: float
    least: float


class Stretch(NamedTuple):
    """The way along an arc and back, with its errors: of the angles (rad), of the time (relative)."""

    status: int
    chi: float
    psi: float
    time: float
    angle_error: float
    time_error: float


@subroutine
def along(W: Vector, well: Well, arc: Arc, rule: Matrix, b: Body) -> Turned:
    """There and back along an arc by one rule on [-1, 1]."""
    middle, width = 0.5 * (well.inner + well.outer), 0.5 * (well.outer - well.inner)
    centre, half = 0.5 * (arc.low + arc.high), 0.5 * (arc.high - arc.low)
    chi = psi = time = span = 0.0
    least, last = math.inf, well.terms
    for j in range(rule.shape[1]):
        x = middle + width * math.sin(centre + half * rule[0, j])
        share = q = z = rho = spin = 0.0
        for n in range(last, -1, -1):
            q, z = q * x + W[Q + n], z * x + W[Z + n]
            rho, spin = rho * x + W[RHO + n], spin * x + W[SIGMA4 + n]
        share = value(W, SHARE, SHARE + last - 2, x)
        least = min(least, share)
        ds = half * rule[1, j] * math.sqrt(2.0 * b.M / max(share, _LEAST))
        span, time = span + ds, time + ds * q
        chi, psi = chi + ds * rho, psi + ds * (z * rho - q * spin)
    return Turned(chi, psi, time, span, least)


@subroutine
def stretch(W: Vector, well: Well, arc: Arc, target: float, rules: Rules, b: Body) -> Stretch:
    """There and back along an arc: orders of the rules rise until they miss less than `target`."""
    chi = psi = time = math.nan
    angles_apart = time_apart = math.nan
    angle_error = time_error = math.inf
    first = 0
    for size in rules.sizes:
        last = first + int(size)
        now = along(W, well, arc, rules.packed[1, :, first:last], b)
        first = last
        angles_before, apart_before = angles_apart, time_apart
        angles_apart = max(abs(now.chi - chi), abs(now.psi - psi))
        time_apart = abs(now.time / time - 1.0)
        chi, psi, time = now.chi, now.psi, now.time
        turned = max(1.0, abs(chi), abs(psi))
        angle_error, time_error = (
            missed(angles_apart, angles_before, turned),
            missed(time_apart, apart_before, 1.0),
        )
        if not now.least > 0.0:
            continue
        weak = max(well.bend / now.least, 1.0)
        time_noise = well.blur * weak + arc.doubt
        angle_noise = time_noise * (abs(chi) + abs(psi)) + well.waver * now.span
        if good_enough(angle_error, angle_noise, target, FLOOR * turned) and good_enough(
            time_error, time_noise, target, FLOOR
        ):
            return Stretch(_OK, chi, psi, time, 2.0 * (angle_error + angle_noise), 2.0 * (time_error + time_noise))
    return Stretch(_LIMIT, chi, psi, time, angle_error, time_error)


@device
def crosses(well: Well) -> bool:
    """Whether the motion passes the vertical; no wobble at all beside the vertical does not."""
    return well.inner < well.vertical < well.outer and well.outer - well.inner > 4.0 * well.shift


@device
def told(rate: float, well: Well) -> Well:
    """The well, unless rounding hides on which side of the vertical the motion of a moving state turns back.

    The state itself may tell; a well tells of what is at rest, or moves no more than its rounding.
    """
    beside = min(abs(well.outer - well.vertical), abs(well.vertical - well.inner))
    hidden = beside <= _BESIDE * well.shift and well.outer - well.inner > 4.0 * _BESIDE * well.shift
    return outside(well.terms) if hidden and rate != 0.0 else well


@device
def tilt(x: float, face: float, W: Vector) -> float:
    """The tilt from `face` at x."""
    # tan(theta/2) at the bottom, times e^x
    tangent = W[Q] / (1.0 + W[Z]) * math.exp(x)
    return 2.0 * math.atan(tangent if face > 0.0 else 1.0 / tangent)


@subroutine
def least_tilt(well: Well, W: Vector) -> float:
    """The smallest tilt of a wobble, from either face."""
    here = tilt(well.inner, 1.0, W)
    return min(here, tilt(well.outer, -1.0, W)) if crosses(well) else here


@subroutine
def row_of(
    part: Stretch, x: float, face: float, motion: Motion, W: Vector, well: Well, b: Body
) -> PassageRow[float]:
    """The passage row of a part whose flattest moment on `face` is at x."""
    theta = tilt(x, face, W)
    way = value(W, RHO, RHO + well.terms, x)
    energy = motion.level + potential_at_anchor(motion.X, motion.Y, b)
    return PassageRow(theta, part.chi, face * part.psi, part.time, energy, part.angle_error, part.time_error, way)


@subroutine
def whole_wobble(
    well: Well, motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float], PassageRow[float]]:
    """One whole period as `orbits.orbit` gives it, all of it in the first row; STEP_LIMIT without a well."""
    b = disk.body
    if not well.outer >= well.inner:
        return _LIMIT, NOT_THERE, NOT_THERE
    whole = stretch(W, well, Arc(-_QUARTER, _QUARTER, 0.0), target, rules, b)
    here = row_of(whole, well.inner, 1.0, motion, W, well, b)
    if not crosses(well):
        return whole.status, here, NOT_THERE
    nothing = Stretch(_OK, 0.0, 0.0, 0.0, 0.0, 0.0)
    return whole.status, here, row_of(nothing, well.outer, -1.0, motion, W, well, b)


@subroutine
def parted_wobble(
    well: Well, motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float], PassageRow[float]]:
    """One whole period as `orbits.orbit` gives it, parted at the vertical."""
    if not crosses(well):
        return whole_wobble(well, motion, target, rules, disk, W)
    b, width = disk.body, well.outer - well.inner
    beyond, within = well.outer - well.vertical, well.vertical - well.inner
    # The arcs on either side, neither found as a difference; at the vertical dx = dent dphase.
    far = 2.0 * math.asin(math.sqrt(beyond / width))
    near = 2.0 * math.asin(math.sqrt(within / width))
    doubt = well.shift / math.sqrt(beyond * within)
    here = stretch(W, well, Arc(-_QUARTER, near - _QUARTER, doubt / near), target, rules, b)
    there = stretch(W, well, Arc(_QUARTER - far, _QUARTER, doubt / far), target, rules, b)
    return (
        max(here.status, there.status),
        row_of(here, well.inner, 1.0, motion, W, well, b),
        row_of(there, well.outer, -1.0, motion, W, well, b),
    )


@subroutine
def time_to_flattest_of_wobble(
    rate: float, well: Well, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, float, float]:
    """Status, time between the state and the flattest moment of its wobble, and its error; 0 without a wobble."""
    b = disk.body
    middle, width = 0.5 * (well.inner + well.outer), 0.5 * (well.outer - well.inner)
    share = value(W, SHARE, SHARE + well.terms - 2, well.state)
    # Half-width times cosine and sine of the state's phase
    forward = abs(rate) * math.sqrt(0.5 * b.M / max(share, _LEAST))
    phase = math.atan2(well.state - middle, forward) if width > 0.0 else -_QUARTER
    if not phase > -_QUARTER:
        return _OK, 0.0, 0.0
    lead = stretch(W, well, Arc(-_QUARTER, phase, 0.0), target, rules, b)
    return lead.status, 0.5 * lead.time, 0.5 * lead.time * lead.time_error
