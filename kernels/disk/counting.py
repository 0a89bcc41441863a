"""Counts of many numbers in one pass: by the logarithm of their size, and between edges; their sums."""

import math

from kernels._jit import kernel
from kernels.types import Counts, Longs, Matrix, Vector

LARGEST = 1.7976931348623157e308


@kernel
def log_count_batch(
    values: Vector, places: Vector, groups: Vector, first: int, counts: Counts, zeros: Longs, ends: Matrix
) -> None:
    """Sizes of signed numbers, counted by group and sign -> counts, zeros, ends; added to what is there.

    places (n): where the size lies, in bins; bin k holds k <= place < k + 1, and a row of counts begins with
    bin `first`. groups (n): of each number, a whole one. Where that is none of 0, 1, ..., or the number is not
    finite, it is left out. Row 2 g is of the negative numbers of group g, and row 2 g + 1 of the others. counts
    (rows * width), zeros (rows); ends (rows, 2): the smallest and the largest size. A place outside the row is
    counted nowhere.
    """
    rows, width = zeros.size, counts.size // zeros.size
    for i in range(values.size):
        value, group = values[i], groups[i]
        size = abs(value)
        if not (0.0 <= group < 0.5 * rows and size <= LARGEST):
            continue
        row = 2 * int(group) + (0 if value < 0.0 else 1)
        # Seldom so: what is only read does not wait for what the number before it wrote.
        if size < ends[row, 0]:
            ends[row, 0] = size
        if size > ends[row, 1]:
            ends[row, 1] = size
        if size == 0.0:
            zeros[row] += 1
            continue
        k = math.floor(places[i]) - first
        if 0 <= k < width:
            counts[row * width + k] += 1


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


@kernel
def sum_batch(values: Vector, groups: Longs, sums: Matrix) -> None:
    """Sums of numbers by group -> sums (groups, 3), which is zero before; the three add up to the sum.

    groups (n): as in `histogram_batch`. What a sum loses by rounding is summed on its own, twice.
    """
    for i in range(values.size):
        g, lost = groups[i], values[i]
        if g < 0 or not abs(lost) <= LARGEST:
            continue
        for k in range(3):
            before = sums[g, k]
            after = before + lost
            kept = after - before
            lost = (before - (after - kept)) + (lost - kept)
            sums[g, k] = after
