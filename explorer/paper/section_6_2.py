"""Section 6.2 of the paper: which motions on the lines l± fall, which never do, and how rare they are."""

from collections.abc import Callable, Iterator

import numpy as np

from explorer import compiled
from explorer.measure import laws
from explorer.measure.distributions import Distribution
from explorer.measure.falling_constant import falling_constant
from explorer.measure.importance_sampling import NearFallingSet
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.paper.checks import BODIES, HOOP, THICK, UNIFORM, at_most, near, observed
from explorer.paper.four_dimensions import potential, rates_down, reduced, shot_slope
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.falling_set import falls, well
from explorer.phase.linear_constants import line_chart
from explorer.phase.states import phi_to_states

_BESIDE = 1e-7  # eta_hat: far above rounding, far below what decides who falls


@statement(33, "SEC-6.2")
def all_fall() -> Iterator[Finding]:
    """6.2: on l± with E > V₀ all motions in the component that reaches flat fall."""
    random = np.random.Generator(np.random.Philox(33))
    for disk in BODIES:
        phi, phidot = random.uniform(-1.4, 1.0, 3000), random.uniform(-1.5, 1.5, 3000)
        bar = random.choice([-1.0, 1.0], 3000) * random.uniform(1.05 * well(disk).sigma3_bar, 2.0, 3000)
        # Face -1 is the mirror image, eq. (3.2).
        sigma3, sigma4 = line_chart(disk, np.cos(phi), -np.sin(phi)).rates(bar, 0.0)
        rows = np.stack([phi, phidot, sigma3, -sigma4])
        count = int(falls(phi_to_states(disk, *rows)).could_fall_minus.sum())
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
    bar = random.choice([-1.0, 1.0], n) * random.uniform(0.2, 0.98, n) * well(disk).sigma3_bar
    # Beyond the vertical and slow, where the barrier decides; not so slow that the energy of eta does.
    phi = random.uniform(0.0, 1.4, n)
    phidot = random.choice([-1.0, 1.0], n) * random.uniform(0.01, 0.5, n)
    sigma3, sigma4 = line_chart(disk, np.cos(phi), -np.sin(phi)).rates(bar, _BESIDE)
    states = phi_to_states(disk, phi, phidot, sigma3, -sigma4)
    said = falls(states).could_fall_minus
    tilt, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-6, "dopri5"))
    known = status == 0
    came = tilt[known] < 1e-3
    agree, both = int((came == said[known]).sum()), min(came.mean(), 1.0 - came.mean())
    done = int(known.sum())
    yield near(f"{disk.name}: integrated beside l₋ with a well", done, n, 0.01 * n, "near a separatrix")
    yield near(f"{disk.name}: of these, agree on who falls", agree, done, 0, "a count")
    why = "both must occur for this to tell"
    yield at_most(f"{disk.name}: share of the commoner outcome", 1.0 - both, 0.9, why)


@statement(34, "WELL")
def non_falling_well() -> Iterator[Finding]:
    """6.2: on l± near the origin there are also motions that never fall: iff |σ̄₃| < σ̄₃*."""
    tilts = np.geomspace(0.5 * np.pi, 0.05, 4000)[1:]
    for disk in BODIES:
        # l_+ as seen from face -1: V = sigma3_bar^2 U + q, so V' = 0 where sigma3_bar^2 = -cos(tilt)/U'
        sigma = rates_down(disk, 1.0, shot_slope(disk), -1, tilts)
        U = potential(disk, tilts, sigma) - np.sin(tilts)
        critical = -np.cos(tilts) / np.gradient(U, tilts, edge_order=2)
        largest = float(np.sqrt(critical[critical < np.inf].max()))
        why = "quadratic error of the difference quotient, steps of 1e-3"
        yield near(f"{disk.name}: σ̄₃* from V on l₊", largest, well(disk).sigma3_bar, 1e-5, why)
        agree = 0
        for share in (0.2, 0.5, 0.8, 0.95, 0.99, 1.01, 1.05, 1.2, 1.5, 2.0):
            scale = share * well(disk).sigma3_bar
            V = scale**2 * U + np.sin(tilts)
            minima = ((V[1:-1] < V[:-2]) & (V[1:-1] < V[2:])).nonzero()[0] + 1
            agree += bool(minima.size) == bool(share < 1.0)
            for at in minima:
                speed = np.sqrt((V[:at].max() - V[at]) / (disk.I1 + 1.0))  # half of what passes the barrier
                row = (tilts[at] - 0.5 * np.pi, speed, *(scale * sigma[:, at]))
                phi = observed(disk, row, np.linspace(0.0, 30.0, 200), "phi")[0]
                agree -= not bool((phi < 0.0).all() and phi.min() > -1.5)
        yield near(f"{disk.name}: of 10 |σ̄₃|, a well iff below σ̄₃*; motions stay in it", agree, 10, 0, "a count")


@statement(35, "CODIM-1")
def codimension_one() -> Iterator[Finding]:
    """6.2: F has codimension one: P(θ_min < δ) ~ Cδ; no state drawn plainly lies on it."""
    deltas, draws = np.array([1e-3, 1e-5, 1e-7]), 6000
    random = np.random.Generator(np.random.Philox(35))
    for disk in (UNIFORM, HOOP, THICK):
        near_f = NearFallingSet(Distribution.box(disk), 2, 1e-6)
        found = [vars(near_f.below(delta, random, draws).estimate).values() for delta in deltas.tolist()]
        C, ladder = falling_constant(disk), laws.Estimate(*np.array([*map(list, found)]).T)
        slope, constant = laws.fit_slope(deltas, ladder), laws.fit_constant(deltas, ladder)
        why = f"four standard errors of {draws} draws per δ and face"
        yield near(f"{disk.name}: slope of ln P in ln δ, δ = 1e-3 to 1e-7", slope.value, 1.0, 4 * slope.error, why)
        yield near(f"{disk.name}: C by draws near F", constant.value, C.value, 4 * constant.error, why)
        lot = Distribution.box(disk).draw(random, 100_000)
        hits = int((falls(phi_to_states(disk, **lot)).status == compiled.status.Status.FALLS).sum())
        yield near(f"{disk.name}: exact falls in 10⁵ plain draws (so P < 3e-5)", hits, 0, 0.0, "a count")
    yield near("uniform: C", falling_constant(UNIFORM).value, 1.46927, 6e-6, "digits of the earlier quadrature")
