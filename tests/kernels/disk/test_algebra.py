"""Constants of many states, in lanes, against one state at a time."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import constants_of

from kernels.disk.algebra import LANES, constants_batch
from kernels.disk.constants import Constants
from kernels.disk.field import column


def in_lanes(disk, states):
    out = np.empty((6, states.shape[1]))
    constants_batch(states, disk.whole, disk.natural, out)
    return out


def random_states(n, smallest=1.0):
    rng = np.random.default_rng(4)
    theta = np.exp(rng.uniform(np.log(smallest), np.log(1.5), n)) if smallest < 1.0 else rng.uniform(0.01, 1.5, n)
    states = np.empty((5, n))
    states[0], states[1] = np.sin(theta), np.cos(theta) * rng.choice([-1.0, 1.0], n)
    states[2:] = rng.uniform(-2.0, 2.0, (3, n))
    return states


@pytest.mark.parametrize("smallest", [1.0, 1e-300])
@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "heavy-core"])
def test_lanes_agree_with_single_states_within_their_rounding(name, smallest):
    disk, states = BODIES[name], random_states(3 * LANES + 5, smallest)
    lanes = Constants(*in_lanes(disk, states))
    columns = [constants_of(column(states, i), disk.natural) for i in range(states.shape[1])]
    single = Constants(*np.array(columns).T)
    np.testing.assert_allclose(lanes.sigma3_bar, single.sigma3_bar, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(lanes.energy, single.energy, rtol=1e-15)
    for name in ("plus", "minus"):
        difference = abs(getattr(lanes, f"eta_{name}") - getattr(single, f"eta_{name}"))
        # Either of them may be off by as much.
        assert (difference <= 2.0 * getattr(single, f"rounding_{name}")).all()


def test_a_state_that_is_none_gives_nan_and_leaves_its_neighbours_alone():
    disk, states = BODIES["uniform"], random_states(2 * LANES)
    clean = in_lanes(disk, states)
    for bad in (0.0, -1.0, np.nan):
        spoilt = states.copy()
        spoilt[0, [3, LANES]] = bad
        out = in_lanes(disk, spoilt)
        assert np.isnan(out[:, [3, LANES]]).all()
        np.testing.assert_array_equal(np.delete(out, [3, LANES], axis=1), np.delete(clean, [3, LANES], axis=1))


def test_a_tilt_in_the_smallest_numbers_is_computed():
    """Its exponent has no bits of its own."""
    disk, states = BODIES["hoop"], random_states(4)
    states[0, 1], states[1, 1] = 1e-310, 1.0
    out = in_lanes(disk, states)
    np.testing.assert_allclose(out[:, 1], constants_of(column(states, 1), disk.natural), rtol=1e-13)
    assert np.isfinite(out).all()
