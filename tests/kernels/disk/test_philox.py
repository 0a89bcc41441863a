"""Random numbers in lanes: those of NumPy's Philox, which others have tested, and the published vector."""

import numpy as np
import pytest
from scipy import stats

from kernels.disk import philox
from kernels.disk.philox import LANES, WORDS


def numpy_stream(seed):
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(3,))))


def keys_of(random):
    return philox.round_keys(random.bit_generator.state["state"]["key"])


def numbers(seed, place, count):
    keys, out, work = keys_of(numpy_stream(seed)), np.empty(WORDS), np.empty(WORDS, np.uint64)
    made = []
    for first in range(place, place + count, WORDS):
        philox.uniforms(first, keys, work, out)
        made.append(out.copy())
    return np.concatenate(made)[:count]


@pytest.mark.parametrize("place", [0, 1, 2, 3, 4, 255, 256, 1000, 16384])
def test_the_stream_is_that_of_numpy_from_any_place(place):
    for seed in (0, 7, 2**63):
        np.testing.assert_array_equal(numbers(seed, place, 1000), numpy_stream(seed).random(place + 1000)[place:])


def test_far_places_are_those_of_a_stream_that_was_advanced():
    """One step of numpy's `advance` is one counter: four numbers."""
    random = numpy_stream(1)
    random.bit_generator.advance(10**12)
    np.testing.assert_array_equal(numbers(1, 4 * 10**12, 64), random.random(64))


def test_the_published_vector_comes_out():
    """philox4x64-10 of the counter 0 with the key 0, from the known answers of Random123."""
    words = np.empty(WORDS, np.uint64)
    philox.encipher(0, philox.round_keys(np.zeros(2, np.uint64)), words)
    published = [0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B]
    assert words[::LANES].tolist() == published


def test_lanes_are_uniform_and_independent_of_their_neighbours():
    """What a mistake in the order of lanes or words would break, and equality with numpy at a few places not."""
    drawn = numbers(5, 0, 1 << 17)
    assert stats.kstest(drawn, "uniform").pvalue > 1e-4
    assert np.unique(drawn).size == drawn.size
    bits = (drawn * 2.0**53).astype(np.uint64)[:, None] >> np.arange(53, dtype=np.uint64) & np.uint64(1)
    # Every bit is set in half of the numbers, within five standard deviations.
    assert abs(bits.mean(axis=0) - 0.5).max() < 5.0 * 0.5 / drawn.size**0.5
    for apart in (1, 2, 3, 4, LANES, WORDS):
        pairs, _, _ = np.histogram2d(drawn[:-apart], drawn[apart:], bins=16, range=[[0, 1], [0, 1]])
        assert stats.chisquare(pairs.ravel()).pvalue > 1e-4
