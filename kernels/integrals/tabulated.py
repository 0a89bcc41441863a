"""Passages from the vertical by tables: samples side by side, a fixed number of nodes, no branch.

The integrals of `quadrature`, for motions that come near flat (h at the turning point <= WIDEST)
and do not start too slowly. From the vertical to HANDOVER the nodes stand at tilts that are the same
for all samples (`tables`). From there to the turning point they lie in y, h = h_m cosh y, and what
the terms of first order give is known in closed form: with tau = h_m sinh y and the angle
gd = atan(tau / h_m), the integrals over y of

    1/h                      gd / h_m                           the race itself
    h / (h + h_m)            y - tau / (h + h_m)                gravity's pull on it
    h ln(h/h_m) / tau^2      gd / h_m - ln(h/h_m) / tau         the spin's
    h, h ln h                tau, tau ln h - tau + h_m gd       the rest of the motion

so twenty nodes serve every |eta|. The last coefficients of each panel's Legendre series say how well
it has converged; samples that have not, and those outside these bounds, are left to `quadrature`.
"""

import math

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.elementary import DEEPEST, arctan, exp_fall, horner, log_ratio
from kernels.integrals import tables

LANES = 32
WIDEST = 0.2  # of h_m: well inside HANDOVER
NARROWEST = 1e-303  # of |Y|: h_m must not be denormal
SLOWEST = 1e-3  # share of the energy above V_0 with which it must leave the vertical
_LEFT_OUT = 2.0  # in y: what is below the deepest node falls off like e^y, or ends at the turning point
_NEWTON = 5  # from the guess of first order to rounding, for h_m <= WIDEST
_EPSILON = 2.2e-16
_NOISE = 100.0  # units of rounding, as in quadrature

# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`.
X, Y, LEVEL, H_TURN, LOG_TURN, CHECK, NOISE = range(7)
_TAU, _CAP, _LOG_CAP, _WIDTH, _TURN2, _RACE, _PULL, _SPIN, _SLOW, _REST0, _REST1 = range(7, 18)
CHI, REST, TIME, PSI = 18, 19, 20, 19  # results; from _TAILS on, for each, sum of sizes and two last coefficients
_TAILS = 21
_LEAST = 30  # least theta-dot^2 met
ANGLE_ERROR, TIME_ERROR, WAY, SPEED, _BELOW, _START = 31, 32, 33, 34, 35, 36
ROWS = 37

_LN2 = math.log(2.0)


@contracted_device
def near_flat(h, log_h, x, y, b, low):
    """(smooth, D, n, rise, V - V_0, 1/h, cos^2(theta/2), its root) at h <= HANDOVER.

    n = sigma3/q cos(theta/2) = smooth + Y D/h.
    """
    S = 0.5 * h * h
    t = 16.0 * S - 1.0
    log_S = 2.0 * log_h - _LN2
    g = horner(low.rho_over_S, t)
    half_c, inv_k = 0.5 * b.c, 1.0 / b.k
    D = half_c * S * g * log_S + horner(low.v, t)
    dD = half_c * (horner(low.drho, t) * log_S + g) + horner(low.dv, t)
    rise = (x * S * horner(low.excess, t) + y * dD) * inv_k
    inv_h = 1.0 / h
    smooth = 0.5 * x * g * h
    n = smooth + y * inv_h * D
    shape2 = 1.0 - 0.5 * S
    shape = math.sqrt(shape2)
    V = 0.5 * b.I1 * n * n / shape2 + 0.5 * b.J * rise * (2.0 * x * inv_k + rise) + h * shape
    return smooth, D, n, rise, V, inv_h, shape2, shape


@contracted_device
def slope_of(h, n, rise, shape2, shape, x, b):
    """h dV/dh."""
    z = 1.0 - 0.5 * h * h
    spin = x / b.k + rise
    return h / shape * (b.J * n / shape * spin + z) - b.I1 * z * n * n / (shape2 * shape2)


