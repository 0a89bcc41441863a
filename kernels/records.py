"""Records of numbers in arrays: one row for each field of a NamedTuple, so that no row of it is numbered anywhere.

An array that crosses the wall to `explorer` has a column for each sample: a kernel fills it by
`put(PassageRow(chi=..., ...), out, i)`, and whoever reads it unpacks the same NamedTuple, `PassageRow(*out).chi`,
whose fields then are arrays.

Within a kernel samples lie side by side in lanes, in one flat array whose rows are named by where they begin:
number i of a row is at `row + i`. The compiler sees that such rows do not overlap; with several arrays, or a
two-dimensional one, it gives up vectorising ("too many memory checks needed"). No loop makes a tuple in numba, so
the functions that read and write records name each field, and are generated.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from kernels._jit import device
from kernels.types import Matrix, Vector

Entry = TypeVar("Entry")  # a number inside the kernels, an array of them outside
Record = TypeVar("Record", bound=tuple)


@device
def put(record: Any, out: Matrix, i: int) -> None:
    """Write a record of numbers into column i, as many of its fields as the array has rows."""
    for row in range(out.shape[0]):
        out[row, i] = record[row]


def reader(kind: type[Record], lanes: int) -> Callable[[Vector, int, int], Record]:
    """What reads records among so many lanes: `read(W, row, i)`, in lane i the one whose first row is given."""
    entries = (f"W[row + {k * lanes} + i]" for k in range(len(_fields(kind))))
    return _generated(f"def access(W, row, i): return kind({', '.join(entries)})", kind)


def writer(kind: type[Record], lanes: int) -> Callable[[Vector, int, int, Record], None]:
    """What writes records where `reader` finds them: `write(W, row, i, record)`."""
    lines = (f"    W[row + {k * lanes} + i] = record.{field}" for k, field in enumerate(_fields(kind)))
    return _generated("\n".join(["def access(W, row, i, record):", *lines]), kind)


def _fields(kind: Any) -> tuple[str, ...]:
    fields: tuple[str, ...] = kind._fields
    return fields


def _generated(source: str, kind: type) -> Any:
    names: dict[str, Any] = {"kind": kind, "__name__": kind.__module__}
    exec(source, names)
    return device(names["access"])
