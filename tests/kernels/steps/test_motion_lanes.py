"""The lanes of motions in time: packed, also with the sines of the path."""

import re

import numba
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
