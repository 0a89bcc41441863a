"""The core's multiply-add peak, measured, and the operations of a step, counted."""

import json
import os
import subprocess
import sys
import time

import numba
import numpy as np

_CHAINS = 12  # independent sums: enough to hide the latency of a multiply-add
_LANES = 16

_COUNT = """
import json
import numpy as np
from kernels.steps.eighth import eighth_order_step
from kernels.steps.adaptive import dopri5_step
from kernels.disk.field import State
from kernels.steps.fixed import rk4_step
from kernels.disk import field
import explorer as ex

class Silent(float):  # the path, which the compiler drops
    pass
class Number(float):
    made = 0
def operation(name):
    plain = getattr(float, name)
    def counted(x, y):
        if isinstance(y, Silent):
            return Silent(0.0)
        Number.made += 1
        return Number(plain(float(x), float(y)))
    return counted
for name in ("__add__", "__radd__", "__sub__", "__rsub__", "__mul__", "__rmul__"):
    setattr(Number, name, operation(name))
    setattr(Silent, name, lambda x, y: Silent(0.0))
field.path = lambda x: (Silent(0.0), Silent(0.0))
body = ex.Disk.uniform().body._make(map(Number, ex.Disk.uniform().body))
counts = {}
for name, step in (("rk4", rk4_step), ("dopri5", dopri5_step), ("rk8", eighth_order_step)):
    Number.made = 0
    start = (*map(Number, (0.8, 0.6, -0.5, 0.4, 0.3, 0, 0, 0)), Silent(0.0), Silent(0.0))
    step(State(*start), Number(0.1), body)
    counts[name] = Number.made
print(json.dumps(counts))
"""


def operations():
    """Additions and multiplications in one step of each method, with time and angles, by counting numbers."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", _COUNT], env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


@numba.njit(fastmath={"contract"}, error_model="numpy")
def _chains(x, a, b, rounds):
    for _ in range(rounds):
        for j in range(_CHAINS * _LANES):
            x[j] = x[j] * a + b
        for j in range(_CHAINS * _LANES):
            x[j] = x[j] * b + a


def peak():
    """Multiply-adds per second of this core, best of several."""
    x = np.ones(_CHAINS * _LANES)
    rounds = 200_000
    _chains(x, 0.999, 1e-3, 10)
    best = 1e9
    for _ in range(7):
        start = time.perf_counter()
        _chains(x, 0.999, 1e-3, rounds)
        best = min(best, time.perf_counter() - start)
    return 2 * _CHAINS * _LANES * rounds / best
