"""What a chunk must hold to be one of a run: the scene says, and every reader asks before anything is used.

Whoever writes a file can give it the checksums of what it holds. So names and types of columns, the number of rows
and the counts are compared with what the scene stores; `verify` and `resume` look at each value besides.
"""

import math
from collections import Counter
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from explorer import compiled
from explorer.errors import shown
from explorer.measure import statistics
from explorer.phase.columns import COLUMNS, ENERGY, LENGTH, RATE, TIME
from explorer.phase.disk import Disk
from explorer.phase.strangers import StrangeError
from explorer.scenes.base import Scene, Table, Tally

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

_TEXT, _TIME, _STATUS = "text", "time", "status"
_ARROW = b"ARROW:schema"  # where Arrow writes what Parquet's types do not say
_SMALL, _DENSEST = 1 << 26, 256  # bytes that may be packed at will; lz4 packs so many into one at most
_SHOWN = 40  # characters of a name or a type in a message


class Held(NamedTuple):
    """What a chunk holds, as far as its footer says. columns: names and kinds, in order; a name may come twice."""

    columns: list[tuple[str, str]]
    rows: int


def held_by(schema: "pa.Schema", rows: int) -> Held:
    """What is in a table of Arrow's, whose types are called as in `phase.columns`."""
    return Held([(field.name, _kind(field.type)) for field in schema], rows)


@lru_cache(256)
def _kind(kind: "pa.DataType") -> str:
    import pyarrow as pa

    t = pa.types
    if t.is_dictionary(kind):
        return _STATUS if t.is_string(kind.value_type) and t.is_int8(kind.index_type) else "a dictionary"
    if t.is_boolean(kind) or t.is_integer(kind) or t.is_floating(kind):
        return str(np.dtype(kind.to_pandas_dtype()).name)
    if t.is_string(kind) or t.is_large_string(kind):
        return _TEXT
    times = t.is_timestamp(kind) or t.is_date(kind) or t.is_time(kind) or t.is_duration(kind)
    return _TIME if times else str(kind)


def check_held(scene: Scene, index: int, held: Held) -> None:
    """Raise StrangeError where chunk `index` of a scene does not hold such columns, or so many rows."""
    check_columns(scene, held)
    check_rows(scene, index, held.rows)


def check_columns(scene: Scene, held: Held) -> None:
    """Raise StrangeError where chunks of a scene do not hold such columns."""
    names = [name for name, _ in held.columns]
    missing = [name for name in scene.stored if name not in names]
    twice = [name for name, times in Counter(names).items() if times > 1]
    strange = [] if scene.stores_others else [name for name in names if name not in scene.stored]
    for what, found in (("is missing", missing), ("is there twice", twice), ("is not one of this scene", strange)):
        if found:
            raise StrangeError(f"column {shown(found[0][:_SHOWN])} {what}")
    for name, kind in held.columns:
        _check_kind(scene, name, kind)


def check_rows(scene: Scene, index: int, rows: int) -> None:
    """Raise StrangeError where chunk `index` of a scene does not hold so many rows."""
    low, high = scene.rows(index)
    if not low <= rows <= high:
        due = f"{low:,}" if low == high else f"{low:,} to {high:,}"
        raise StrangeError(f"it holds {rows:,} rows, not {due}")


def _check_kind(scene: Scene, name: str, kind: str) -> None:
    """Raise StrangeError where a column has not its type; a user's own may be numbers, text or times."""
    ours = name in scene.stored and (type(scene).__module__.startswith("explorer.") or name == _STATUS)
    if ours and kind != COLUMNS[name].kind:
        raise StrangeError(f"column {name!r} holds {kind[:_SHOWN]}, not {COLUMNS[name].kind}")
    if not ours and kind not in (_TEXT, _TIME) and not _is_number(kind):
        raise StrangeError(f"column {shown(name[:_SHOWN])} holds {kind[:_SHOWN]}: no numbers, text or times")


def _is_number(kind: str) -> bool:
    return kind == "bool" or kind.startswith(("int", "uint", "float"))


def check_counts(scene: Scene, index: int, samples: int, tally: Tally) -> None:
    """Raise ValueError where a chunk does not stand for so many samples as it should, or counts others."""
    if index >= scene.chunks():
        raise StrangeError(f"the run has {scene.chunks():,} chunks only")
    if samples != scene.length(index):
        raise StrangeError(f"it stands for {shown(samples)} samples, not {scene.length(index):,}")
    scene.check_tally(index, tally)