@contracted_subroutine
def clear(W, first, end):
    """Zeros in rows first ... end - 1."""
    for row in range(first, end):
        for i in range(LANES):
            W[row * LANES + i] = 0.0


@contracted_device
def start_noise(terms, moving, ratio, sigma4, b):
    """What rounding in E - V, a difference of `terms`, does at the vertical to angles and time, relative.

    It acts while the motion is within about a radian of the vertical.
    """
    duration = min(1.0, math.sqrt(0.5 * b.M / moving))
    return 4.0 * _EPSILON * terms / moving * duration * (1.0 + abs(ratio) + abs(sigma4))


@contracted_subroutine
def start(W, vertical, b):
    """LEVEL from SPEED at the vertical, a guess at the turning point, and NOISE of E - V."""
    rx, ry, sx, sy = (
        vertical[tables.RATIO_X, 0],
        vertical[tables.RATIO_Y, 0],
        vertical[tables.RISE_X, 0],
        vertical[tables.RISE_Y, 0],
    )
    inv_k = 1.0 / b.k
    for i in range(LANES):
        x, y = W[X * LANES + i], W[Y * LANES + i]
        ratio, rise = x * rx + y * ry, x * sx + y * sy
        spin = 0.5 * b.J * rise * (2.0 * x * inv_k + rise)
        gyration = 0.5 * b.I1 * ratio * ratio
        speed = W[SPEED * LANES + i]
        moving = 0.5 * b.M * speed * speed
        level = moving + gyration + spin + 1.0
        W[LEVEL * LANES + i] = level
        terms = abs(level) + gyration + abs(spin) + 1.0
        W[NOISE * LANES + i] = terms
        W[_START * LANES + i] = start_noise(terms, moving, ratio, x * inv_k + rise, b)
        ok = (moving > SLOWEST * level) & (abs(y) > NARROWEST)
        size = abs(y)
        first = size * math.sqrt(0.5 * b.I1 / level)
        # Gravity shares the energy at the turning point: one step of q = h.
        left = level - first
        ok = ok & (first < 2.0 * WIDEST) & (left > 0.5 * level)
        h = size * math.sqrt(0.5 * b.I1 / left)
        W[H_TURN * LANES + i] = h if ok else 0.1
        W[CHECK * LANES + i] = 0.0 if ok else 1.0
    for i in range(LANES):
        W[LOG_TURN * LANES + i] = math.log(W[H_TURN * LANES + i])


@contracted_subroutine
def turn(W, b, low):
    """H_TURN and LOG_TURN by Newton in ln h; CHECK is raised where that has not converged."""
    for _ in range(_NEWTON):
        for i in range(LANES):
            x, y = W[X * LANES + i], W[Y * LANES + i]
            h, log_h = W[H_TURN * LANES + i], W[LOG_TURN * LANES + i]
            _smooth, _D, n, rise, V, _inv_h, shape2, shape = near_flat(h, log_h, x, y, b, low)
            step = (W[LEVEL * LANES + i] - V) / slope_of(h, n, rise, shape2, shape, x, b)
            step = max(min(step, 0.25), -0.25)
            W[H_TURN * LANES + i] = h + h * step
            W[LOG_TURN * LANES + i] = log_h + log_ratio(step / (2.0 + step))
            W[WAY * LANES + i] = step
    for i in range(LANES):
        # The next step would be about the square of the last: below rounding.
        good = (abs(W[WAY * LANES + i]) < 1e-8) & (W[H_TURN * LANES + i] < WIDEST)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 1.0
        W[H_TURN * LANES + i] = W[H_TURN * LANES + i] if good else 0.1
        W[LOG_TURN * LANES + i] = W[LOG_TURN * LANES + i] if good else math.log(0.1)


