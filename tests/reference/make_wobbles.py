"""Makes wobbles.json: whole periods of motions that wobble about steady motion, by mpmath.

Nothing here comes from the package. V is made of hypergeometric functions, with as many digits more as E - V
loses as a difference; the integrals are sums over the phase between two roots, doubled until eighteen digits
agree. Wobbles whose height is below 1e-45 are summed as linear ones.

    python tests/reference/make_wobbles.py     # about five minutes
"""

import json
from pathlib import Path

import mpmath as mp
from make_passages import Chaplygin

mp.mp.dps = 70
HERE = Path(__file__).parent / "wobbles.json"
BODIES = {"uniform": (0.25, 0.5), "hoop": (0.5, 1.0), "heavy-core": (0.02, 0.04), "thin": (0.25, 1e-3)}  # I1, I3
STEADY = [  # body, tilt from flat, precession
    ("uniform", 0.17, 3.0),
    ("uniform", 1.2, -2.0),
    ("uniform", 1e-4, 150.0),
    ("hoop", 0.6, 1.5),
    ("heavy-core", 0.3, -4.0),
    ("thin", 0.5, 2.5),
    ("hoop", 1.57, 1.5),
]
SWINGS = (0.0, 1e-12, 1e-8, 1e-5, 1e-3, 0.1)  # amplitude in ln tan(theta/2), about


def slope(f, theta):
    """sin(theta) dV/dtheta."""
    q, z = mp.sin(theta), mp.cos(theta)
    s3, s4 = f.sigma(theta)
    rho = s3 / q
    return q * (f.J * rho * s4 + z) - f.I1 * z * rho * rho


def constants(f, theta, precession):
    """Doubles sigma3_bar and eta_hat of the steady motion with this tilt and precession: V' = 0."""
    q, z = mp.sin(theta), mp.cos(theta)
    s3 = precession * q * q
    s4 = z * (f.I1 * precession**2 * q - 1) / (f.J * precession * q)
    columns = []
    for unit in ((1, 0), (0, 1)):
        f.s3, f.eta_hat = map(mp.mpf, unit)
        columns.append(f.sigma(theta))
    (a, c), (b, d) = columns
    det = a * d - b * c
    return float((s3 * d - s4 * b) / det), float((s4 * a - s3 * c) / det)


def wobble(f, theta, rate):
    """Tilts of both turning points; period, chi and psi per period."""
    bottom = mp.findroot(lambda t: slope(f, t), (theta, theta * (1 + mp.mpf("1e-5"))))
    step = bottom * mp.mpf("1e-20")
    bend = (slope(f, bottom + step) - slope(f, bottom - step)) / (2 * step) / mp.sin(bottom)
    excess = f.M * rate * rate / 2 + f.potential(theta) - f.potential(bottom)
    if excess < mp.mpf("1e-45") * bend:
        return bottom, bottom, *turned(f, [(bottom, 2 * mp.pi * mp.sqrt(f.M / bend))])
    energy, guess = excess + f.potential(bottom), mp.sqrt(2 * excess / bend)

    def turning(sign):
        ends = sign, sign * mp.mpf("1.01")
        left = mp.findroot(
            lambda x: (f.potential(bottom + guess * x) - energy) / excess, ends, tol=mp.mpf("1e-44")
        )
        return bottom + guess * left

    low, high = turning(-1), turning(1)
    before, n = None, 12
    while True:
        nodes = []
        for j in range(n):
            phase = mp.pi * (2 * j + 1) / (2 * n)
            at = (low + high) / 2 + (high - low) / 2 * mp.cos(phase)
            left = 2 * (energy - f.potential(at)) / f.M
            nodes.append((at, 2 * mp.pi / n * (high - low) / 2 * mp.sin(phase) / mp.sqrt(left)))
        sums = turned(f, nodes)
        if before and max(abs(a - b) for a, b in zip(sums, before, strict=True)) < mp.mpf("1e-18"):
            return low, high, *sums
        before, n = sums, 2 * n


def turned(f, nodes):
    """Time, chi and psi of tilts with their shares of the period."""
    time = chi = psi = mp.mpf(0)
    for theta, dt in nodes:
        s3, s4 = f.sigma(theta)
        turn = s3 / mp.sin(theta) ** 2
        time, chi, psi = time + dt, chi + dt * turn, psi + dt * (mp.cos(theta) * turn - s4)
    return time, chi, psi


def row(name, theta, precession, swing):
    body = (1, 1, 1, *BODIES[name])
    bar, eta_hat = constants(Chaplygin(body, 1, 1), mp.mpf(theta), mp.mpf(precession))
    f = Chaplygin(body, bar, eta_hat)
    step = theta * mp.mpf("1e-15")
    bend = (slope(f, theta + step) - slope(f, theta - step)) / (2 * step) * mp.sin(theta)
    rate = float(swing * mp.sqrt(bend / f.M))
    names = ("inner", "outer", "period", "chi", "psi")
    found = dict(zip(names, (mp.nstr(x, 25) for x in wobble(f, mp.mpf(theta), mp.mpf(rate))), strict=True))
    given = {"theta": theta, "rate": rate, "sigma3_bar": bar, "eta_hat": eta_hat}
    return {"body": name, "I1": BODIES[name][0], "I3": BODIES[name][1], "swing": swing, **given, **found}


if __name__ == "__main__":
    rows = [row(*steady, swing) for steady in STEADY for swing in SWINGS]
    HERE.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
