"""What scenes take: pairs of the same work in one group, to be read as ratios.

    python -m pytest tests/benchmarks/test_scenes.py --benchmark-enable

Without that option each runs once, and the two of a pair are checked to give the same.
"""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer.measure.sifting import sift
from explorer.phase.falling_set import obstacle
from explorer.phase.states import phi_to_states
from explorer.scenes.falling_set import FallingSet
from kernels.disk import falling

STATES = 1 << 18


@pytest.mark.benchmark(group="could it fall")
@pytest.mark.parametrize("by", ["series", "bisection"])
def test_verdicts_beyond_the_vertical(benchmark, by):
    disk, random = BODIES["uniform"], np.random.default_rng(3)
    states = phi_to_states(disk, random.uniform(-1.5, 1.5, 4096), *random.uniform(-2.0, 2.0, (3, 4096)))
    constants, exact = states.motion, obstacle(disk)._replace(slack=math.inf)
    call = states.natural, constants.sigma3_bar, constants.energy
    found, expected = np.empty((3, 4096)), np.empty((3, 4096))
    benchmark(falling.falls_batch, *call, obstacle(disk) if by == "series" else exact, disk.natural, found)
    falling.falls_batch(*call, exact, disk.natural, expected)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.benchmark(group="falling-set, a chunk")
@pytest.mark.parametrize("what", ["one pass", "with theta_min near F", "block by block"])
def test_a_chunk_of_a_large_run(benchmark, what):
    scene = FallingSet(samples=STATES, chunk_size=STATES, theta_min="near")
    counts = scene.chunk(0)[1]
    if what == "one pass":
        streams = [random for random, _, _ in scene.streams(0)]
        found = benchmark(lambda: sift(scene.disk, scene.box, streams, (STATES, 1 << 14), scene.tube))
        assert found.could_fall == counts.could_fall
        return
    if what == "block by block":
        vars(scene)["_in_lanes"] = False
    _, tally = benchmark(scene.chunk, 0)
    assert tally.theta_min.state() == counts.theta_min.state()
    assert tally.faces == counts.faces


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