@contracted_subroutine
def closed(W, b, low):
    """What is known in closed form below the handover goes into CHI, REST, TIME; its factors into rows."""
    handover, log_handover = tables.HANDOVER, math.log(tables.HANDOVER)
    inv_k = 1.0 / b.k
    for i in range(LANES):
        x, y = W[X * LANES + i], W[Y * LANES + i]
        h, log_h = W[H_TURN * LANES + i], W[LOG_TURN * LANES + i]
        _smooth, D, n, rise, _V, inv_h, shape2, shape = near_flat(h, log_h, x, y, b, low)
        slope = -slope_of(h, n, rise, shape2, shape, x, b)
        ratio = n / shape
        W[WAY * LANES + i] = ratio
        W[NOISE * LANES + i] = _NOISE * _EPSILON * (1.0 + W[NOISE * LANES + i] / slope) + W[_START * LANES + i]
        good = slope > 0.0
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 1.0
        slope = slope if good else 1.0
        slow = 1.0 / (shape2 * shape * math.sqrt(slope * b.inv_M))
        race = D * slow
        tau = math.sqrt(handover * handover - h * h)
        # ln((handover + tau)/2) is ln(handover) + ln(1 - s) with a small s.
        s = 0.5 * (handover - tau) / handover
        cap = 0.5 * (handover + tau)
        log_cap = log_handover + log_ratio(-s / (2.0 - s))
        gd = 0.5 * math.pi - arctan(h / tau)
        y_end = log_cap + _LN2 - log_h
        # M theta-dot^2 = slope tanh^2 y less 2 (h - h_m) and 2 spin ln(h/h_m), to first order
        spin = b.J * (x * inv_k + rise) * b.c * y * inv_k
        pull = y * race / slope
        wide = y_end if y_end < DEEPEST else DEEPEST
        below = y_end - wide
        rest0 = (x + y * (0.5 * b.c * (1.0 - _LN2) + horner(low.dv, -1.0))) * inv_k
        rest1 = y * b.c * inv_k
        W[_TAU * LANES + i], W[_CAP * LANES + i], W[_LOG_CAP * LANES + i] = tau, cap, log_cap
        W[_WIDTH * LANES + i], W[_TURN2 * LANES + i] = wide, 0.25 * h * h
        W[_BELOW * LANES + i] = below if below < _LEFT_OUT else _LEFT_OUT
        W[_RACE * LANES + i], W[_PULL * LANES + i], W[_SPIN * LANES + i] = race, pull, pull * spin
        W[_SLOW * LANES + i], W[_REST0 * LANES + i], W[_REST1 * LANES + i] = slow, rest0, rest1
        fraction = log_handover - log_h
        W[CHI * LANES + i] = (
            race * y * inv_h * gd
            + pull * (y_end - tau / (h + handover) - 0.5 * gd)
            + pull * spin * (0.5 * gd * inv_h - fraction / tau)
            + 0.5 * x * slow * tau
        )
        W[REST * LANES + i] = slow * (rest0 * tau + rest1 * (tau * log_handover - tau + h * gd))
        W[TIME * LANES + i] = slow * tau
    clear(W, _TAILS, WAY)
    for i in range(LANES):
        W[_LEAST * LANES + i] = 1.0


@contracted_device
def gather(W, i, sums, row, value, last, last_but_one):
    """Add a weighted value to the panel's sum, to its size and to its last two coefficients."""
    W[sums * LANES + i] += value
    W[row * LANES + i] += abs(value)
    W[(row + 1) * LANES + i] += value * last
    W[(row + 2) * LANES + i] += value * last_but_one


