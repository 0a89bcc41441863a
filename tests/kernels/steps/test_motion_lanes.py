"""The lanes of motions in time: packed, also with the sines of the path."""

import re

import numba
import numpy as np
import pytest

from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.steps import motion_lanes as lanes
from kernels.steps.motions import rk4_path
from kernels.types import Vector


def test_lanes_with_the_path_are_packed():
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Body)))

    @numba.njit(signature, error_model="numpy")
    def step_all(W, b):
        lanes.sweep(rk4_path, W, b)

    (assembly,) = step_all.inspect_asm().values()
    found = re.findall(r"^\s+v?(?:add|sub|mul)(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 5 * found.count("sd")


def test_a_landing_that_is_full_leaves_the_other_times_for_the_next():
    W, landing = lanes.work_array(), lanes.work_array()
    times = np.linspace(1.0, 2.0, 20)
    for i in (3, 5):
        W[lanes.NOTE * lanes.LANES + i] = lanes.HIT
        W[(lanes.NOW + 5) * lanes.LANES + i] = 2.0
        W[lanes.SAMPLE * lanes.LANES + i] = 10 + i
    counts = []
    sent = []
    waiting = 0
    while True:
        waiting = lanes.collect(W, times, landing, 0)
        counts.append(waiting)
        columns = landing.reshape(lanes.ROWS, lanes.LANES)[:, :waiting]
        sent += list(zip(columns[lanes.SAMPLE], columns[lanes.MET], columns[lanes.NEXT], strict=True))
        if waiting < lanes.LANES:
            break
    assert counts == [16, 16, 8]
    assert sent == [(j, k, times[k]) for j in (13.0, 15.0) for k in range(20)]
