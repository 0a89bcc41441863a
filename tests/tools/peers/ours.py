"""nearflat on the same work: what a user calls."""

import numpy as np
from tools.peers.problem import COUNT, DISK, T_END, work

import explorer as ex

COPIES = 80  # of the 256 trajectories in one call, so that its fixed cost does not count


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