@contracted_subroutine
def near_panel(W, inner, b, low):
    """Add what the closed forms leave between the turning point and the handover."""
    inv_k, twice = 1.0 / b.k, 2.0 * b.inv_M
    for j in range(inner.shape[1]):
        gap, weight = inner[tables.GAP, j], inner[tables.WEIGHT, j]
        last, last_but_one = inner[tables.EVEN, j], inner[tables.EVEN_BUT_ONE, j]
        for i in range(LANES):
            x, y = W[X * LANES + i], W[Y * LANES + i]
            h_turn, width = W[H_TURN * LANES + i], W[_WIDTH * LANES + i]
            slow = W[_SLOW * LANES + i]
            d = width * gap
            # h and tau are the sum and the difference of h_m e^y / 2 and h_m e^-y / 2.
            rising = W[_CAP * LANES + i] * exp_fall(d)
            inv_rising = 1.0 / rising
            falling = W[_TURN2 * LANES + i] * inv_rising
            h, tau = rising + falling, rising - falling
            fraction = falling * inv_rising
            log_h = W[_LOG_CAP * LANES + i] - d + log_ratio(fraction / (2.0 + fraction))
            smooth, D, n, rise, V, inv_h, shape2, shape = near_flat(h, log_h, x, y, b, low)
            left = twice * (W[LEVEL * LANES + i] - V)
            least = W[_LEAST * LANES + i]
            W[_LEAST * LANES + i] = left if left < least else least
            left = left if left > 0.0 else 1.0
            inv_shape2 = 1.0 / shape2
            w = tau * inv_h * inv_shape2 / (shape * math.sqrt(left))
            dt = h * w * shape2
            inv_tau2 = 1.0 / (tau * tau)
            log_rise = log_h - W[LOG_TURN * LANES + i]
            step = weight * width
            chi = (
                smooth * w
                - 0.5 * x * h * slow
                + y * inv_h * (D * w - W[_RACE * LANES + i])
                - W[_PULL * LANES + i] * (h * (h - h_turn) * inv_tau2 - 0.5 * h_turn * inv_h)
                - W[_SPIN * LANES + i] * (log_rise * h * inv_tau2 - 0.5 * inv_h)
            )
            rest = dt * (0.5 * h * n * inv_shape2 + x * inv_k + rise) - slow * h * (
                W[_REST0 * LANES + i] + W[_REST1 * LANES + i] * log_h
            )
            time = dt - slow * h
            gather(W, i, CHI, _TAILS, step * chi, last, last_but_one)
            gather(W, i, REST, _TAILS + 3, step * rest, last, last_but_one)
            gather(W, i, TIME, _TAILS + 6, step * time, last, last_but_one)
            # The first node is the deepest; no rule looks further down.
            left_out = W[_BELOW * LANES + i] if j == 0 else 0.0
            W[ANGLE_ERROR * LANES + i] += left_out * (abs(chi) + abs(rest))
            W[TIME_ERROR * LANES + i] += left_out * abs(time)
    settle(W)


@contracted_subroutine
def far_panel(W, outer, b):
    """Add the stretch from the handover to the vertical, by nodes at tilts that all samples share."""
    inv_k, twice = 1.0 / b.k, 2.0 * b.inv_M
    for j in range(outer.shape[1]):
        rx, ry, sx, sy = (
            outer[tables.RATIO_X, j],
            outer[tables.RATIO_Y, j],
            outer[tables.RISE_X, j],
            outer[tables.RISE_Y, j],
        )
        q, slope, weight, chi_weight = (
            outer[tables.HEIGHT, j],
            outer[tables.SLOPE, j],
            outer[tables.TIME, j],
            outer[tables.CHI, j],
        )
        last, last_but_one = outer[tables.LAST, j], outer[tables.LAST_BUT_ONE, j]
        for i in range(LANES):
            x, y = W[X * LANES + i], W[Y * LANES + i]
            ratio, rise = x * rx + y * ry, x * sx + y * sy
            flat = x * inv_k
            V = 0.5 * b.I1 * ratio * ratio + 0.5 * b.J * rise * (2.0 * flat + rise) + q
            left = twice * (W[LEVEL * LANES + i] - V)
            least = W[_LEAST * LANES + i]
            W[_LEAST * LANES + i] = left if left < least else least
            inv_speed = 1.0 / math.sqrt(left if left > 0.0 else 1.0)
            gather(W, i, CHI, _TAILS, chi_weight * ratio * inv_speed, last, last_but_one)
            gather(W, i, REST, _TAILS + 3, weight * inv_speed * (ratio * slope + flat + rise), last, last_but_one)
            gather(W, i, TIME, _TAILS + 6, weight * inv_speed, last, last_but_one)
    settle(W)


