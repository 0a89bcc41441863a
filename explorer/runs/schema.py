"""What a chunk must hold to be one of a run: the scene says, and every reader asks before anything is used.

Whoever writes a file can give it the checksums of what it holds. So names and types of columns, the number of rows
and the counts are compared with what the scene stores; `verify` and `resume` look at each value besides.
"""

from collections import Counter
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from explorer import compiled
from explorer.errors import shown
from explorer.measure import statistics
from explorer.phase.columns import COLUMNS
from explorer.runs.strangers import StrangeError
from explorer.scenes.base import Scene, Table, Tally

if TYPE_CHECKING:
    import pyarrow as pa

_TEXT, _TIME, _STATUS = "text", "time", "status"
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


def check_values(scene: Scene, index: int, table: Table, tally: Tally) -> None:
    """Raise StrangeError where a number is missing though the status is ok, or rows are more than were counted."""
    status = table["status"]
    ok = status == compiled.status.Status.OK
    if type(scene).columns != Scene.columns:
        for name in scene.stored:
            if name not in scene.may_be_unknown and not _finite(table[name][ok]):
                raise StrangeError(f"column {name!r} is not finite in a row with status ok")
    rows, counted = statistics.count_status([status]), tally["status"]
    all_of_them = len(set(scene.rows(index))) == 1
    for name in {**rows, **(counted if all_of_them else {})} if _counts_rows(scene) else ():
        here, there = rows.get(name, 0), counted.get(name, 0) * scene.rows_of_a_sample
        if here > there or (all_of_them and here != there and scene.rows(index)[1] > 0):
            raise StrangeError(f"it holds {here:,} rows with status {name}, and counts {there:,}")


def _finite(values: np.ndarray) -> bool:
    return values.dtype.kind != "f" or bool(np.isfinite(values).all())


def _counts_rows(scene: Scene) -> bool:
    """Whether a row is a sample, or one of a fixed number of each."""
    return scene.rows(0)[1] < float("inf")
