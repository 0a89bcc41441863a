"""Makes extremes.json: passages at the extremes, from vertical to vertical, in 34-digit arithmetic.

Nothing here comes from the package. Chaplygin's solutions are hypergeometric functions; within
S = 1e-16 of flat, where the argument of the second one is 1 to working precision, its two leading
terms take over, matched at S = 1e-16. The integrals are sums of Gauss rules over unit pieces of
y = arcosh(h/h_m), halved towards the vertical and towards a crest of the potential; the race is
integrated like everything else.

    python tests/reference/make_extremes.py     # about ten minutes
"""

import itertools
import json
from functools import cache
from pathlib import Path

import mpmath as mp

mp.mp.dps = 34
HERE = Path(__file__).parent / "extremes.json"
UNIFORM, HOOP = (0.25, 0.5), (0.5, 1.0)
ON_LINE = 0.29143692640757906
CASES = [  # name, (I1, I3) in m r^2, sigma3_bar, eta_hat, phidot in sqrt(g/r)
    *((f"eta_hat = {sign}1e{k}", UNIFORM, 1.0, float(f"{sign}1e{k}"), 1.0)
      for k in (-1, -2, -3, -5, -8, -12, -16, -30, -100, -300) for sign in ("", "-")),
    *((f"speed {v:g}", HOOP, 1.0, -1e-4, v) for v in (1e-3, 1e-2, 1e2, 1e4, 1e6)),
    *((f"spin {s:g}", HOOP, s, s * 1e-4, s) for s in (1e2, 1e4, 1e6)),
    *((f"m r^2/I1 = {k:g}, flat", (1.0 / k, 2.0 / k), 0.5, 1e-3, 0.8) for k in (1e-6, 1e-3, 3.0, 1e3, 1e6)),
    *((f"I3/I1 = {k:g}", (0.4, 0.4 * k), 0.5, 1e-3, 0.8) for k in (1e-6, 1e-3, 0.1, 1.0)),
    *((f"c = 1/4 {d:+g}", (0.4, 0.4 * (0.25 + d) / (1.0 - 0.4 * (0.25 + d))), 0.5, 1e-3, 0.8)
      for d in (-1e-3, 0.0, 1e-3)),
    *((f"equilibrium at the vertical, phidot {v:g}", UNIFORM, 0.0, 0.1, v) for v in (1e-2, 1e-4, 1e-6, 1e-12)),
    # On l+, seen from face -1: eta_hat = 2 I1 r'(0) sigma3_bar / (I3 r(0)), and a crest before the well.
    *((f"separatrix, E/E_crest - 1 = {d:g}", UNIFORM, 0.2, ON_LINE, v)
      for d, v in ((1e-2, 0.13428816308909913), (1e-4, 0.043585614189378945), (1e-6, 0.04169376109742993),
                   (1e-12, 0.04167421335802686), (-1e-12, 0.04167421331892283), (-1e-6, 0.04165465640611945))),
    ("sigma3_bar = 0", UNIFORM, 0.0, 1e-5, 0.7),
    ("sigma3_bar = 0, eta_hat = 1e-200", HOOP, 0.0, 1e-200, 0.7),
]  # fmt: skip


@cache
def gauss(n):
    """Nodes and weights on [-1, 1] to working precision."""
    guesses = [mp.cos(mp.pi * (k - mp.mpf("0.25")) / (n + 0.5)) for k in range(1, n + 1)]
    nodes = [mp.findroot(lambda x: mp.legendre(n, x), (x, x + mp.mpf("1e-6"))) for x in guesses]
    slope = [n * (x * mp.legendre(n, x) - mp.legendre(n - 1, x)) / (x * x - 1) for x in nodes]
    rule = [(x, 2 / ((1 - x * x) * s * s)) for x, s in zip(nodes, slope, strict=True)]
    assert abs(sum(w for _, w in rule) - 2) < mp.mpf("1e-25")
    return rule


