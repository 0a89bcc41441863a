"""Motions from one flattest moment to the next in 40 digits: own arithmetic, nothing of it from the package.

Chaplygin's solutions are power series about flat in the numbers of FLINT, of 150 digits, so that E - V keeps 40 of
them wherever it is small. Integrals are tanh-sinh sums with the square root at turning points taken out, halved
until the digits that agree make 40 when doubled. `by_taylor` follows the equations of motion instead, without any
constant of motion.

Units: m = r = g = 1. x = ln tan(theta/2) on the face that a motion is seen from; psi as face +1 has it.
"""

import itertools
from functools import cache
from typing import NamedTuple

from flint import arb, arb_poly, ctx

ctx.prec = 512
TERMS = 220
_AGREED, _LARGEST_LEVEL, _FLAT = 1e-26, 11, arb(-100)
_TINY, _TURNED, _TAYLOR, _HALF = arb(2) ** -200, arb(2) ** -400, 80, arb(1) / 2


class Half(NamedTuple):
    """Smallest tilt, and chi, psi and time from it to the vertical or to the outer turning point."""

    theta_min: arb
    chi: arb
    psi: arb
    time: arb


class Motion(NamedTuple):
    """From a state on: time to the next flattest moment, and the stretches about this and the following one.

    faces: on which they are; a motion that does not cross the vertical has one stretch. fall_angle: of the limit
    motion with the same energy and sigma3_bar, to flat and back, None where there is none. state: sigma3, sigma4.
    """

    time: arb
    faces: tuple[int, ...]
    stretches: tuple[Half, ...]
    fall_angle: arb | None
    state: tuple[arb, arb]

    @property
    def theta_min(self):
        """The smallest tilt, a double."""
        return min(float(stretch.theta_min) for stretch in self.stretches)


class Place(NamedTuple):
    """V and dV/dx, sigma3/q, sigma4, q and z at some x."""

    V: arb
    slope: arb
    ratio: arb
    sigma4: arb
    q: arb
    z: arb


class Body:
    """Moments of inertia, and Chaplygin's solutions as polynomials in S; eqs (5.1)-(5.3) and Lemma 2."""

    def __init__(self, I1, I3):
        self.I1, self.I3 = arb(I1), arb(I3)
        self.J, self.M, self.k = self.I3 + 1, self.I1 + 1, self.I3 / self.I1
        c = self.c = self.I3 / (self.J * self.I1)
        r, v = [arb(0), arb(1)], [arb(1), arb(0)]
        for n in range(1, TERMS):
            r.append((c + n * (n - 1)) / (2 * n * (n + 1)) * r[n])
        for n in range(1, TERMS):
            source = c / 2 * (2 * (2 * n + 1) * r[n + 1] - (2 * n - 1) * r[n])
            v.append(((n * (n - 1) + c) * v[n] - source) / (2 * n * (n + 1)))
        share = sum(v, arb(0)) / sum(r, arb(0))
        self.rho = arb_poly(r)
        self.v = arb_poly([a - share * b for a, b in zip(v, r, strict=True)])
        self.drho, self.dv = self.rho.derivative(), self.v.derivative()
        self.r0, self.dr0, _, self.dD0 = self.solutions(arb(1))

    def solutions(self, S):
        """rho, rho', D and D'."""
        rho, drho, half_log = self.rho(S), self.drho(S), self.c / 2 * S.log()
        return rho, drho, half_log * rho + self.v(S), half_log * drho + self.c / 2 * rho / S + self.dv(S)

    def constants(self, S, sigma3, sigma4):
        """X and Y of a state."""
        rho, drho, D, dD = self.solutions(S)
        det, spin = rho * dD - drho * D, self.k * sigma4
        return (sigma3 * dD - spin * D) / det, (spin * rho - sigma3 * drho) / det

    def line(self, X):
        """Y on one face less that on the other: their sum."""
        return -2 * X * self.dr0 / self.dD0

    def at(self, x, X, Y):
        """The Place of a motion with these constants."""
        e = (2 * x).exp()
        rho, drho, D, dD = self.solutions(2 * e / (1 + e))
        q, z = 2 * x.exp() / (1 + e), (1 - e) / (1 + e)
        ratio, sigma4 = (X * rho + Y * D) / q, (X * drho + Y * dD) / self.k
        V = (self.I1 * ratio * ratio + self.J * sigma4 * sigma4) / 2 + q
        slope = self.J * q * ratio * sigma4 - self.I1 * z * ratio * ratio + q * z
        return Place(V, slope, ratio, sigma4, q, z)


body = cache(Body)


