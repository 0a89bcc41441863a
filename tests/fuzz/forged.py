"""Chunks that someone wrote anew: what they hold is not what their scene stores, and every checksum is right."""

import hashlib
import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from explorer.runs import store


def forge(folder, index, columns=None, said=None):
    """Write a chunk of a run anew, with other columns or with another note, under the name of its new bytes.

    columns: takes the Arrow table and returns another; said: changes the note, a dict, in its place.
    """
    path = store.found_chunks(folder)[index]
    table = pq.read_table(path)
    note = json.loads(json.loads(pq.read_metadata(path).metadata[b"nearflat"])["note"])
    if columns is not None:
        table = columns(table)
    if said is not None:
        said(note)
    text = json.dumps(note)
    content = json.dumps({"note": text, "check": hashlib.sha256(text.encode()).hexdigest()})
    made = pa.BufferOutputStream()
    with pq.ParquetWriter(made, table.schema, write_page_checksum=True) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({b"nearflat": content.encode()})
    whole = made.getvalue().to_pybytes()
    path.unlink()
    new = path.with_name(f"chunk-{index:06d}-{hashlib.sha256(whole).hexdigest()[:16]}.parquet")
    new.write_bytes(whole)
    return new


def _column(kind, rows):
    """A column of another type than any of race-angles."""
    return {
        "text": lambda: pa.array(["x"] * rows),
        "list": lambda: pa.array([[0.1]] * rows),
        "struct": lambda: pa.array([{"a": 1}] * rows),
        "time": lambda: pa.array([0] * rows, pa.timestamp("ns")),
        "bytes": lambda: pa.array([b"x"] * rows),
        "decimal": lambda: pa.array([1] * rows, pa.decimal128(38)),
        "single": lambda: pa.array(np.zeros(rows, np.float32)),
        "whole": lambda: pa.array([77] * rows),
        "nothing": lambda: pa.array([None] * rows, pa.float64()),
        "null": lambda: pa.nulls(rows),
        "words": lambda: pa.DictionaryArray.from_arrays(pa.array(np.zeros(rows, np.int8)), ["nonsense"]),
    }[kind]()


TYPES = ("text", "list", "struct", "time", "bytes", "decimal", "single", "whole", "nothing", "null", "words")


def retyped(name, kind):
    """A column that holds something else."""

    def change(table):
        return table.set_column(table.column_names.index(name), name, _column(kind, table.num_rows))

    return change


def refilled(name, value):
    """A column of the same type in which every number is this one."""

    def change(table):
        here = table.column_names.index(name)
        kind = table.schema.field(name).type
        return table.set_column(here, name, pa.array([value] * table.num_rows).cast(kind))

    return change


# What someone may do to the rows of a chunk, by what it is called.
ROWS = {
    "dropped": lambda table: table.drop([table.column_names[0]]),
    "doubled": lambda table: table.append_column(table.column_names[0], table.column(0)),
    "one more": lambda table: table.append_column("x" * 300, table.column(0)),
    "no rows": lambda table: table.slice(0, 0),
    "half the rows": lambda table: table.slice(0, table.num_rows // 2),
    "twice the rows": lambda table: pa.concat_tables([table, table]),
    "no columns": lambda table: table.select([]),
}
# Numbers, and what is none, that may stand in place of a count.
NUMBERS = (-5, 10**18, 10**400, 1.5, True, None, "A" * 1000, [], [10**400] * 3, {}, {"nonsense": 100}, "1", 1e300)
