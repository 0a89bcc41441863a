"""What scenes take: pairs of the same work in one group, to be read as ratios.

    python -m pytest tests/benchmarks/test_scenes.py --benchmark-enable

Without that option each runs once, and the two of a pair are checked to give the same.
"""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer.phase.falling_set import obstacle
from explorer.phase.states import phi_to_states
from explorer.scenes.falling_set import FallingSet
from kernels.disk import membership


@pytest.mark.benchmark(group="could it fall")
@pytest.mark.parametrize("by", ["series", "bisection"])
def test_verdicts_beyond_the_vertical(benchmark, by):
    disk, random = BODIES["uniform"], np.random.default_rng(3)
    states = phi_to_states(disk, random.uniform(-1.5, 1.5, 4096), *random.uniform(-2.0, 2.0, (3, 4096)))
    exact, out = obstacle(disk)._replace(slack=math.inf), np.empty((6, 4096))
    found, expected = np.empty((2, 4096), np.int8)

    def judged(barriers, codes):
        membership.membership_batch(states.natural, False, barriers, disk.natural, out, codes)

    benchmark(judged, obstacle(disk) if by == "series" else exact, found)
    judged(exact, expected)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.benchmark(group="falling-set, theta_min of every state")
@pytest.mark.parametrize("method", ["quadrature", "rk4", "rk8", "dopri5", "dop853"])
def test_every_theta_min(benchmark, method):
    options = {"samples": 4096, "accuracy": 1e-3, "keep": "all"}
    scene = FallingSet(method=method, **options)
    table, _ = benchmark(scene.chunk, 0)
    exact, _ = FallingSet(method="quadrature", **options).chunk(0)
    error = float(np.nanpercentile(abs(table["theta_min"] - exact["theta_min"]), 99))
    assert error <= 1e-3
    assert (table["status"] == 0).all()
    benchmark.extra_info["p99 error"] = error