class Way:
    """A motion on one face: its constants and energy."""

    def __init__(self, of, X, Y, energy):
        self.body, self.X, self.Y, self.energy = of, X, Y, energy.mid()

    def left(self, x):
        """E - V, and the Place."""
        place = self.body.at(x, self.X, self.Y)
        return (self.energy - place.V).mid(), place

    def rates(self, x):
        """d(chi, psi, t)/dx."""
        left, at = self.left(x)
        ds = (self.body.M / (2 * left)).sqrt()
        return ds * at.ratio, ds * (at.z * at.ratio - at.q * at.sigma4), ds * at.q

    def turn(self, x, sign):
        """The next turning point inward (-1) or outward (+1), or the vertical, and crests of V on the way.

        No step passes a turning point: V'' is bounded over the 1/4 in x that one is at most.
        """
        b, crests, before = self.body, [], None
        while True:
            left, at = self.left(x)
            rise = (-sign * at.slope).mid()
            if before is not None and before[1] < 0 < rise:
                crests.append(self.crest(before[0], x))
            q = at.q * arb(0.25).exp()
            ratio = 2 * (abs(at.ratio) + b.k.sqrt() * q * abs(at.sigma4))
            sigma4 = abs(at.sigma4) + q * ratio / 4
            bound = (b.M * q**2 + 2 * b.I1) * ratio**2 + 2 * b.I3 * q * ratio * sigma4
            bound += b.J * b.k * (q * sigma4) ** 2 + q
            root = (rise**2 + 2 * bound * max(left, arb(0))).sqrt()
            step = ((root + rise) / bound if rise > 0 else 2 * left / (root - rise)).mid()
            if step < _TURNED or left < 0:
                return x, crests
            before, x = (x, rise), (x + sign * min(step, arb(0.25))).mid()
            if x >= 0 and sign > 0:
                return arb(0), crests

    def crest(self, low, high):
        """Where V' vanishes between."""
        sign = self.left(low)[1].slope
        for _ in range(60):
            middle = ((low + high) / 2).mid()
            low, high = (middle, high) if self.left(middle)[1].slope * sign > 0 else (low, middle)
        return middle

    def along(self, low, high, crests=()):
        """The integrals from low to high, between which no turning point is."""
        stops = sorted([low, high, *(x for x in crests if low < x < high)])
        parts = [self._piece(a, b) for a, b in itertools.pairwise(stops) if a < b]
        return [sum(column, arb(0)) for column in zip(*parts, strict=True)] if parts else [arb(0)] * 3

    def _piece(self, low, high):
        length = high - low
        turns = [self.left(x)[0] < length * _TINY for x in (low, high)]

        def of(a, rest):
            u, du = mapped(a, rest, *turns)
            return [length * du * g for g in self.rates((low + length * u).mid())]

        return tanh_sinh(of)

    def fall(self, top):
        """The integrals from flat to the tilt x = top, of a motion on F; in exp(x), where nothing is singular."""
        turns, end = self.left(top)[0] < _TINY, top.exp()

        def of(a, rest):
            u, du = mapped(a, rest, False, turns)
            return [du / u * g for g in self.rates((end * u).log().mid())]

        return tanh_sinh(of)


def mapped(a, rest, low, high):
    """From 0 to 1 as a is, a + rest = 1, and its derivative; quadratic at an end where the motion turns."""
    if low and high:
        return (arb.pi() * a / 2).sin() ** 2, arb.pi() / 2 * (arb.pi() * min(a, rest)).sin()
    if high:
        return a * (1 + rest), 2 * rest
    return (a * a, 2 * a) if low else (a, arb(1))


@cache
def nodes(level):
    """The new ones of the tanh-sinh rule with steps of 2^-level: share of the way, what is left of it, weight."""
    h, found, end = arb(2) ** -level, [], 17 * 2**level // 4
    for j in range(1, end, 2) if level else range(end + 1):
        t = j * h
        grown = (arb.pi() * t.sinh()).exp()
        near, far = (1 / (1 + grown)).mid(), (grown / (1 + grown)).mid()
        weight = (arb.pi() * t.cosh() * near * far).mid()
        found += [(near, far, weight), (far, near, weight)] if j else [(near, far, weight)]
    return found


def tanh_sinh(f):
    """Three integrals over shares of a way from 0 to 1."""
    sums, before = [arb(0)] * 3, None
    for level in range(_LARGEST_LEVEL):
        for a, rest, weight in nodes(level):
            sums = [s + weight * g for s, g in zip(sums, f(a, rest), strict=True)]
        now = [s.mid() / 2**level for s in sums]
        if before:
            off = max(abs(a - b) / max(1, abs(a)) for a, b in zip(now, before, strict=True))
            if max(off, abs(now[2] - before[2]) / now[2]) < _AGREED:
                return now
        before = now
    raise ArithmeticError("sums do not settle")


def fall_angle(of, X, energy):
    """What chi gains along the limit motion on F, to flat and back, from the vertical or from rest below it."""
    on_f = Way(of, X, arb(0), energy)
    if not on_f.left(_FLAT)[0] > 0:
        return None
    top = arb(0) if on_f.left(arb(0))[0] > 0 else on_f.turn(_FLAT, 1)[0]
    return 2 * on_f.fall(top)[0]


