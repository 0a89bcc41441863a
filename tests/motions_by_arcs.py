"""Whole motions put together from arcs: what `kernels.arcs` gives, checked before anything calls it."""

from functools import cache
from typing import NamedTuple

import numpy as np

from explorer.motion.starts import fallen, held_constants, orbit_starts, seen_from
from explorer.phase.constants import natural_constants
from kernels.arcs import nutation as N
from kernels.arcs import rules as Ru
from kernels.arcs import turning_points as T
from kernels.arcs.potential import make_chart
from kernels.arcs.rules import ArcRow, Arcs
from kernels.arcs.turning_points import Starts, Place

_SLOW = 0.05
_LONG, _PIECE = 3.0, 1.0
_LEAST = 1e-14
_AT_FLAT = 60.0
_NEWTON, _CLOSE = 30, 0.1
rule = cache(Ru.make_rule)
points = cache(N.make_points)


OUT = object()


def searched(kernel, starts, chart):
    out = np.empty((10, starts.X.size))
    kernel(starts, chart, out) if kernel is not OUT else T.orbit_batch(starts, chart, np.empty_like(out), out, np.empty_like(out))
    return Place(*out)


def point(starts, d, inward, chart):
    out = np.empty((10, starts.X.size))
    T.point_batch(starts, np.ascontiguousarray(d), inward, chart, out)
    return Place(*out)


def from_end(X, Y, end):
    return Starts(*map(np.ascontiguousarray, (X, Y, end.K, end.r, end.w, end.sigma3, end.sigma4)))


def take(row, rows):
    return type(row)(*(c[rows] for c in row))


def slow_of(end):
    slope, bend, K = abs(end.slope), -end.bend, end.K
    with np.errstate(all="ignore"):
        inside = slope * slope - 2 * bend * K
        moving = 2 * K / np.where(inside >= 0, slope + np.sqrt(inside), np.sqrt(2 * bend * K))
        turning = np.where(bend > 0, 2 * slope / bend, np.inf)
    slow = np.where(K > 0, moving, turning)
    return np.where(slow < _SLOW, np.maximum(slow, _LEAST), np.inf)


class Pieces(NamedTuple):
    owner: np.ndarray
    X: np.ndarray
    Y: np.ndarray
    L: np.ndarray
    inner: Place
    outer: Place
    slow_in: np.ndarray
    slow_out: np.ndarray


def pick(p, rows):
    return Pieces(
        p.owner[rows],
        p.X[rows],
        p.Y[rows],
        p.L[rows],
        take(p.inner, rows),
        take(p.outer, rows),
        p.slow_in[rows],
        p.slow_out[rows],
    )


def put_rows(row, rows, new):
    return type(row)(*(_put(a, rows, b) for a, b in zip(row, new, strict=True)))


def _put(a, rows, b):
    a = a.copy()
    a[rows] = b
    return a


def joined(a, b):
    def both(x, y):
        return (
            type(x)(*map(np.concatenate, zip(x, y, strict=True)))
            if isinstance(x, Place)
            else np.concatenate((x, y))
        )

    return Pieces(*(both(x, y) for x, y in zip(a, b, strict=True)))


def cut(p, rows, d, slow, chart):
    """Cut pieces `rows` at distance d from their outer ends."""
    q = pick(p, rows)
    L = q.L
    C = point(from_end(q.X, q.Y, q.outer), d, True, chart)
    D = point(from_end(q.X, q.Y, q.inner), L - d, False, chart)
    C = Place(*(np.where(d <= 0.5 * L, a, b) for a, b in zip(C, D, strict=True)))
    s = slow_of(C) if slow else np.full(d.size, np.inf)
    upper = q._replace(L=d, inner=C, slow_in=s)
    lower = q._replace(L=L - d, outer=C, slow_out=s)
    keep = np.setdiff1d(np.arange(p.L.size), rows)
    return joined(joined(pick(p, keep), upper), lower)


def cut_at_crests(p, crest, chart):
    rows = np.flatnonzero(crest > 0)
    if not rows.size:
        return p
    q = pick(p, rows)
    start = from_end(q.X, q.Y, q.outer)
    d = crest[rows].copy()
    for _ in range(_NEWTON):
        P = point(start, np.where(d > 0, d, 0.0), True, chart)
        with np.errstate(all="ignore"):
            step = np.where(P.bend < 0, np.clip(P.slope / P.bend, -_CLOSE, _CLOSE), np.nan)
        d = d + step
        if not (abs(step) > 4e-16 * d).any():
            break
    P = point(start, np.where(d > 0, d, 0.0), True, chart)
    good = (d > 0) & (d < q.L) & (0.5 * _SLOW * _SLOW * abs(P.bend) > P.K)
    return cut(p, rows[good], d[good], True, chart) if good.any() else p