@dataclass
class Seen:
    """Which columns were found good last: chunks of a run hold the same, which are looked at once.

    good: as Parquet has them, and what Arrow says of them.
    """

    good: "tuple[pq.ParquetSchema, bytes | None] | None" = None


@dataclass(frozen=True)
class Place:
    """Where a chunk is due: which number, of which run. Readers ask whether a file may stand there.

    seen: shared by all places of a scene where many chunks are read.
    """

    scene: Scene
    index: int
    seen: Seen = field(default_factory=Seen, compare=False, repr=False)

    def check(self, index: int, samples: int, tally: Tally) -> None:
        """Raise ValueError where a chunk that says this is not the one that is due."""
        if index != self.index:
            raise StrangeError(f"it is chunk {shown(index)}")
        check_counts(self.scene, self.index, samples, tally)

    def check_held(self, file: "pq.ParquetFile") -> None:
        """Raise ValueError where a file does not hold such columns, or so many rows."""
        rows, said = file.metadata.num_rows, (file.metadata.metadata or {}).get(_ARROW)
        columns, before = self.seen.good or (None, None)
        if columns is None or said != before or not file.schema.equals(columns):
            check_columns(self.scene, held_by(file.schema_arrow, rows))
            self.seen.good = file.schema, said
        check_rows(self.scene, self.index, rows)
        groups = [file.metadata.row_group(i) for i in range(file.metadata.num_row_groups)]
        columns_of = [group.column(i) for group in groups for i in range(group.num_columns)]
        size = sum(column.total_uncompressed_size for column in columns_of)
        most = _SMALL + _DENSEST * sum(column.total_compressed_size for column in columns_of)
        if size > most:
            raise StrangeError(f"its columns unpack to {size:,} bytes; {most:,} is the most that is read")


def check_values(scene: Scene, index: int, table: Table, tally: Tally) -> None:
    """Raise StrangeError where numbers are none of right rows, or rows are more than were counted."""
    status = table["status"]
    ok = status == compiled.status.Status.OK
    if type(scene).columns != Scene.columns:
        for name in scene.stored:
            _check_numbers(scene, name, table[name], ok)
    rows, counted = statistics.count_status([status]), tally["status"]
    all_of_them = len(set(scene.rows(index))) == 1
    for name in {**rows, **(counted if all_of_them else {})} if _counts_rows(scene) else ():
        here, there = rows.get(name, 0), counted.get(name, 0) * scene.rows_of_a_sample
        if here > there or (all_of_them and here != there and scene.rows(index)[1] > 0):
            raise StrangeError(f"it holds {here:,} rows with status {name}, and counts {there:,}")


def _check_numbers(scene: Scene, name: str, values: np.ndarray, ok: np.ndarray) -> None:
    """Raise StrangeError where a row with status ok misses its number, or holds one that no such row can hold."""
    if values.dtype.kind not in "fiu" or not values.size:
        return
    least, most = _ends(scene, name)
    low, high = values.min(), values.max()
    if least <= low > -math.inf and most >= high < math.inf:  # what is no number does not compare so
        return
    right = values[ok]
    known = np.isfinite(right)
    if name not in scene.may_be_unknown and not known.all():
        raise StrangeError(f"column {name!r} is not finite in a row with status ok")
    strange = right[known & ~((least <= right) & (right <= most))]
    if strange.size:
        raise StrangeError(
            f"column {name!r} holds {strange[0]:g} in a row with status ok, not {least:g} to {most:g}"
        )


def _ends(scene: Scene, name: str) -> tuple[float, float]:
    """The smallest and the largest number that a column of a scene can hold, in the units of its disks."""
    if name not in COLUMNS or not type(scene).__module__.startswith(
        "explorer."
    ):  # a user's own may mean other things
        return -math.inf, math.inf
    known = COLUMNS[name]
    unit = max(_unit(disk, known.unit) for disk in scene.disks)
    least, most = known.ends
    return least * unit, most * unit


def _unit(disk: Disk, of: str) -> float:
    """A unit of columns, in the units of a disk."""
    units = {RATE: disk.rate_unit, TIME: disk.time_unit, LENGTH: disk.r, ENERGY: disk.energy_unit}
    return units.get(of, 1.0)


def _counts_rows(scene: Scene) -> bool:
    """Whether a row is a sample, or one of a fixed number of each."""
    return scene.rows(0)[1] < float("inf")
