"""nearflat on the same work: the lanes' integrators, and the quadrature kernel."""

import numpy as np
from peers.problem import COUNT, DISK, T_END, work

from explorer import compiled

COPIES = 32  # of the 256 trajectories in one call, so that the lanes' filling and draining do not count
METHODS = {"rk4": 0, "dopri5": 1, "rk8": 2, "dop853": 3}


def integrator(name, whole):
    """chi at t = 1.6 (whole), or twice chi at the turning point: half the way, by the symmetry of a passage."""
    n = COUNT * COPIES
    initial = np.zeros((8, n))
    initial[:5] = np.tile(work().regular[:5], COPIES)
    event, value = (compiled.events.TIME, T_END) if whole else (compiled.events.TURNING_POINT, 0.0)
    eta = np.tile(work().eta_hat, COPIES) * DISK.body.I3 * DISK.body.r0
    pinned = np.stack([np.ones(n), eta, 2.0 * DISK.body.I1 * DISK.body.dr0 - eta])
    out, constants_error, steps = np.empty((8, n)), np.empty((3, n)), np.empty(n, np.int32)

    def make(control):
        settings = np.full(n, control)

        def solve(_n):
            status = np.zeros(n, np.int8)
            how = compiled.attempt.Integration(METHODS[name], compiled.field.ANGLES, settings, 200_000, 1e-2)
            outcome = compiled.attempt.Outcome(status, steps, constants_error)
            stop = compiled.events.Stop(event, value)
            motions = compiled.batch.Work(how, stop, initial, pinned, out, outcome)
            compiled.batch.FIRST_EVENT[how.method](motions, DISK.natural, DISK.whole)
            resolved = status == 0
            return np.where(resolved, out[6] if whole else 2.0 * out[6], np.nan)[:COUNT]

        solve.steps = lambda: steps.mean()
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
        def solve(_n):
            status = np.zeros(eta.size, np.int8)
            compiled.passages.passage_batch(crossings, accuracy, DISK.tables, DISK.natural, out, status)
            assert not np.isnan(out[1]).any()
            return np.where(status == 0, out[1], np.nan)[:COUNT]

        return solve

    return make
