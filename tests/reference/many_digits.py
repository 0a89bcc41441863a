"""Passages from vertical to vertical in 60 digits, quick enough for thousands: own arithmetic, with error bounds.

Nothing here comes from the package. Chaplygin's solutions are power series about flat, of 200 terms, in the ball
arithmetic of FLINT. The integrals are Gauss rules on pieces of y = arcosh(h/h_m), stretched where the motion is
slow, and halved until both halves agree with the whole.

Units: m = r = g = 1; face +1.
"""

import itertools
from functools import cache
from typing import NamedTuple

from flint import arb, arb_poly, ctx

ctx.prec = 200
TERMS = 200
_ORDER = 24
# A piece agrees this well with its halves, whose own error is then about the square of it.
_AGREED = 1e-12
_DEEPEST = 40
_HALF = arb(1) / 2


class Passage(NamedTuple):
    """Smallest tilt, and chi, psi and time from vertical to vertical."""

    theta_min: arb
    chi: arb
    psi: arb
    time: arb


@cache
def gauss():
    """Nodes and weights on [-1, 1]."""
    return [arb.legendre_p_root(_ORDER, k, weight=True) for k in range(_ORDER)]


class Motion:
    """The motion with constants sigma3_bar, eta_hat and speed phidot at the vertical."""

    def __init__(self, inertia, sigma3_bar, eta_hat, phidot):
        self.I1, self.I3 = (arb(x) for x in inertia)
        self.J, self.M, self.k = self.I3 + 1, self.I1 + 1, self.I3 / self.I1
        self.c = self.I3 / (self.J * self.I1)
        self.rho, self.v, r0 = series(self.c)
        self.drho, self.dv = self.rho.derivative(), self.v.derivative()
        self.X, self.Y = arb(sigma3_bar) / r0, self.k * r0 * arb(eta_hat)
        self.end = arb(2).sqrt()
        self.energy = self.M * arb(phidot) ** 2 / 2 + self.potential(self.end)

    def sigma(self, h):
        """sigma3/q and sigma4."""
        S = h * h / 2
        rho, drho, log_S = self.rho(S), self.drho(S), S.log()
        D = self.c / 2 * rho * log_S + self.v(S)
        dD = self.c / 2 * (drho * log_S + rho / S) + self.dv(S)
        shape = (1 - S / 2).sqrt()
        return (self.X * rho + self.Y * D) / (h * shape), (self.X * drho + self.Y * dD) / self.k, shape

    def potential(self, h):
        """V, eq. (3.8)."""
        ratio, s4, shape = self.sigma(h)
        return self.I1 * ratio**2 / 2 + self.J * s4**2 / 2 + h * shape

    def left(self, h):
        """E - V."""
        return (self.energy - self.potential(h)).mid()

    def rates(self, turn, y):
        """d(chi, psi, t)/dy at h = turn cosh y."""
        h = turn * y.cosh()
        ratio, s4, shape = self.sigma(h)
        left = self.energy - self.I1 * ratio**2 / 2 - self.J * s4**2 / 2 - h * shape
        dt = turn * y.sinh() / (shape * (2 / self.M * left).sqrt())
        chi = dt * ratio / (h * shape)
        return chi, chi * (1 - h * h / 2) - dt * s4, dt


def series(c):
    """rho and v as polynomials in S, and rho(1); eqs (5.1)-(5.3) and Lemma 2."""
    r, v = [arb(0), arb(1)], [arb(1)]
    for n in range(1, TERMS):
        r.append((c + n * (n - 1)) / (2 * n * (n + 1)) * r[n])
    v.append(arb(0))
    for k in range(1, TERMS):
        source = c / 2 * (2 * (2 * k + 1) * r[k + 1] - (2 * k - 1) * r[k])
        v.append(((k * (k - 1) + c) * v[k] - source) / (2 * k * (k + 1)))
    r0 = sum(r, arb(0))
    share = sum(v, arb(0)) / r0
    return arb_poly(r), arb_poly([a - share * b for a, b in zip(v, r, strict=True)]), r0


def root(f, low, high):
    """Where f, negative at low and positive at high, vanishes."""
    at_low, at_high = f(low), f(high)
    for step in range(400):
        guess = (low * at_high - high * at_low) / (at_high - at_low) if step % 3 else (low + high) / 2
        guess = guess.mid()
        value = f(guess)
        low, at_low, high, at_high = (guess, value, high, at_high) if value < 0 else (low, at_low, guess, value)
        if high - low < arb(2) ** -185 * (abs(high) + abs(low)) or value == 0:
            break
    return high


def least(f, low, high):
    """Where f has its minimum between low and high, by thirds."""
    for _ in range(100):
        one, other = (low + (high - low) * 0.382).mid(), (low + (high - low) * 0.618).mid()
        low, high = (low, other) if f(one) < f(other) else (one, high)
    return ((low + high) / 2).mid()


def turning_point(f, floor=-60):
    """(h at the first turning point, ln h of slow tilts on the way)."""
    end = f.end.log().mid()

    def left(x):
        return f.left(x.exp())

    xs = [end, *((end - arb(2) ** -n).mid() for n in range(60, 5, -1))]
    while xs[-1] > floor:
        xs.append((xs[-1] - (_HALF / 15 if xs[-1] > -3 else _HALF / 2)).mid())
    slow, seen = [], []
    for n, x in enumerate(xs):
        seen.append(left(x) if n else (f.energy - f.potential(f.end)).mid())
        if n > 1 and seen[-2] < seen[-3] and seen[-2] < seen[-1]:
            bottom = least(left, x, xs[n - 2])
            if left(bottom) < 0:
                return root(left, bottom, xs[n - 2]).exp().mid(), slow
            slow.append(bottom)
        if n and seen[-1] < 0:
            return root(left, x, xs[n - 1]).exp().mid(), slow
    return None, slow


