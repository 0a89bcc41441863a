"""Makes passages.json: passages from vertical to vertical in 40-digit arithmetic.

Nothing here comes from the package: Chaplygin's solutions are hypergeometric functions, theta_min
is a root of the amended potential, and the integrals are tanh-sinh sums over many pieces, graded
towards the turning point and towards the vertical (where a slow start makes a near-singularity
that a fixed rule misses).

    python tests/reference/make_passages.py     # about five minutes
"""

import itertools
import json
from pathlib import Path

import mpmath as mp

mp.mp.dps = 40
HERE = Path(__file__).parent / "passages.json"
BODIES = {  # m, r, g, I1, I3
    "uniform": (1, 1, 1, 0.25, 0.5),
    "hoop": (1, 1, 1, 0.5, 1.0),
    "heavy-core": (1, 1, 1, 0.02, 0.04),
    "thick": (1, 1, 1, 0.5, 0.3),
    "coin": (0.0057, 0.0121, 9.81, 2.086e-07, 4.17e-07),
}
CASES = [  # body, sigma3_bar, eta_hat, phidot at the vertical
    ("uniform", 1.0, 0.01, 1.0),
    ("uniform", 1.0, -0.01, 1.0),
    ("uniform", 1.0, 1e-6, 1.0),
    ("uniform", 1.0, -1e-6, 1.0),
    ("uniform", 1.175, -0.0205, 0.104),
    ("hoop", -1.5856, 0.0025379, 0.4395),
    ("hoop", -1.0088, -0.007657, 0.15263),
    ("hoop", 0.0, 0.03, 2.5),
    ("heavy-core", 1.5239, 0.0087863, 1.2124),
    ("heavy-core", 1.7487, 0.00014288, 0.154828),
    ("thick", 0.85209, -0.0072288, 3.461288),
    ("thick", -1.1286, 1e-4, 0.5),
    ("coin", 27.922, 0.00158, 7.5387),
    ("coin", 10.332, -0.03475, 18.163),
]


class Chaplygin:
    """sigma3 and sigma4 at a tilt theta from flat (face +1), by hypergeometric functions."""

    def __init__(self, body, sigma3_bar, eta_hat):
        m, r, g, I1, I3 = (mp.mpf(x) for x in body)
        self.m, self.r, self.g, self.I1, self.I3 = m, r, g, I1, I3
        self.J, self.M = I3 + m * r * r, I1 + m * r * r
        root = mp.sqrt(1 - 4 * m * r * r * I3 / (self.J * I1))
        self.a, self.b = (1 + root) / 2, (1 - root) / 2
        self.s3, self.eta_hat = mp.mpf(sigma3_bar), mp.mpf(eta_hat)
        self.r0, self.dr0 = self.rho(mp.mpf(1)), self.drho(mp.mpf(1))

    def rho(self, S):
        return (S * mp.hyp2f1(self.a, self.b, 2, S / 2)).real

    def drho(self, S):
        return mp.hyp2f1(self.a, self.b, 1, S / 2).real

    def sigma(self, theta):
        S, k, scale = 2 * mp.sin(theta / 2) ** 2, self.I3 / self.I1, 2 * self.r0 * self.dr0
        rho, drho = self.rho(S), self.drho(S)
        D, dD = (self.rho(2 - S) - rho) / scale, -(self.drho(2 - S) + drho) / scale
        X, Y = self.s3 / self.r0, k * self.r0 * self.eta_hat
        return X * rho + Y * D, (X * drho + Y * dD) / k

    def potential(self, theta):
        s3, s4 = self.sigma(theta)
        q = mp.sin(theta)
        return self.I1 * s3**2 / (2 * q * q) + self.J * s4**2 / 2 + self.m * self.g * self.r * q


def passage(body, sigma3_bar, eta_hat, phidot):
    """energy, theta_min, and chi, psi, time from vertical to vertical."""
    f = Chaplygin(body, sigma3_bar, eta_hat)
    energy = f.M * mp.mpf(phidot) ** 2 / 2 + f.potential(mp.pi / 2)
    flat = f.I1**2 * f.J * f.s3**2 / (2 * f.I3**2 * f.r0**2)
    guess = mp.log(abs(f.eta_hat) * f.I3 * f.r0 / mp.sqrt(2 * f.I1 * (energy - flat)))
    turn = mp.e ** mp.findroot(lambda x: f.potential(mp.e**x) - energy, (guess, guess + mp.mpf("0.01")))

    def rates(u):
        theta = turn + u * u
        left = energy - f.potential(theta)
        if left <= 0:
            return mp.mpf(0), mp.mpf(0), mp.mpf(0)
        dt = 2 * u / mp.sqrt(2 / f.M * left)
        s3, s4 = f.sigma(theta)
        q, z = mp.sin(theta), mp.cos(theta)
        return dt * s3 / q**2, dt * (z * s3 / q**2 - s4), dt

    end, scale = mp.sqrt(mp.pi / 2 - turn), mp.sqrt(turn)
    edges = [scale * mp.mpf(2) ** j for j in range(-2, 60) if scale * mp.mpf(2) ** j < end / 2]
    edges = [mp.mpf(0), *edges, *(end * (1 - mp.mpf(2) ** -j) for j in range(1, 22)), end]
    mp.mp.dps = 25
    sums = [mp.mpf(0)] * 3
    for low, high in itertools.pairwise(edges):
        for i in range(3):
            sums[i] += mp.quad(lambda u, i=i: rates(u)[i], [low, high], maxdegree=5)
    mp.mp.dps = 40
    return energy, turn, *(2 * s for s in sums)


def main():
    rows = []
    for name, *case in CASES:
        energy, theta, chi, psi, time = passage(BODIES[name], *case)
        row = {"disk": name, **dict(zip(("m", "r", "g", "I1", "I3"), BODIES[name], strict=True))}
        row |= dict(zip(("sigma3_bar", "eta_hat", "phidot"), case, strict=True))
        results = {"energy": energy, "theta_min": theta, "delta_chi": chi, "delta_psi": psi, "duration": time}
        rows.append(row | {key: mp.nstr(value, 20) for key, value in results.items()})
        print(rows[-1], flush=True)
    HERE.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
