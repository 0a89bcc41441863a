"""nearflat on the same work: what a user calls, and the kernels inside."""

import numpy as np
from peers.problem import COUNT, DISK, T_END, work

import explorer as ex
from explorer import compiled

COPIES = 80  # of the 256 trajectories in one call, so that its fixed cost does not count
METHODS = {"rk4": 0, "dopri5": 1, "rk8": 2, "dop853": 3}


def passages(method):
    """`explorer.passages`: chi over a whole passage, vertical to vertical."""
    eta_hat = np.tile(work().eta_hat, COPIES)

    def make(accuracy):
        def solve(_n):
            found = ex.passages(DISK, 1.0, eta_hat, 1.0, method=method, accuracy=accuracy)
            return found.delta_chi[:COUNT]  # NaN where it is not resolved

        return solve

    return make


def simulate():
    """`explorer.simulate`: chi at t = 1.6, by the method that it chooses."""
    states = ex.constants_to_states(DISK, 1.0, np.tile(work().eta_hat, COPIES), 1.0)

    def make(accuracy):
        def solve(_n):
            found = ex.simulate(states, t_eval=[T_END], observables=("chi",), accuracy=accuracy)
            return found.chi[:COUNT, 0]

        return solve

    return make


def integrator(name, whole):
    """chi at t = 1.6 (whole), or twice chi at the turning point: half the way, by the symmetry of a passage."""
    n = COUNT * COPIES
    initial = np.zeros((10, n))
    initial[:5] = np.tile(work().regular[:5], COPIES)
    events, engine, depth = compiled.events, compiled.engine, compiled.field.ANGLES
    event, value = (events.TIME, T_END) if whole else (events.TURNING_POINT, 0.0)
    eta = np.tile(work().eta_hat, COPIES) * DISK.body.I3 * DISK.body.r0
    linear = np.stack([np.ones(n), eta, 2.0 * DISK.body.I1 * DISK.body.dr0 - eta])
    out, moved, steps = np.empty((n, 1, 10)), np.empty((3, n)), np.empty(n, np.int32)
    history = compiled.curves.History(0.0, 0.0, np.empty((0, 12)), np.zeros(1, np.int64), 0)

    def make(control):
        settings = np.full(n, control)

        def solve(_n):
            status, follow = np.zeros(n, np.int8), engine.FOLLOW[METHODS[name], depth]
            motions = (METHODS[name], 200_000, event, np.array([value]), settings, initial, linear)
            follow(engine.Work(*motions, status, out, steps, moved), history, DISK.natural, DISK.whole)
            chi = np.where(status == 0, out[:, 0, compiled.field.ROW.chi], np.nan)
            return (chi if whole else 2.0 * chi)[:COUNT]

        return solve

    return make


def quadrature():
    """chi over a whole passage, vertical to vertical, from eta itself; the setting is the accuracy."""
    b = DISK.body
    eta = np.tile(work().eta_hat, COPIES) * b.I3 * b.r0
    one = np.ones(eta.size)
    out = np.empty((8, eta.size))
    crossings = compiled.passages.Crossings(one, eta, one)

    def make(accuracy):
        tables = DISK.tables[0 if accuracy >= 1e-6 else 1]

        def solve(_n):
            compiled.passages.passage_batch(crossings, tables, DISK.natural, out)
            return np.where(np.isfinite(out[6]), out[1], np.nan)[:COUNT]

        return solve

    return make