class Motion:
    """sigma3/h and sigma4 at h = 2 sin(theta/2), face +1, m = r = g = 1."""

    def __init__(self, inertia, sigma3_bar, eta_hat):
        self.I1, self.I3 = (mp.mpf(x) for x in inertia)
        self.J, self.M, self.k = self.I3 + 1, self.I1 + 1, self.I3 / self.I1
        self.c = self.I3 / (self.J * self.I1)
        root = mp.sqrt(1 - 4 * self.c)
        self.a, self.b = (1 + root) / 2, (1 - root) / 2
        self.r0, self.dr0 = self.rho(mp.mpf(1)), self.drho(mp.mpf(1))
        self.X, self.Y = mp.mpf(sigma3_bar) / self.r0, self.k * self.r0 * mp.mpf(eta_hat)
        near = mp.mpf("1e-16")
        self.offset = self.second(near)[1] - self.c / 2 * mp.log(near)

    def rho(self, S):
        return (S * mp.hyp2f1(self.a, self.b, 2, S / 2)).real

    def drho(self, S):
        return mp.hyp2f1(self.a, self.b, 1, S / 2).real

    def second(self, S):
        scale = 2 * self.r0 * self.dr0
        return (self.rho(2 - S) - self.rho(S)) / scale, -(self.drho(2 - S) + self.drho(S)) / scale

    def sigma(self, h):
        S = h * h / 2
        if mp.mpf("1e-16") > S:
            rho, drho, D, dD = S, mp.mpf(1), mp.mpf(1), self.c / 2 * mp.log(S) + self.offset
        else:
            rho, drho, (D, dD) = self.rho(S), self.drho(S), self.second(S)
        return self.X * rho / h + self.Y * D / h, (self.X * drho + self.Y * dD) / self.k

    def potential(self, h):
        ratio, s4 = self.sigma(h)
        shape2 = 1 - h * h / 4
        return self.I1 * ratio**2 / (2 * shape2) + self.J * s4**2 / 2 + h * mp.sqrt(shape2)


def landscape(f, energy, end):
    """h of the first turning point below `end`, and of a crest of the potential on the way, or None."""
    flat = f.J * (f.X / f.k) ** 2 / 2
    low = mp.log(abs(f.Y) * mp.sqrt(f.I1 / (2 * abs(energy - flat)))) - 3
    steps = [mp.log(end) - mp.mpf(j) / 40 for j in range(int(40 * (mp.log(end) - low)))]
    heights = [f.potential(end), *(f.potential(mp.e**x) for x in steps[1:120])]
    crest = None
    for j in range(1, len(heights) - 1):
        if heights[j - 1] < heights[j] > heights[j + 1]:
            x = bisect(lambda u: mp.diff(lambda v: f.potential(mp.e**v), u), steps[j + 1], steps[j - 1])
            crest = mp.e**x
            if f.potential(crest) > energy:
                found = bisect(lambda u: f.potential(mp.e**u) - energy, x, mp.log(end))
                return mp.e**found, None
    last = steps[1]
    for x in steps[2:]:
        if f.potential(mp.e**x) > energy:
            return mp.e ** bisect(lambda u: f.potential(mp.e**u) - energy, x, last), crest
        last = x
    raise ValueError("no turning point")


def bisect(function, low, high):
    """The root between low, where the function is positive, and high, where it is not."""
    for _ in range(130):
        middle = (low + high) / 2
        if function(middle) > 0:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def passage(inertia, sigma3_bar, eta_hat, phidot):
    """energy, theta_min, and chi, psi, time from vertical to vertical."""
    f = Motion(inertia, sigma3_bar, eta_hat)
    end = mp.sqrt(2)
    energy = f.M * mp.mpf(phidot) ** 2 / 2 + f.potential(end)
    turn, crest = landscape(f, energy, end)
    y_end = mp.acosh(end / turn)

    def rates(y):
        h = turn * mp.cosh(y)
        shape = mp.sqrt(1 - h * h / 4)
        speed = mp.sqrt(2 / f.M * (energy - f.potential(h)))
        dt = turn * mp.sinh(y) / (shape * speed)
        ratio, s4 = f.sigma(h)
        chi = dt * ratio / (h * shape * shape)
        return chi, chi - dt * (ratio * h / (2 - h * h / 2) + s4), dt

    whole = int(y_end) + 1
    edges = [y_end * j / whole for j in range(whole)]
    last = edges[-1]
    edges += [y_end - (y_end - last) / 2**j for j in range(1, 26)] + [y_end]
    if crest is not None:
        middle = mp.acosh(crest / turn)
        edges += [
            y for j in range(50) for y in (middle - mp.mpf(2) ** -j, middle + mp.mpf(2) ** -j) if 0 < y < y_end
        ]
        edges = sorted([*edges, middle])
    sums = [mp.mpf(0)] * 3
    for low, high in itertools.pairwise(edges):
        for x, w in gauss(20):
            values = rates((low + high) / 2 + (high - low) / 2 * x)
            sums = [s + w * (high - low) / 2 * v for s, v in zip(sums, values, strict=True)]
    return energy, 2 * mp.asin(turn / 2), *(2 * s for s in sums)


def main():
    rows = []
    for name, inertia, *case in CASES:
        values = passage(inertia, *case)
        row = {"name": name, "I1": inertia[0], "I3": inertia[1]}
        row |= dict(zip(("sigma3_bar", "eta_hat", "phidot"), case, strict=True))
        keys = ("energy", "theta_min", "delta_chi", "delta_psi", "duration")
        rows.append(row | {key: mp.nstr(value, 18) for key, value in zip(keys, values, strict=True)})
        print(name, rows[-1]["delta_chi"], flush=True)
        HERE.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
