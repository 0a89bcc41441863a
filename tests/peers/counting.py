"""Operations of a step, counted by numbers that count.

Run as a program, `NUMBA_DISABLE_JIT=1 python -m peers.counting`, it prints them as JSON: the kernels are then
plain Python and take such numbers.
"""

import json
import os
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path
from typing import ClassVar


@cache
def counted():
    """{method: additions and multiplications} of a step with time and angles."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    command, tests = [sys.executable, "-m", "peers.counting"], Path(__file__).parents[1]
    done = subprocess.run(command, cwd=tests, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


class Number(float):
    """Counts what is done with it."""

    made: ClassVar = Counter()


class Silent(float):
    """The path, which the compiler drops where nobody asks for it."""


def _counting(name, kind):
    plain = getattr(float, name)

    def operation(x, *others):
        if any(isinstance(y, Silent) for y in others):
            return Silent(0.0)
        Number.made[kind] += 1
        return Number(plain(float(x), *map(float, others)))

    return operation


_OPERATIONS = {
    "flop": ("__add__", "__radd__", "__sub__", "__rsub__", "__mul__", "__rmul__"),
    "division": ("__truediv__", "__rtruediv__"),
    "sign": ("__neg__", "__abs__"),
}


def _teach():
    for kind, names in _OPERATIONS.items():
        for name in names:
            setattr(Number, name, _counting(name, kind))
            setattr(Silent, name, lambda *_: Silent(0.0))


def steps():
    """Additions and multiplications in a step of each method, with time and angles; of rk8 without its errors."""
    from kernels.disk import field
    from kernels.steps import eighth
    from kernels.steps.adaptive import dopri5_step
    from kernels.steps.eighth import eighth_order_step
    from kernels.steps.fixed import rk4_step

    path, field.path = field.path, lambda _x: (Silent(0.0), Silent(0.0))
    outcome = eighth._outcome
    # Nobody asks a fixed step for its errors, and the compiler drops them.
    eighth._outcome = lambda x, h, w, stages: outcome(x, h, w, stages) if w is eighth._B else x
    *constants, anchor = _disk().body
    body = type(_disk().body)(*map(Number, constants), anchor)
    counts = {}
    for name, step in (("rk4", rk4_step), ("dopri5", dopri5_step), ("rk8", eighth_order_step)):
        Number.made.clear()
        start = (*map(Number, (0.8, 0.6, -0.5, 0.4, 0.3, 0, 0, 0)), Silent(0.0), Silent(0.0))
        step(field.State(*start), Number(0.1), body)
        counts[name] = Number.made["flop"]
    field.path, eighth._outcome = path, outcome
    return counts


@cache
def _disk():
    import explorer as ex

    return ex.Disk.uniform()


def main():
    _disk()  # made by plain numbers
    _teach()
    print(json.dumps(steps()))


if __name__ == "__main__":
    main()
