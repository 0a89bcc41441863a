"""The work every solver is given: the contact angle just after the first passage near flat.

Uniform disk, m = g = r = 1; phi = 0, phidot = 1, sigma3 = 1, sigma4 = sigma4(F) - eta_hat with |eta_hat|
log-uniform from 1e-6 to 1e-1, both signs; chi at t = 1.6. On the plain equations (2.15)-(2.18) in
(phi, phidot, sigma3, sigma4, chi), and on the regularised ones in (q, z, p, rho, sigma4, chi) with dt = q ds,
where each trajectory is followed to its own s with t(s) = 1.6.
"""

from functools import cache
from typing import NamedTuple

import mpmath as mp
import numpy as np

import explorer as ex

DISK = ex.Disk.uniform()
I1, I3 = DISK.I1, DISK.I3
M, J, K, KAPPA2 = I1 + 1.0, I3 + 1.0, I3 / I1, 1.0 + 1.0 / I1
T_END = 1.6
COUNT = 256


class Work(NamedTuple):
    """Starts as columns, ends in s, chi there, and chi over a whole passage, vertical to vertical."""

    eta_hat: np.ndarray
    plain: np.ndarray
    regular: np.ndarray
    s_end: np.ndarray
    chi: np.ndarray
    passage: np.ndarray


def plain_field(v, sin, cos):
    """d/dt of (phi, phidot, sigma3, sigma4, chi); any kind of number."""
    q, z = cos(v[0]), sin(v[0])
    return [
        v[1],
        (-I1 * z * v[2] * v[2] / (q * q * q) + J * v[2] * v[3] / q + z) / M,
        -K * q * v[1] * v[3],
        -v[1] * v[2] / (q * J),
        v[2] / (q * q),
    ]


def regular_field(v):
    """d/ds of (q, z, p, rho, sigma4, chi); any kind of number."""
    q, z, p, rho, s4 = v[:5]
    return [
        z * q * p,
        -q * q * p,
        z * rho * rho * (1.0 / KAPPA2) - q * (J / M * rho * s4 + (1.0 / M) * z),
        K * q * s4 * p - z * rho * p,
        (1.0 / J) * q * p * rho,
        rho,
    ]


def line_slope():
    """sigma4 / sigma3 on l+ to 30 digits: I1 r'(0) / (I3 r(0)), eqs (5.11), (5.12)."""
    with mp.workdps(30):
        root = mp.sqrt(1 - 4 * mp.mpf(I3) / (J * I1))
        a, b, half = (1 + root) / 2, (1 - root) / 2, mp.mpf(1) / 2
        return (I1 * mp.hyp2f1(a, b, 1, half) / (I3 * mp.hyp2f1(a, b, 2, half))).real


@cache
def work():
    """256 trajectories, with references by heyoka's Taylor method in extended precision.

    A state in doubles knows eta to 1e-16 only, so what is followed is the state with the exact eta.
    """
    import heyoka as hy

    number = np.longdouble
    rng = np.random.default_rng(0)
    eta_hat = 10.0 ** rng.uniform(-6, -1, COUNT) * rng.choice([-1.0, 1.0], COUNT)
    slope = number(mp.nstr(line_slope(), 25))
    names = hy.make_vars("q", "z", "p", "rho", "s4", "chi", "t")
    equations = [*zip(names[:6], regular_field(names), strict=True), (names[6], names[0])]
    starts = np.zeros((7, COUNT), number)
    starts[0], starts[2], starts[3], starts[4] = 1, -1, 1, slope - eta_hat
    events = {"end": names[6] - hy.expression(number(T_END)), "turn": names[2]}
    found = {}
    for name, expression in events.items():
        stop = hy.t_event(expression, fp_type=number)
        solver = hy.taylor_adaptive(equations, np.zeros(7, number), t_events=[stop], fp_type=number)
        found[name] = np.array([_until_event(solver, start) for start in starts.T])
    zero, one = np.zeros(COUNT), np.ones(COUNT)
    sigma4 = starts[4].astype(float)
    plain = np.stack([zero, one, one, sigma4, zero])
    regular = np.stack([one, zero, -one, one, sigma4, zero])
    s_end, chi = found["end"].T
    return Work(eta_hat, plain, regular, s_end.astype(float), chi, 2 * found["turn"][:, 1])


def _until_event(solver, start):
    """s and chi where the solver's event stops it."""
    solver.reset_cooldowns()
    solver.time = start.dtype.type(0)
    solver.state[:] = start
    solver.propagate_until(start.dtype.type(1000))
    return solver.time, solver.state[5]