def followed(of, face, x, X, Y, thetadot, kinetic):
    """The Motion through x on a face, thetadot outward; kinetic: of the tilt."""
    start = of.at(x, X, Y)
    here = Way(of, X, Y, kinetic + start.V)
    inward = thetadot < 0
    low, crests = (_FLAT, []) if Y == 0 else here.turn(x, -1)
    high, more = here.turn(x, 1)
    crests += more
    beyond = None
    if high == 0 and here.left(high)[0] > _TINY**2:
        beyond = Way(of, X, of.line(X) - Y, here.energy)
    ahead = here.fall(x) if Y == 0 else here.along(low, x, crests)
    rest = here.along(x, high, crests)
    sums = [a + b for a, b in zip(ahead, rest, strict=True)]
    tilt = arb(0) if Y == 0 else 2 * low.exp().atan()
    near = Half(tilt, sums[0], face * sums[1], sums[2])
    halves, faces = [near], [face]
    time = ahead[2] if inward or x == high else sums[2] + rest[2]
    if beyond:
        far_low, far_crests = beyond.turn(arb(0), -1)
        chi, psi, back = beyond.along(far_low, arb(0), far_crests)
        halves.append(Half(2 * far_low.exp().atan(), chi, -face * psi, back))
        faces.append(-face)
        if not inward and x != low:
            time = rest[2] + back
            halves.reverse(), faces.reverse()
    whole = tuple(Half(h.theta_min, 2 * h.chi, 2 * h.psi, 2 * h.time) for h in halves)
    if x == low:
        time = arb(0)
    state = start.ratio * start.q, face * start.sigma4
    return Motion(time, tuple(faces), whole, fall_angle(of, X, here.energy), state)


def from_constants(inertia, phi, phidot, sigma3_bar, eta_hat, face=1):
    """The Motion with these constants from a tilt on this face; at the vertical it comes to the face first."""
    of = body(*inertia)
    X, Y = arb(sigma3_bar) / of.r0, of.k * of.r0 * arb(eta_hat)
    return followed(of, face, depth(phi), X, Y, -face * phidot, of.M * arb(phidot) ** 2 / 2)


def depth(phi):
    """x of a tilt phi."""
    return -abs(arb(phi)).tan().asinh().mid()


def from_state(inertia, phi, phidot, sigma3, sigma4):
    """The Motion through a state; from rest at the vertical it is on the face on which V falls."""
    of, tilt = body(*inertia), abs(arb(phi))
    face = 1 if (phi or phidot or sigma3 * sigma4) > 0 else -1
    X, Y = of.constants(1 - tilt.sin(), arb(sigma3), face * arb(sigma4))
    return followed(of, face, depth(phi), X, Y, -face * phidot, of.M * arb(phidot) ** 2 / 2)


def by_taylor(inertia, phi, phidot, sigma3, sigma4):
    """Time to the next flattest moment, the tilt there, and chi, psi and time of the period that begins there.

    The equations of motion of the state alone, in the time s with dt = q ds, by Taylor series.
    """
    of, q, z = body(*inertia), arb(phi).cos(), arb(phi).sin()
    y = [q, z, -arb(phidot), arb(sigma3) / q, arb(sigma4), arb(0), arb(0), arb(0)]
    seen = []
    while len(seen) < 2 or (len(seen) < 3 and seen[0][1] * seen[1][1] < 0):
        series = taylor(of, y)
        sizes = (abs(c[_TAYLOR]) for c in series)
        step = min(_HALF**4, *((_TINY / size) ** (arb(1) / _TAYLOR) for size in sizes if size > 0)).mid()
        after, p = [c(step).mid() for c in series], series[2]
        if y[2] * after[2] < 0:
            low, high = arb(0), step
            while high - low > step * _TINY:
                middle = ((low + high) / 2).mid()
                low, high = (middle, high) if p(middle) * y[2] > 0 else (low, middle)
            turned = [c(low).mid() for c in series]
            if turned[1] * after[2] > 0:
                seen.append(turned)
        y = after
    first, last = seen[0], seen[-1]
    tilt = 2 * (first[0] / (1 + abs(first[1]))).atan()
    return first[7], tilt, *(b - a for a, b in zip(first[5:], last[5:], strict=True))


def taylor(of, start):
    """Polynomials in s of q, z, p, sigma3/q, sigma4, chi, psi and t."""
    rows = [[value] for value in start]
    qp, zr, qs, pull = [], [], [], []

    def product(a, b, n):
        return sum((a[j] * b[n - j] for j in range(n + 1)), arb(0))

    for n in range(_TAYLOR):
        q, z, p, ratio, sigma4 = rows[:5]
        qp.append(product(q, p, n)), zr.append(product(z, ratio, n)), qs.append(product(q, sigma4, n))
        pull.append(of.J * product(ratio, sigma4, n) + z[n])
        rates = (
            *(product(z, qp, n), -product(q, qp, n)),
            (of.I1 * product(zr, ratio, n) - product(q, pull, n)) / of.M,
            of.k * product(qs, p, n) - product(zr, p, n),
            *(product(qp, ratio, n) / of.J, ratio[n], zr[n] - qs[n], q[n]),
        )
        for row, rate in zip(rows, rates, strict=True):
            row.append((rate / (n + 1)).mid())
    return [arb_poly(row) for row in rows]
