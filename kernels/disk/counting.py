"""Counts of many numbers in one pass: by the logarithm of their size, and between edges."""

from typing import NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.types import Counts, Longs, Matrix, Vector

LARGEST = 1.7976931348623157e308
LANES = 64  # as in `algebra`


class Sizes(NamedTuple):
    """Signed numbers (n) to be counted by size, group and sign.

    places: where the size lies, in bins; bin k holds k <= place < k + 1. groups: of each number, a whole one.
    """

    values: Vector
    places: Vector
    groups: Vector


@subroutine
def find(
    values: Vector, places: Vector, groups: Vector, begin: tuple[int, int], shape: tuple[int, int], W: Longs
) -> None:
    """Row and entry of each number, -1 where there is none -> W: rows, then entries; in lanes."""
    lowest, first = float(begin[0]), float(begin[1])
    rows, width = float(shape[0]), float(shape[1])
    for i in range(values.size):
        value = values[i]
        size, row = abs(value), 2.0 * (groups[i] - lowest) + (0.0 if value < 0.0 else 1.0)
        k = np.floor(places[i]) - first
        known = (row >= 0.0) & (row < rows) & (size <= LARGEST)
        inside = known & (size > 0.0) & (k >= 0.0) & (k < width)
        # Only what lies inside is small enough to become an integer.
        W[i] = int(row if known else -1.0)
        W[LANES + i] = int(row * width + k if inside else -1.0)


@subroutine
def count(values: Vector, W: Longs, counts: Longs, zeros: Longs, ends: Matrix) -> None:
    """Numbers whose rows and entries are found, one after the other."""
    for i in range(values.size):
        row, entry, size = W[i], W[LANES + i], abs(values[i])
        if row < 0:
            continue
        # Seldom so: what is only read does not wait for what the number before it wrote.
        if size < ends[row, 0]:
            ends[row, 0] = size
        if size > ends[row, 1]:
            ends[row, 1] = size
        if entry >= 0:
            counts[entry] += 1
        elif size == 0.0:
            zeros[row] += 1


@kernel
def log_count_batch(sizes: Sizes, lowest: int, first: int, counts: Longs, zeros: Longs, ends: Matrix) -> None:
    """Sizes of signed numbers, counted by group and sign -> counts, zeros, ends; added to what is there.

    A row of counts begins with bin `first`; the first two rows are of group `lowest`, one of its negative numbers
    and one of the others, the next two of the next group. A number that is not finite, or of a group without rows,
    is left out. counts (rows * width), zeros (rows); ends (rows, 2): the smallest and the largest size. A place
    outside the row is counted nowhere.
    """
    W, shape = np.empty(2 * LANES, np.int64), (zeros.size, counts.size // zeros.size)
    for begin in range(0, sizes.values.size, LANES):
        end = min(begin + LANES, sizes.values.size)
        values = sizes.values[begin:end]
        find(values, sizes.places[begin:end], sizes.groups[begin:end], (lowest, first), shape, W)
        count(values, W, counts, zeros, ends)


@kernel
def histogram_batch(values: Vector, groups: Longs, edges: Vector, counts: Counts) -> None:
    """Numbers between equally spaced edges, counted by group -> counts; added to what is there.

    groups (n): of each number; below 0 it is left out. counts (groups * (bins + 1)): bin k of a group holds
    edges[k] <= value < edges[k + 1], the last one also its upper edge; what lies outside comes after the bins.
    """
    bins = edges.size - 1
    scale = bins / (edges[bins] - edges[0])
    for i in range(values.size):
        value = values[i]
        if groups[i] < 0 or not abs(value) <= LARGEST:
            continue
        k = bins
        if edges[0] <= value <= edges[bins]:
            k = min(int((value - edges[0]) * scale), bins - 1)
            # A product may round across an edge.
            if value < edges[k]:
                k -= 1
            elif k < bins - 1 and value >= edges[k + 1]:
                k += 1
        counts[groups[i] * (bins + 1) + k] += 1