def cut_slow(p, chart):
    si, so = np.isfinite(p.slow_in), np.isfinite(p.slow_out)
    long = p.L > _LONG
    both = si & so & (np.where(si & so, np.maximum(p.slow_in, p.slow_out), 0.0) < p.L)
    rows = np.flatnonzero(both | (long & (si | so)))
    if not rows.size:
        return p
    L = p.L[rows]
    d = np.where(long[rows], np.where(so[rows], _PIECE, L - _PIECE), 0.5 * L)
    return cut(p, rows, d, False, chart)


def integrals(p, accuracy, chart, n):
    """Sums over pieces by owner."""
    p = pick(p, np.flatnonzero(p.L > 0))
    turn_in, turn_out = p.inner.K == 0, p.outer.K == 0
    kind = np.where(
        turn_in, np.where(turn_out, Ru.TWO_TURNS, Ru.TURN_INSIDE), np.where(turn_out, Ru.TURN_OUTSIDE, Ru.NO_TURN)
    )
    return add_up(arcs_of(p, kind), p.owner, accuracy, chart, n)


def arcs_of(p, kind):
    i, o = p.inner, p.outer
    return Arcs(
        *map(
            np.ascontiguousarray,
            (
                kind,
                p.X,
                p.Y,
                p.L,
                i.r,
                i.w,
                i.sigma3,
                i.sigma4,
                i.K,
                p.slow_in,
                o.r,
                o.w,
                o.sigma3,
                o.sigma4,
                o.K,
                p.slow_out,
            ),
        )
    )


def add_up(arcs, owner, accuracy, chart, n):
    out = np.empty((5, arcs.X.size))
    Ru.arc_batch(arcs, accuracy, rule(), chart, out)
    if owner.size == n and (owner == np.arange(n)).all():
        return ArcRow(*out)
    return ArcRow(*(np.bincount(owner, weights=row, minlength=n) for row in out))


def between(X, Y, L, inner, outer, crest, accuracy, chart):
    """Arcs of motions; crest from the outer end."""
    n = X.size
    p = Pieces(np.arange(n), X, Y, L, inner, outer, slow_of(inner), slow_of(outer))
    p = cut_slow(cut_at_crests(p, crest, chart), chart)
    return integrals(p, accuracy, chart, n)


def on_f(b, vertical, X, Y, chart):
    """(start at the vertical of the motion on F, level)."""
    eta_hat = Y / (b.r0 * b.k)
    s4 = vertical.sigma4 + eta_hat
    K = vertical.K - 0.5 * b.J * eta_hat * (vertical.sigma4 + s4)
    one = np.ones(X.size)
    start = Starts(X, 0 * X, K, one, 0 * X, np.ascontiguousarray(vertical.sigma3), s4)
    return start, point(start, np.full(X.size, _AT_FLAT), True, chart).K


def falls(b, vertical, X, Y, accuracy, chart):
    """(ArcRow of the falls once, level)."""
    start, level = on_f(b, vertical, X, Y, chart)
    n = X.size
    out = [np.full(n, np.nan) for _ in range(5)]
    rows = np.flatnonzero(level > 0)
    if rows.size:
        s = take(start, rows)
        rest = s.K < 0
        begin = point(s, np.zeros(rows.size), True, chart)
        if rest.any():
            got = searched(T.rest_batch, take(s, rest), chart)
            begin = put_rows(begin, rest, got._replace(K=0 * got.K))
        slow = slow_of(begin)
        n2 = rows.size
        own = np.arange(n2)
        C = begin
        first = None
        is_slow = np.isfinite(slow)
        if is_slow.any():
            k = np.flatnonzero(is_slow)
            bk = take(begin, k)
            Xk = s.X[k]
            C1 = point(from_end(Xk, 0 * Xk, bk), np.full(k.size, _PIECE), True, chart)
            p = Pieces(k, Xk, 0 * Xk, np.full(k.size, _PIECE), C1, bk, np.full(k.size, np.inf), slow[k])
            first = integrals(p, accuracy, chart, n2)
            C = put_rows(begin, k, C1)
        kind = np.where(C.K == 0, Ru.FALL_FROM_REST, Ru.FALL)
        inf = np.full(n2, np.inf)
        p = Pieces(own, s.X, 0 * s.X, np.ones(n2), C, C, inf, inf)
        row = add_up(arcs_of(p, kind), own, accuracy, chart, n2)
        if first is not None:
            row = ArcRow(*(a + b_ for a, b_ in zip(row, first, strict=True)))
        for o, c in zip(out, row, strict=True):
            o[rows] = c
    return ArcRow(*out), level


class Orbits(NamedTuple):
    energy: np.ndarray
    crosses: np.ndarray
    lead: ArcRow
    theta_here: np.ndarray
    theta_error: np.ndarray
    here: ArcRow
    theta_there: np.ndarray
    there: ArcRow
    fall: ArcRow
    level: np.ndarray


