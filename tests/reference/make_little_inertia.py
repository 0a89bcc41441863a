"""Makes little_inertia.json: whole periods of bodies whose I3 is little, in 60 digits by `many_digits`.

Their rates are of order 1. sigma_4 at flat is then of the size of 1/I3, and its square far larger than the energy.

    python tests/reference/make_little_inertia.py     # some ten seconds; needs python-flint
"""

import json
from pathlib import Path

import many_digits
import numpy as np
from flint import arb

HERE = Path(__file__).parent / "little_inertia.json"
BODIES = ((0.25, 1e-2), (0.25, 1e-3), (1.5, 1e-4), (0.25, 1e-6), (1.0, 1e-8))  # I1, I3
PER_BODY = 8
LOOKED_AT = (*np.linspace(1.0, 0.0, 61)[1:-1], *(10.0**-k for k in range(2, 9)), 0.0)  # of sin(phi) of the state


class Motion:
    """The motion through a state that is given by doubles; `eta` of the face it is on, and of the other."""

    def __init__(self, inertia, phi, phidot, sigma3, sigma4):
        f = many_digits.Motion(inertia, 0, 0, 0)
        self.inertia, self.chart = (f.I1, f.I3), f
        self.face, self.z, q = 1 if phi >= 0 else -1, arb(phi).sin().mid(), arb(phi).cos()
        rho, drho, D, dD = self.solutions(1 - abs(self.z))
        self.r0, self.dr0, _D, _dD = self.solutions(arb(1))
        spin = f.k * arb(sigma4) * self.face
        self.sigma3_bar = self.r0 * (spin * D - arb(sigma3) * dD)
        near = f.I1 * (arb(sigma3) * drho - spin * rho)
        far = 2 * f.I1 * self.dr0 * self.sigma3_bar - near
        self.eta = {self.face: near, -self.face: far}
        kinetic = f.M * arb(phidot) ** 2 + f.I1 * (arb(sigma3) / q) ** 2 + f.J * arb(sigma4) ** 2
        self.on_face = self.of(self.face)
        self.on_face.energy = kinetic / 2 + q

    def solutions(self, S):
        """rho, rho', D and D' at S."""
        f, log_S = self.chart, S.log()
        rho, drho = f.rho(S), f.drho(S)
        return rho, drho, f.c / 2 * rho * log_S + f.v(S), f.c / 2 * (drho * log_S + rho / S) + f.dv(S)

    def of(self, face, phidot=0):
        """The motion as seen from a face, and how fast it is at the vertical there."""
        eta_hat = self.eta[face] / (self.inertia[1] * self.r0)
        return many_digits.Motion(self.inertia, self.sigma3_bar, eta_hat, phidot)

    def left(self, z):
        """E - V at sin(phi) = z on the state's face."""
        return self.on_face.left((2 * (1 - z)).sqrt())

    def way_out(self):
        """sin(phi) where the motion turns back on its way to the vertical; None if it comes there."""
        tried = [(abs(self.z) * arb(t)).mid() for t in sorted(LOOKED_AT, reverse=True)]
        before = abs(self.z)
        for z in tried:
            if self.left(z) < 0:
                return many_digits.root(self.left, z, before)
            before = z
        return None

    def period(self):
        """Smallest tilt, chi, psi and time of a period; and whether the vertical is crossed."""
        out = self.way_out()
        if out is None:
            phidot = (2 * self.left(arb(0)) / self.chart.M).sqrt().mid()
            parts = [
                many_digits.passage(
                    self.inertia, self.sigma3_bar, self.eta[face] / (self.inertia[1] * self.r0), phidot
                )
                for face in (1, -1)
            ]
            plus, minus = parts
            least = min(float(p.theta_min.mid()) for p in parts)
            return least, plus.chi + minus.chi, plus.psi - minus.psi, plus.time + minus.time, True
        f = self.on_face
        f.end = (2 * (1 - abs(self.z))).sqrt().mid()
        turn, _slow = many_digits.turning_point(f)
        y_end, start = ((2 * (1 - out)).sqrt() / turn).acosh().mid(), arb(0)
        sums, middle = [arb(0)] * 3, (y_end / 2).mid()
        for low, high, slow in ((start, middle, start), (middle, y_end, y_end)):
            part, bottom, top = many_digits.stretched(
                lambda y: f.rates(turn, y), low, high, slow, (high - low).mid(), slow is y_end
            )
            sums = [a + b for a, b in zip(sums, many_digits.integral(part, bottom, top), strict=True)]
        chi, psi, time = (2 * s for s in sums)
        return float((2 * (turn / 2).asin()).mid()), chi, self.face * psi, time, False


def make(seed=11):
    """Rows of the file."""
    rng, rows = np.random.default_rng(seed), []
    for body in BODIES:
        for _ in range(PER_BODY):
            state = rng.uniform(-1.4, 1.4), *rng.normal(0.0, 1.0, 3)
            theta_min, *turned, crosses = Motion(tuple(map(arb, body)), *state).period()
            chi, psi, time = (float(x.mid()) for x in turned)
            rows.append(
                {"body": body, "state": state, "theta_min": theta_min, "chi": chi, "psi": psi, "period": time}
                | {"crosses": crosses}
            )
    return rows


if __name__ == "__main__":
    HERE.write_text("[\n" + ",\n".join(json.dumps(row) for row in make()) + "\n]\n", encoding="utf-8")
