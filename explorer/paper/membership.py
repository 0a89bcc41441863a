"""Statements 33 and 34: which motions on the lines l± fall, and which never do (section 6.2 of the paper)."""

from collections.abc import Callable, Iterator

import numpy as np

from explorer import compiled
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.paper.fall import BODIES, at_most, near, observed, potential, rates_down, reduced, shot_slope
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.membership import falls, falls_of, well
from explorer.phase.states import phi_to_states

_BESIDE = 1e-7  # eta_hat: far above rounding, far below what decides who falls


@statement(33, "SEC-6.2", "6.2: on l± with E > V₀ all motions in the component that reaches flat fall.")
def all_fall() -> Iterator[Finding]:
    random = np.random.Generator(np.random.Philox(33))
    for disk in BODIES:
        phi, phidot = random.uniform(-1.4, 1.0, 3000), random.uniform(-1.5, 1.5, 3000)
        bar = random.choice([-1.0, 1.0], 3000) * random.uniform(1.05 * well(disk)[1], 2.0, 3000)
        chart = np.empty((4, 3000))  # face -1 is the mirror image, eq. (3.2)
        compiled.falling.line_chart_batch(np.cos(phi), -np.sin(phi), disk.body, disk.series, chart)
        rows = np.stack([phi, phidot, chart[0] * bar, -chart[2] * bar])
        count = int(falls(disk, *rows).could_fall_minus.sum())
        yield near(f"{disk.name}: of 3000 states on l₋ with |σ̄₃| > σ̄₃*, could fall", count, 3000, 0.0, "a count")
        fallen = 0
        stop: Callable[..., float] = lambda _t, y: y[0] - 1e-3  # noqa: E731
        stop.terminal = True  # type: ignore[attr-defined]
        for f, fdot, s3, s4 in rows[:, :8].T:
            fallen += reduced(disk, -1, (0.5 * np.pi + f, fdot, s3, s4), 200.0, stop).status == 1
        yield near(f"{disk.name}: of 8 integrated, come within 0.001 of flat", fallen, 8, 0.0, "a count")
        yield from _beside_the_well(disk, random)


def _beside_the_well(disk: Disk, random: np.random.Generator) -> Iterator[Finding]:
    """Where a well that never falls exists too: membership against motions 1e-7 beside l₋ that are integrated."""
    n = 1500
    bar = random.choice([-1.0, 1.0], n) * random.uniform(0.2, 0.98, n) * well(disk)[1]
    # Beyond the vertical and slow, where the barrier decides; not so slow that the energy of eta does.
    phi = random.uniform(0.0, 1.4, n)
    phidot = random.choice([-1.0, 1.0], n) * random.uniform(0.01, 0.5, n)
    chart = np.empty((4, n))
    compiled.falling.line_chart_batch(np.cos(phi), -np.sin(phi), disk.body, disk.series, chart)
    sigma3, sigma4 = chart[0] * bar + _BESIDE * chart[1], chart[2] * bar + _BESIDE * chart[3]
    states = phi_to_states(disk, phi, phidot, sigma3, -sigma4)
    said = falls_of(states).could_fall_minus
    tilt, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-6, "dopri5"))
    known = status == 0
    came = tilt[known] < 1e-3
    agree, both = int((came == said[known]).sum()), min(came.mean(), 1.0 - came.mean())
    yield near(
        f"{disk.name}: integrated beside l₋ with a well", int(known.sum()), n, 0.01 * n, "near a separatrix"
    )
    yield near(f"{disk.name}: of these, agree on who falls", agree, int(known.sum()), 0, "a count")
    yield at_most(
        f"{disk.name}: share of the commoner outcome", 1.0 - both, 0.9, "both must occur for this to tell"
    )


@statement(34, "WELL", "6.2: on l± near the origin there are also motions that never fall: iff |σ̄₃| < σ̄₃*.")
def non_falling_well() -> Iterator[Finding]:
    tilts = np.geomspace(0.5 * np.pi, 0.05, 4000)[1:]
    for disk in BODIES:
        # l_+ as seen from face -1: V = sigma3_bar^2 U + q, so V' = 0 where sigma3_bar^2 = -cos(tilt)/U'
        sigma = rates_down(disk, 1.0, shot_slope(disk), -1, tilts)
        U = potential(disk, tilts, sigma) - np.sin(tilts)
        critical = -np.cos(tilts) / np.gradient(U, tilts, edge_order=2)
        largest = float(np.sqrt(critical[critical < np.inf].max()))
        why = "quadratic error of the difference quotient, steps of 1e-3"
        yield near(f"{disk.name}: σ̄₃* from V on l₊", largest, well(disk)[1], 1e-5, why)
        agree = 0
        for share in (0.2, 0.5, 0.8, 0.95, 0.99, 1.01, 1.05, 1.2, 1.5, 2.0):
            scale = share * well(disk)[1]
            V = scale**2 * U + np.sin(tilts)
            minima = ((V[1:-1] < V[:-2]) & (V[1:-1] < V[2:])).nonzero()[0] + 1
            agree += bool(minima.size) == bool(share < 1.0)
            for at in minima:
                speed = np.sqrt((V[:at].max() - V[at]) / (disk.I1 + 1.0))  # half of what passes the barrier
                row = (tilts[at] - 0.5 * np.pi, speed, *(scale * sigma[:, at]))
                phi = observed(disk, row, np.linspace(0.0, 30.0, 200), "phi")[0]
                agree -= not bool((phi < 0.0).all() and phi.min() > -1.5)
        yield near(f"{disk.name}: of 10 |σ̄₃|, a well iff below σ̄₃*; motions stay in it", agree, 10, 0, "a count")