@contracted_device
def remainder(W, i, row):
    """Error of a Gauss rule of n nodes from coefficients n - 1 and n - 2: of a geometric series about
    size * ratio^(2n), where they are size * ratio^n. Never more than they are themselves."""
    tail = abs(W[(row + 1) * LANES + i]) + abs(W[(row + 2) * LANES + i])
    size = W[row * LANES + i]
    share = tail / (size + 1e-300)
    return tail * (share if share < 1.0 else 1.0)


@contracted_subroutine
def settle(W):
    """Add the panel's errors and clear its sums."""
    for i in range(LANES):
        chi, rest, time = remainder(W, i, _TAILS), remainder(W, i, _TAILS + 3), remainder(W, i, _TAILS + 6)
        W[ANGLE_ERROR * LANES + i] += 2.0 * (chi + rest)
        W[TIME_ERROR * LANES + i] += 2.0 * time
    clear(W, _TAILS, _LEAST)


@contracted_subroutine
def finish(W, target, floor):
    """There and back in CHI, PSI (in the place of REST) and TIME, errors with rounding; CHECK is 0
    where they meet the target, or the floor relative to chi and to the time."""
    for i in range(LANES):
        chi, rest, time = 2.0 * W[CHI * LANES + i], 2.0 * W[REST * LANES + i], 2.0 * W[TIME * LANES + i]
        noise = W[NOISE * LANES + i]
        angle_error = 2.0 * W[ANGLE_ERROR * LANES + i] + noise * (abs(chi) + abs(rest))
        time_error = 2.0 * W[TIME_ERROR * LANES + i] / time + noise
        W[CHI * LANES + i], W[PSI * LANES + i], W[TIME * LANES + i] = chi, chi - rest, time
        W[ANGLE_ERROR * LANES + i], W[TIME_ERROR * LANES + i] = angle_error, time_error
        size = abs(chi) if abs(chi) > 1.0 else 1.0
        angle_target = floor * size if floor * size > target else target
        time_target = floor if floor > target else target
        good = (angle_error <= angle_target) & (time_error <= time_target) & (W[_LEAST * LANES + i] > 0.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 1.0


@contracted_subroutine
def passages(W, target, floor, tables_of_body, b):
    """Whole passages of the samples in rows X, Y and SPEED."""
    start(W, tables_of_body.vertical, b)
    turn(W, b, tables_of_body.low)
    closed(W, b, tables_of_body.low)
    near_panel(W, tables_of_body.inner, b, tables_of_body.low)
    far_panel(W, tables_of_body.outer, b)
    finish(W, target, floor)


@contracted_subroutine
def falls(W, target, floor, tables_of_body, b):
    """Twice the falls on F from the vertical, for rows X and LEVEL; row Y becomes 0."""
    rx, sx = tables_of_body.vertical[tables.RATIO_X, 0], tables_of_body.vertical[tables.RISE_X, 0]
    clear(W, Y, LEVEL)
    clear(W, CHI, WAY)
    for i in range(LANES):
        x, level = W[X * LANES + i], W[LEVEL * LANES + i]
        ratio, rise = x * rx, x * sx
        gyration = 0.5 * b.I1 * ratio * ratio
        spin = 0.5 * b.J * rise * (2.0 * x / b.k + rise)
        moving = level - gyration - spin - 1.0
        terms = abs(level) + gyration + abs(spin) + 1.0
        noise = start_noise(terms, moving, ratio, x / b.k + rise, b)
        W[NOISE * LANES + i] = _NOISE * _EPSILON * (1.0 + terms / abs(level)) + noise
        W[_LEAST * LANES + i] = 1.0
        W[CHECK * LANES + i] = 0.0 if moving > SLOWEST * level else 1.0
    far_panel(W, tables_of_body.fall, b)
    finish(W, target, floor)
