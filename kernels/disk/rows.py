"""Arrays that cross the wall: column i belongs to sample i, and the rows are the fields of a NamedTuple.

A kernel fills its output with `put(PassageRow(chi=..., ...), out, i)`; whoever reads it unpacks the same
NamedTuple, `PassageRow(*out).chi`, whose fields then are arrays. So no row number is written anywhere.
"""

from typing import Any, TypeVar

from kernels._jit import device
from kernels.types import Matrix

Entry = TypeVar("Entry")  # a number inside the kernels, an array of them outside


@device
def put(record: Any, out: Matrix, i: int) -> None:
    """Write a record of numbers into column i, as many of its fields as the array has rows."""
    for row in range(out.shape[0]):
        out[row, i] = record[row]