def stretched(f, low, high, slow, width, square):
    """f(y) dy on low < y < high as a function of u and its bounds: y leaves `slow`, an end, like sinh(u) or, from
    rest, its square."""
    sign = 1 if slow is low else -1
    far = ((high - low) / width).mid()
    top = (far.sqrt() if square else far).asinh().mid()

    def of_u(u):
        s, c = u.sinh(), u.cosh()
        y, dy = (s * s, 2 * s * c) if square else (s, c)
        return tuple(width * dy * g for g in f(slow + sign * width * y))

    return of_u, arb(0), top


def rule(f, low, high):
    """Gauss's rule of three integrals."""
    half, middle, sums = (high - low) / 2, (high + low) / 2, [arb(0)] * 3
    for x, w in gauss():
        sums = [s + half * w * g for s, g in zip(sums, f((middle + half * x).mid()), strict=True)]
    return sums


def integral(f, low, high, whole=None, depth=0):
    """Three integrals over a piece, halved until the halves agree with the whole."""
    whole, middle = whole or rule(f, low, high), ((low + high) / 2).mid()
    left, right = rule(f, low, middle), rule(f, middle, high)
    sums = [a + b for a, b in zip(left, right, strict=True)]
    if depth > _DEEPEST:
        raise ArithmeticError("pieces do not settle")
    if (
        max(abs(float((a - b).mid())) / (1 + abs(float(a.mid()))) for a, b in zip(sums, whole, strict=True))
        < _AGREED
    ):
        return sums
    parts = integral(f, low, middle, left, depth + 1), integral(f, middle, high, right, depth + 1)
    return [a + b for a, b in zip(*parts, strict=True)]


def fall_angle(inertia, sigma3_bar, eta_hat, phidot):
    """What chi gains along the limit motion on F of the same sigma3_bar and energy, to flat and back.

    It begins at the vertical, or at rest where the energy is too low for that; None where it is too low for any.
    """
    given, f = Motion(inertia, sigma3_bar, eta_hat, phidot), Motion(inertia, sigma3_bar, 0, 0)
    f.energy = given.energy
    if not f.left(arb(10) ** -40) > 0:
        return None
    # On F sigma4 is more by eta_hat.
    moving = f.M * arb(phidot) ** 2 / 2 + f.J / 2 * (given.sigma(f.end)[1] ** 2 - f.sigma(f.end)[1] ** 2)
    rest = moving < 0
    start = root(lambda h: -f.left(h), arb(10) ** -40, f.end) if rest else f.end
    high = (2 * (start / 2).asin()).mid()

    def of_theta(theta):
        h = 2 * (theta / 2).sin()
        ratio, s4, shape = f.sigma(h)
        left = f.energy - f.I1 * ratio**2 / 2 - f.J * s4**2 / 2 - h * shape
        turn = ratio / (h * shape * (2 / f.M * left).sqrt())
        return turn, turn, turn

    inside = f.left(2 * (high / 4).sin())
    share = arb(1) if rest else arb(min(float((moving / inside).mid()), 1.0)) + arb(10) ** -60
    g, _low, top = stretched(of_theta, arb(0), high, high, high * share, True)
    pieces = max(1, int(float(top.mid()) / 3))
    parts = (integral(g, (top * j / pieces).mid(), (top * (j + 1) / pieces).mid())[0] for j in range(pieces))
    return 2 * sum(parts, arb(0))


def passage(inertia, sigma3_bar, eta_hat, phidot):
    """The passage, or None where the motion has no turning point on the way."""
    f = Motion(inertia, sigma3_bar, eta_hat, phidot)
    turn, slow = turning_point(f)
    if turn is None:
        return None

    def of_y(y):
        return f.rates(turn, y)

    def left(y):
        return f.left(turn * y.cosh())

    y_end = (f.end / turn).acosh().mid()
    stops = [arb(0), *sorted((x.exp() / turn).acosh().mid() for x in slow), y_end]
    sums = [arb(0)] * 3
    for number, (low, high) in enumerate(itertools.pairwise(stops)):
        middle = ((low + high) / 2).mid()
        at_end = number == len(stops) - 2
        for a, b, start, square in ((low, middle, low, False), (middle, high, high, at_end)):
            moving, inside = left(start), left(middle)
            here = f.M * arb(phidot) ** 2 / 2 if square else moving
            ratio = here / inside if inside > 0 and here > 0 else arb(1)
            # Towards a crest E - V grows like the square of the way, from a slow start also like the way.
            width = (b - a) * (ratio if square else ratio.sqrt() if (number and start is low) or not at_end else 1)
            if start is low and number == 0:
                width = (b - a).mid()
            width = arb(min(float(width.mid()), float((b - a).mid()))) + arb(10) ** -60
            g = stretched(of_y, a, b, start, width, square)
            pieces = max(1, int(float(g[2].mid()) / 3))
            for j in range(pieces):
                part = integral(g[0], (g[2] * j / pieces).mid(), (g[2] * (j + 1) / pieces).mid())
                sums = [s + p for s, p in zip(sums, part, strict=True)]
    chi, psi, time = (2 * s for s in sums)
    return Passage(2 * (turn / 2).asin(), chi, psi, time)
