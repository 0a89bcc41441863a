"""Every solver on the same work: its errors once, then its times in rounds, one solver after another."""

import time
from typing import Any, NamedTuple

import numpy as np
from tools.peers import cpp, ours, solvers
from tools.peers.problem import COUNT, work

TIGHT = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
FINE = tuple(share * tolerance for tolerance in TIGHT[:9] for share in (1.0, 0.3))
METHODS = ("rk4", "rk8", "dopri5", "dop853")
ASKED = (1e-3, 1e-6, 1e-9)
WRONG = 3.0  # rad: a race the other way round is off by 2 kappa pi = 14
ROUNDS = 5
LEAST = 0.03  # seconds of a measurement; quick solvers are called more often
SLOW = 0.25  # seconds of a call, above which two rounds are enough

PUBLIC, PEER = "public call", "peer"


class Solver(NamedTuple):
    """name, setting, who it belongs to; solve(n) gives chi of the first n trajectories; count: of one call."""

    name: str
    setting: float
    kind: str
    solve: Any
    exact: np.ndarray
    count: int


class Row(NamedTuple):
    """What was measured of a solver; rate: trajectories per second of one core."""

    name: str
    setting: float
    kind: str
    median: float
    p99: float
    wrong: int
    unresolved: int
    rate: float


def peers():
    """name, a function that gives the maker, tolerances, how many trajectories are worth the time."""
    for regular in (False, True):
        on = "regularised" if regular else "plain"
        coarse = (1e-2, 3e-3) if regular else ()
        for name, make, settings, n in (
            ("heyoka batch", solvers.heyoka_batch, (*coarse, *FINE, *TIGHT[9:]), COUNT),
            ("heyoka", solvers.heyoka_scalar, TIGHT[::2], COUNT),
            ("numbalsoda dop853", lambda regular: solvers.numbalsoda_on("dop853", regular), TIGHT[1:], COUNT),
            ("numbalsoda lsoda", lambda regular: solvers.numbalsoda_on("lsoda", regular), TIGHT[3::2], COUNT),
            ("CyRK DOP853", solvers.cyrk_on, TIGHT[1::2], COUNT),
            ("SciPy RK45", lambda regular: solvers.scipy_on("RK45", regular), (1e-3, 1e-6, 1e-9), 32),
            ("SciPy DOP853", lambda regular: solvers.scipy_on("DOP853", regular), (1e-4, 1e-7, 1e-10, 1e-13), 32),
            ("diffrax Dopri8", solvers.diffrax_on, (1e-4, 1e-7, 1e-10), COUNT),
        ):
            yield f"{name}, {on}", lambda make=make, regular=regular: make(regular), settings, n


def loops():
    """The same of the loop in C++, strict and with products and sums rounded together."""
    lengths = {"rk4": (0.2, 0.1, 0.05, 0.025, 0.0125, 0.006, 0.003), "rk8": (0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.07)}
    for contracted in (False, True):
        for name, settings in lengths.items():
            how = "contracted" if contracted else "strict"
            yield f"C++ {name} {how}, regularised", lambda name=name, c=contracted: cpp.loop(name, c), settings


def mine():
    """name, maker, settings, what is exact, of what a user calls."""
    whole, end = work().passage, work().chi
    for method in METHODS:
        yield f"passages, {method}", ours.passages(method), ASKED, whole
    yield "passages, quadrature", ours.passages("quadrature"), (1e-3, 1e-6, 1e-11), whole
    yield "simulate", ours.simulate(), ASKED, end


def all_solvers(begin=""):
    """Ours and the peers whose names begin so, ready to be called, and sentences on those that are not here."""
    found, missing = [], []
    for name, make, settings, exact in mine():
        found += [Solver(name, at, PUBLIC, make(at), exact, COUNT * ours.COPIES) for at in settings]
    for name, maker, settings, n in peers():
        if not name.startswith(begin):
            continue
        try:
            make = maker()
        except ImportError as error:
            missing.append(f"{name}: {error.name} is not installed.")
            continue
        found += [Solver(name, at, PEER, make(at), work().chi[:n], n) for at in settings]
    if cpp.compiler() is None and not begin:
        return found, [*missing, f"C++: {cpp.NO_COMPILER}."]
    for name, maker, settings in loops():
        if not name.startswith(begin):
            continue
        make = maker()
        found += [Solver(name, at, PEER, make(at), work().chi, COUNT) for at in settings]
    return found, missing


def errors(solver):
    """Median and 99th percentile of the error, how many go the wrong way, how many are not resolved."""
    n = min(solver.count, COUNT)
    error = np.abs(solver.solve(n) - solver.exact[:n]).astype(float)
    resolved = np.isfinite(error)
    median, p99 = np.percentile(error[resolved], (50, 99)) if resolved.any() else (np.nan, np.nan)
    return float(median), float(p99), int((error > WRONG).sum()), int((~resolved).sum())


def seconds(solver, calls):
    """The least time of several calls in turn: of the processor, so that other programs do not count."""
    best = np.inf
    for _ in range(calls):
        start = time.process_time()
        solver.solve(min(solver.count, COUNT))
        best = min(best, time.process_time() - start)
    return best


def measured(found, rounds=ROUNDS, say=print):
    """A row for each solver; its time is the least of all rounds."""
    accuracy = []
    for solver in found:
        accuracy.append(errors(solver))
        say(f"{solver.name}, {solver.setting:g}: median {accuracy[-1][0]:.1e}, p99 {accuracy[-1][1]:.1e}")
    best = np.array([seconds(solver, 1) for solver in found])
    for number in range(rounds):
        say(f"round {number + 1} of {rounds}")
        for i, solver in enumerate(found):
            if number < 2 or best[i] < SLOW:
                # one call more: the first finds the caches full of others' numbers
                best[i] = min(best[i], seconds(solver, 2 + int(LEAST / max(best[i], 1e-6))))
    return [
        Row(solver.name, solver.setting, solver.kind, *of, solver.count / least)
        for solver, of, least in zip(found, accuracy, best, strict=True)
    ]
