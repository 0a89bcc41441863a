"""One passage near flat as an integral: no time steps, and eta as an input of its own.

With h = 2 sin(theta/2) and h = h_m cosh y, where h_m is the turning point, the passage from h_m to
the vertical is an integral over y of an even analytic function. Its only sharp feature is the race
itself, sigma_3/q^2 ~ Y/h^2, which is integrated in closed form:

    chi = Y w(0)/h_m * gd(y_c) + integral of [ X (rho/S) h w / 2 + (Y/h) (D w - D_m w(0)) ] dy + ...

with w = (1 - S/2)^(-3/2) (P / tanh^2 y)^(-1/2) and P = theta-dot^2. What is left varies over unit
distances in y by an amount of order eta, so a fixed Gauss rule serves |eta| from 1 to 1e-300: below
y_c - 36 the rest is smaller than rounding, and the range never grows. The end towards the vertical,
where a slow start makes P nearly vanish, has a panel of its own in d = scale sinh^2 x.
Everything near flat is written in h and ratios to it; S = h^2/2 may underflow. The nodes of a rule are
evaluated together, in `nodes`; `point` is the same for one tilt.
"""

import math
from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk import chaplygin
from kernels.integrals import nodes
from kernels.integrals.nodes import ROOM
from kernels.status import Status

# Length of the panel towards the vertical, in y: it ends at a fifth of the vertical's h.
_END_PANEL = 1.5
# e^-36 = 2e-16: nothing but the closed part is left below.
_DEEPEST = 36.0
_LN2 = math.log(2.0)
# Tilts tried between the vertical and flat when looking for the first turning point.
SCAN = 24
_ROOT_LIMIT = 200
_EPSILON = 2.2e-16
FLOOR = 1e-11  # an accuracy below this is met as far as rounding allows
VERTICAL = math.sqrt(2.0)  # h there
_NOISE = 100.0  # units of rounding: 30 nodes, sixteen in an exponential, the solutions

_OK = int(Status.OK)
_BAD = int(Status.BAD_INPUT)
_LIMIT = int(Status.STEP_LIMIT)


class Point(NamedTuple):
    """A tilt on a motion with constants (X, Y), face +1.

    shape: sqrt(1 - h^2/4) = cos(theta/2); D: dominant solution; ratio: sigma3/q; V: amended potential
    above V_0; slope: h dV/dh.
    """

    S: float
    shape: float
    D: float
    ratio: float
    sigma4: float
    V: float
    slope: float


class Passage(NamedTuple):
    """A passage from `end` to the turning point and back, natural units, face +1.

    way: sigma3 at the turning point, whose sign is the direction of the race.
    """

    h_turn: float
    way: float
    chi: float
    psi: float
    time: float
    angle_error: float
    time_error: float


@subroutine
def point(h, X, Y, b, series):
    """The motion at h = 2 sin(theta/2), 0 < h <= sqrt 2."""
    S = 0.5 * h * h
    f = chaplygin.solutions(S, 2.0 * math.log(h) - _LN2, b.c, series)
    shape = math.sqrt(1.0 - 0.5 * S)
    smooth = 0.5 * X * f.rho_over_S * h
    ratio = (smooth + Y * f.D / h) / shape
    sigma4 = (X * f.drho + Y * f.dD) / b.k
    q, z = h * shape, 1.0 - S
    # sigma4^2 less its value at flat, from the difference itself: near flat V - V_0 is all there is
    flat = X / b.k
    rise = (X * S * chaplygin.slope_excess(S, series) + Y * f.dD) / b.k
    V = 0.5 * b.I1 * ratio * ratio + 0.5 * b.J * rise * (2.0 * flat + rise) + q
    slope = h / shape * (b.J * ratio * sigma4 + z) - b.I1 * z * ratio * ratio / (shape * shape)
    return Point(S, shape, f.D, ratio, sigma4, V, slope)


@subroutine
def kinetic(h, level, X, Y, b, series):
    """P = theta-dot^2 = 2 (E - V) / M, with level = E - V_0, as everywhere here."""
    return 2.0 * b.inv_M * (level - point(h, X, Y, b, series).V)