def orbits(b, chart, X, Y, Y_far, r, w, rate, s3, s4, accuracy, lead=True, fall=True):
    n = X.size
    K = 0.5 * b.M * rate * rate
    start = Starts(*map(np.ascontiguousarray, (X, Y, K, r, w, s3, s4)))
    state = point(start, np.zeros(n), True, chart)
    down = searched(T.inward_batch, start, chart)
    up = searched(OUT, start, chart)
    upright = np.where(w > 0.5, -np.log(r), -0.5 * np.log1p(-w))
    V = point(start, upright, False, chart)
    crosses = up.K > 0
    V = V._replace(r=np.ones(n), w=np.zeros(n))
    beyond = V._replace(sigma4=-V.sigma4, slope=-V.slope)
    far_start = Starts(
        X,
        Y_far,
        *(
            np.ascontiguousarray(c)
            for c in (np.where(crosses, V.K, 1.0), beyond.r, beyond.w, beyond.sigma3, beyond.sigma4)
        ),
    )
    far = Place(*np.full((10, n), np.nan))
    k = np.flatnonzero(crosses)
    if k.size:
        far = put_rows(far, k, searched(T.inward_batch, take(far_start, k), chart))
    outer = up
    L = down.d + up.d
    well = L + np.where(crosses, far.d, 0.0)
    wide = ~(well < N.WIDEST)
    res = [ArcRow(*np.full((5, n), np.nan)) for _ in range(3)]
    here, there, leads = res
    with np.errstate(invalid="ignore"):
        k = np.flatnonzero(wide & np.isfinite(well))
    if k.size:
        crest = np.fmax(
            np.where(np.isnan(down.crest), np.nan, up.d + down.crest),
            np.where(np.isnan(up.crest), np.nan, up.d - up.crest),
        )
        here = put_rows(
            here, k, between(X[k], Y[k], L[k], take(down, k), take(outer, k), crest[k], accuracy, chart)
        )
        if lead:
            leads = put_rows(
                leads,
                k,
                between(X[k], Y[k], down.d[k], take(down, k), take(state, k), down.crest[k], accuracy, chart),
            )
        k = k[crosses[k]]
        there = put_rows(
            there,
            k,
            between(X[k], Y_far[k], far.d[k], take(far, k), take(beyond, k), far.crest[k], accuracy, chart),
        )
    k = np.flatnonzero(~wide)
    if k.size:
        wl = N.Wells(
            from_end(X[k], Y[k], take(down, k)),
            well[k],
            down.d[k],
            np.where(crosses[k], L[k], np.inf),
            Y_far[k],
            np.ascontiguousarray(V.sigma3[k]),
            np.ascontiguousarray(beyond.sigma4[k]),
        )
        out = np.empty((15, k.size))
        N.well_batch(wl, points(), chart, out)
        whole, st, vert = ArcRow(*out[:5]), ArcRow(*out[5:10]), ArcRow(*out[10:])
        c = crosses[k]
        here = put_rows(here, k, ArcRow(*(np.where(c, v, a) for v, a in zip(vert, whole, strict=True))))
        leads = put_rows(leads, k, st)
        kk = k[c]
        rest = ArcRow(*(a[c] - v[c] if j < 3 else a[c] for j, (a, v) in enumerate(zip(whole, vert, strict=True))))
        there = put_rows(there, kk, rest._replace(psi=-rest.psi))
    fl, level = falls(b, V, X, Y, accuracy, chart) if fall else (None, None)
    energy = K + 0.5 * b.I1 * (s3 * (1 + r * r) / (2 * r)) ** 2 + 0.5 * b.J * s4 * s4 + 2 * r / (1 + r * r)
    return Orbits(
        energy, crosses, leads, 2 * np.arctan(down.r), down.error, here, 2 * np.arctan(far.r), there, fl, level
    )


def orbits_of(states, accuracy, **asked):
    """(Orbits, which states, status): the motions through states, natural units; those on F are left out."""
    b = states.disk.body
    status, linear = held_constants(states, natural_constants(states))
    q, z, p, ratio, sigma4 = states.rows
    # At rest on the vertical, the face on which V falls.
    face = np.where((z == 0) & (p == 0) & (ratio * sigma4 < 0), -1.0, seen_from(states, linear))
    status, plus = fallen(orbit_starts(states, linear), status), face > 0
    near = np.where(plus, linear.eta_plus, linear.eta_minus) / b.I1
    far = np.where(plus, linear.eta_minus, linear.eta_plus) / b.I1
    rate, spin = np.where(plus, p, -p), np.where(plus, sigma4, -sigma4)
    columns = (
        linear.sigma3_bar / b.r0,
        near,
        far,
        q / (1 + abs(z)),
        2 * abs(z) / (1 + abs(z)),
        rate,
        q * ratio,
        spin,
    )
    rows = np.flatnonzero(status == 0)
    chart = make_chart(states.disk.natural)
    return orbits(b, chart, *(np.ascontiguousarray(c[rows]) for c in columns), accuracy, **asked), rows, status
