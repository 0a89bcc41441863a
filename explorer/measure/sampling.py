"""Seeded streams of random numbers.

Each stream gives PER_STREAM samples of a run, in order, so a sample depends on the seed and its place
in the run, never on the size of chunks or the number of workers.
"""

from typing import Any

import numpy as np

from explorer.errors import InputError, shown
from explorer.phase.states import Array

Range = tuple[float, float]
Stream = np.random.Generator

PER_STREAM = 1 << 16  # samples of a run that are drawn from one random stream; another number would give others
BLOCK = 8192  # draws at once: a few columns of them stay in a processor's cache


def numbered_stream(seed: int, number: int) -> Stream:
    """Random stream `number`; only its uniform doubles are used, which no numpy release changes."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(number,))))


def stream_of(rng: Any) -> Stream:
    """The random stream of a seed, a SeedSequence or a Generator. Raises InputError."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise InputError(f"rng = {shown(rng)}: give a whole number, a SeedSequence or a Generator") from None


def signs(unit: Array) -> Array:
    """1 where a uniform double is below 1/2, else -1."""
    return np.where(unit < 0.5, 1.0, -1.0)


def log_uniform(unit: Array, low: float, high: float) -> Array:
    """Map uniform doubles to a log-uniform magnitude between low and high."""
    return low * (high / low) ** unit