@subroutine
def refine(low, high, level, X, Y, b, series):
    """The turning point between ln h = low (P < 0) and high (P > 0), by bracketed Newton in ln h."""
    x = 0.5 * (low + high)
    for _ in range(_ROOT_LIMIT):
        at = point(math.exp(x), X, Y, b, series)
        gap = level - at.V
        if gap < 0.0:
            low = x
        else:
            high = x
        # d(E - V)/d ln h = -slope
        guess = x + gap / at.slope if at.slope != 0.0 else low
        if not (low < guess < high):
            guess = 0.5 * (low + high)
        if abs(guess - x) <= 2.0 * _EPSILON * max(1.0, abs(x)):
            return math.exp(guess)
        x = guess
    return math.exp(x)


@subroutine
def crest(low, high, X, Y, b, series):
    """ln h of the maximum of V between ln h = low, where V rises with h, and high, where it falls."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        if point(math.exp(middle), X, Y, b, series).slope > 0.0:
            low = middle
        else:
            high = middle
    return low


@subroutine
def turning_point(h_end, rest, level, X, Y, b, series, W):
    """h of the first turning point on the way from h_end to flat; NaN if it starts on the wrong side.

    Steps down in tilt, looking at every local minimum of P on the way (a barrier), then in ln h.
    """
    if rest:
        # From rest it moves towards flat only if V falls that way.
        if not point(h_end, X, Y, b, series).slope > 0.0:
            return math.nan
    elif not kinetic(h_end, level, X, Y, b, series) >= 0.0:
        return math.nan
    for i in range(SCAN):
        h = h_end * (1.0 - i / SCAN)
        W[nodes.H * ROOM + i] = h
        W[nodes.LOG * ROOM + i] = 2.0 * math.log(h) - _LN2
    nodes.levels(W, SCAN, X, Y, b, series)
    above = math.log(h_end)
    for i in range(1, SCAN):
        here = 0.5 * (W[nodes.LOG * ROOM + i] + _LN2)
        if level < W[nodes.LEVEL * ROOM + i]:
            return refine(here, above, level, X, Y, b, series)
        if W[nodes.SLOPE * ROOM + i - 1] < 0.0 < W[nodes.SLOPE * ROOM + i]:
            # V rose and falls again: its maximum is between.
            top = crest(here, above, X, Y, b, series)
            if level < point(math.exp(top), X, Y, b, series).V:
                return refine(top, above, level, X, Y, b, series)
        above = here
    # Near flat h_m = |Y| sqrt(I1/M) / A to leading order: look there before walking down.
    if level > 0.0 and Y != 0.0:
        guess = math.log(abs(Y)) + 0.5 * math.log(0.5 * b.I1 / level)
        if guess + 0.7 < above:
            low = kinetic(math.exp(max(guess - 0.7, -744.0)), level, X, Y, b, series)
            if low < 0.0 < kinetic(math.exp(guess + 0.7), level, X, Y, b, series):
                return refine(guess - 0.7, guess + 0.7, level, X, Y, b, series)
    below = above
    while below > -740.0:
        below -= 2.0
        if kinetic(math.exp(below), level, X, Y, b, series) < 0.0:
            return refine(below, below + 2.0, level, X, Y, b, series)
    return math.nan


@device
def magnitude(at, level, X, b):
    """Sum of the sizes of what E - V is a difference of: its rounding is some units of that."""
    flat = X / b.k
    spin = b.J * abs(at.sigma4 - flat) * (abs(flat) + abs(at.sigma4))
    return abs(level) + 0.5 * b.I1 * at.ratio * at.ratio + spin + math.sqrt(2.0 * at.S) * at.shape


@device
def slow_start(kinetic_energy, slope, bend, length, rest, rounding):
    """(scale, least kinetic energy that matters) of E - V = kinetic + slope d + bend d^2, d from the start.

    scale: where the start's terms give way to the last; with d = scale sinh^2 x the root of E - V is
    smooth in x. From rest the first node is about a thousandth of the length away.
    """
    scale = length
    if rest:
        least = 1e-3 * (slope + bend * length) * length
        if bend > 0.0:
            scale = min(length, slope / bend)
            least = min(least, slope * slope / bend)
        return max(scale, 1e-300), least
    if kinetic_energy > 0.0 and slope + bend > 0.0:
        root = math.sqrt(slope * slope + 4.0 * bend * kinetic_energy)
        scale = min(length, 2.0 * kinetic_energy / (slope + root))
    return scale, max(kinetic_energy, rounding)


@subroutine
def end_scale(h_turn, y_end, length, rest, level, X, Y, b, series):
    """(scale, noise): where a slow start at y_end stops being slow, and what rounding does there.

    rest: the motion starts from rest at y_end, whatever rounding makes of its speed there.
    """
    last = point(h_turn * math.cosh(y_end), X, Y, b, series)
    start = 0.0 if rest else max(level - last.V, 0.0)
    slope = max(last.slope * math.tanh(y_end), 0.0)
    other = level - point(h_turn * math.cosh(y_end - length), X, Y, b, series).V
    bend = max(other - start - slope * length, 0.0) / (length * length)
    rounding = _EPSILON * magnitude(last, level, X, b)
    scale, slow = slow_start(start, slope, bend, length, rest, rounding)
    tilt = h_turn * math.sinh(y_end) / last.shape  # d theta / dy
    return scale, slow_noise(slow, scale * tilt, rounding, last, b)


@subroutine
def slow_noise(slow, distance, rounding, at, b):
    """Error of angles and time from rounding in E - V, which acts for as long as the motion is slow."""
    if not slow > 0.0:
        return math.inf
    duration = math.sqrt(2.0) * distance / math.sqrt(2.0 * b.inv_M * slow)
    return 4.0 * rounding / slow * duration * (1.0 + abs(at.ratio) + abs(at.sigma4))


@subroutine
def lay_nodes(W, y_end, length, scale, closed, half, whole):
    """Place the nodes of both panels, as distances below y_end; returns how many.

    Flat panel, 0 < y < y_end - length: the positive half of a symmetric rule, since the integrand is
    even. Where y_end is large it starts at _DEEPEST below its end: nothing is left under that, and it
    makes no difference that the integrand is not even there. End panel: y_end - scale sinh^2 x.
    """
    n = half.shape[1]
    width = min(y_end - length, _DEEPEST)
    for j in range(n):
        W[nodes.GAP * ROOM + j] = length + width * (1.0 - half[0, j])
        W[nodes.WEIGHT * ROOM + j] = width * half[1, j]
        W[nodes.CLOSED * ROOM + j] = closed * width * half[1, j]
    stretch = math.asinh(math.sqrt(length / scale))
    for j in range(n):
        x = 0.5 * stretch * (1.0 + whole[0, j])
        sinh = math.sinh(x)
        W[nodes.GAP * ROOM + n + j] = scale * sinh * sinh
        W[nodes.WEIGHT * ROOM + n + j] = whole[1, j] * stretch * scale * sinh * math.sqrt(1.0 + sinh * sinh)
        W[nodes.CLOSED * ROOM + n + j] = 0.0
    return 2 * n


@subroutine
def passage(h_end, rest, level, X, Y, target, rules, sizes, b, series, W):
    """The passage from h_end (from rest there, or not) to its turning point and back; Y != 0.

    Returns status and results.

    rules (2, 2, n): half rules and whole rules of rising order, packed side by side; sizes: how many
    nodes each has. Orders rise until two in turn agree to `target` (rad, relative in time).
    """
    h_turn = turning_point(h_end, rest, level, X, Y, b, series, W)
    if not h_turn > 0.0:
        return _BAD, Passage(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)
    turn = point(h_turn, X, Y, b, series)
    y_end = math.acosh(max(h_end / h_turn, 1.0))
    if not y_end > 0.0:
        return _BAD, Passage(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)
    length = min(_END_PANEL, 0.5 * y_end)
    y_cut = y_end - length
    closed = turn.D / (turn.shape**3 * math.sqrt(max(-turn.slope * b.inv_M, 1e-300)))
    race = closed * Y / h_turn * 2.0 * math.atan(math.tanh(0.5 * y_cut))
    chi = psi = time = math.nan
    angle_error = time_error = math.inf
    # What a unit of rounding in E - V does: the terms of V may be larger than their sum, the spin's
    # at the end most of all where I3 is small.
    gyration = 0.5 * b.I1 * turn.ratio * turn.ratio
    terms = abs(level) + gyration + abs(point(h_end, X, Y, b, series).V)
    # On a short panel the first nodes lie so near the turning point that E - V ~ y^2 has few digits.
    few = 1.0 + (2.0 + 2.5 / y_cut) / y_cut
    noise = _NOISE * _EPSILON * few * (1.0 + terms / max(-turn.slope, _EPSILON * gyration))
    scale, slow_noise = end_scale(h_turn, y_end, length, rest, level, X, Y, b, series)
    first = 0
    for size in sizes:
        half, whole = rules[0, :, first : first + size], rules[1, :, first : first + size]
        first += size
        n = lay_nodes(W, y_end, length, scale, closed, half, whole)
        nodes.place(W, n, h_end, h_turn, y_end)
        nodes.integrands(W, n, level, X, Y, b, series)
        new_chi = 2.0 * (race + nodes.total(W, nodes.CHI, n))
        new_psi = new_chi - 2.0 * nodes.total(W, nodes.REST, n)
        new_time = 2.0 * nodes.total(W, nodes.TIME, n)
        angle_error = max(abs(new_chi - chi), abs(new_psi - psi))
        time_error = abs(new_time / time - 1.0)
        chi, psi, time = new_chi, new_psi, new_time
        angle_noise = noise * (abs(race) + abs(chi) + abs(psi)) + slow_noise
        time_noise = noise + slow_noise / time
        # Rounding may keep two rules apart; what it leaves must still be what was asked for.
        floor = FLOOR * max(1.0, abs(chi))
        settled = angle_error <= max(target, angle_noise) and time_error <= max(target, time_noise)
        good = angle_error + angle_noise <= max(target, floor) and time_error + time_noise <= max(target, FLOOR)
        if settled and good:
            # Twice over: where rounding is all that is left, two rules may be wrong alike.
            angle_error, time_error = 2.0 * (angle_error + angle_noise), 2.0 * (time_error + time_noise)
            return _OK, Passage(h_turn, turn.ratio, chi, psi, time, angle_error, time_error)
    return _LIMIT, Passage(h_turn, turn.ratio, chi, psi, time, angle_error, time_error)


@subroutine
def start_of_fall(h_end, level, X, b, series):
    """(h, from rest) where the fall on F begins: h_end, or the turning point if that comes later."""
    if level >= point(h_end, X, 0.0, b, series).V:
        return h_end, False
    low, high = 0.0, h_end
    for _ in range(60):
        middle = 0.5 * (low + high)
        if level < point(middle, X, 0.0, b, series).V:
            high = middle
        else:
            low = middle
    return low, True


@subroutine
def fall(h_end, level, X, rules, sizes, b, series, W):
    """(time, increase of chi, increase of psi, error) of the fall on F from h_end to flat.

    Where the energy is too low for h_end the fall begins at rest, later. theta = start - scale sinh^2 x
    makes the square root of E - V smooth in x, however slow the start. Orders rise as in `passage`.
    """
    h, rest = start_of_fall(h_end, level, X, b, series)
    start = 2.0 * math.asin(0.5 * h)
    first = point(h, X, 0.0, b, series)
    kinetic_energy = 0.0 if rest else level - first.V
    slope = max(first.slope * first.shape / h, 0.0)
    bend = max(level - kinetic_energy - slope * start, 0.0) / (start * start)
    # The energy comes from a start at the vertical, where q = 1.
    rounding = _EPSILON * (magnitude(first, level, X, b) + 1.0)
    scale, slow = slow_start(kinetic_energy, slope, bend, start, rest, rounding)
    noise = slow_noise(slow, scale, rounding, first, b) + _NOISE * _EPSILON
    stretch = math.asinh(math.sqrt(start / scale))
    time = chi = psi = math.nan
    error = math.inf
    done = 0
    for n in sizes:
        for j in range(n):
            x = 0.5 * stretch * (1.0 + rules[1, 0, done + j])
            sinh = math.sinh(x)
            theta = max(start - scale * sinh * sinh, 1e-300)
            here = 2.0 * math.sin(0.5 * theta)
            dtheta = rules[1, 1, done + j] * stretch * scale * sinh * math.sqrt(1.0 + sinh * sinh)
            W[nodes.H * ROOM + j] = here
            W[nodes.LOG * ROOM + j] = 2.0 * math.log(here) - _LN2
            W[nodes.E2 * ROOM + j] = W[nodes.CLOSED * ROOM + j] = 0.0
            # integrands() takes weights in y, with dtheta = h tanh(y) dy / shape
            W[nodes.WEIGHT * ROOM + j] = dtheta * math.sqrt(1.0 - 0.25 * here * here) / here
        done += n
        nodes.integrands(W, n, level, X, 0.0, b, series)
        new_time, new_chi = nodes.total(W, nodes.TIME, n), nodes.total(W, nodes.CHI, n)
        new_psi = new_chi - nodes.total(W, nodes.REST, n)
        error = max(abs(new_time - time), max(abs(new_chi - chi), abs(new_psi - psi)))
        time, chi, psi = new_time, new_chi, new_psi
        if error <= noise * (1.0 + time):
            break
    return time, chi, psi, error + noise * (1.0 + time)
