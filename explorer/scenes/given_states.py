"""States that a user gives: in a file, as a table in memory, or as `States`.

A cell that should be a number and is none becomes NaN, so that its row is bad input and the others are computed.
A column no cell of which is a number is a mistake, and refused.
"""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, double_of, shorten
from explorer.paths import path_of
from explorer.phase.coordinates import ANGULAR, Chart, recognise
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, States

if TYPE_CHECKING:
    import pyarrow as pa

Columns = dict[str, NDArray[Any]]

_PARQUET = b"PAR1"  # how such a file begins
_RECORD = {"file", "rows", "sha256", "degrees"}  # what run.json says of given states


class Block(NamedTuple):
    """Some states of a chunk.

    columns: phi, phidot, sigma3, sigma4, and `row` where the states were given. own: the user's own columns.
    """

    states: States
    columns: Columns
    own: Columns

    def at(self, rows: NDArray[np.intp]) -> "Block":
        """Some of the states."""
        columns, own = ({name: values[rows] for name, values in part.items()} for part in self[1:])
        return Block(self.states.at(rows), columns, own)

    def with_results(self, results: Columns) -> Columns:
        """One table: the coordinates, the results, and the user's own columns.

        One of these whose name the others have is called given_NAME.
        """
        table = self.columns | results
        return table | {f"given_{name}" if name in table else name: values for name, values in self.own.items()}


@dataclass(frozen=True, eq=False)
class GivenStates:
    """States that a user gives. A row that is no state gets the status BAD_INPUT, and the others are computed.

    what: how messages call them. sha256: of the file's bytes or of the numbers; it identifies a run. columns: of a
    table; None for `States`, and for a Parquet file, which is read piece by piece. chart: which columns say where
    the disk is; None for `States`, and of a stored run, whose file is opened when a row is needed. degrees:
    whether angles, and rates of angles, of the table are in degrees.
    """

    what: str
    rows: int
    sha256: str
    path: Path | None = None
    chart: Chart | None = None
    columns: Columns | None = None
    states: States | None = None
    degrees: bool = False

    def __post_init__(self) -> None:
        if not self.rows:
            raise InputError(f"{self.what}: holds no states; give a table with one row for each")

    @classmethod
    def of(cls, flag: str, value: Any) -> "GivenStates":
        """From what a user writes: a path, a table, `States`; or from what run.json says. Raises InputError."""
        if isinstance(value, GivenStates):
            return value
        if isinstance(value, States):
            given = {} if value.given is None else value.given._asdict()
            digest = _digest({"natural": value.natural, "status": value.status} | given)
            return cls(flag, len(value), digest, states=value)
        if isinstance(value, str | Path):
            return cls._of_file(flag, path_of(flag, value).resolve())
        if not (isinstance(value, Mapping) and value and set(value) <= _RECORD):
            table = _table(value, flag)
            chart = _chart(table.column_names, flag)
            columns = _read(table, chart, flag)
            return cls(flag, table.num_rows, _digest(columns), None, chart, columns)
        path = Path(value["file"]) if "file" in value else None
        return cls(flag, int(value["rows"]), value["sha256"], path, degrees=value.get("degrees", False))

    def of_degrees(self, degrees: bool) -> "GivenStates":
        """The same table, of which it is said that it is in degrees; `States` are in rad."""
        return replace(self, degrees=True) if degrees and self.states is None else self

    @classmethod
    def _of_file(cls, flag: str, path: Path, remedy: str = "give Parquet or CSV") -> "GivenStates":
        """From a Parquet or a CSV file. Raises InputError where it cannot be read or says no state."""
        import pyarrow.parquet as pq

        what = f"{flag} {path}"
        with _reading(what, remedy), path.open("rb") as stream:
            parquet = stream.read(len(_PARQUET)) == _PARQUET
            stream.seek(0)
            sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
            table = pq.read_schema(path).empty_table() if parquet else _csv(path)
            rows = pq.read_metadata(path).num_rows if parquet else table.num_rows
        chart = _chart(table.column_names, what)
        columns = _read(table, chart, what)  # refuses columns of types that are of no use
        return cls(what, rows, sha256, path, chart, None if parquet else columns)

    @cached_property
    def opened(self) -> "GivenStates":
        """With the table, also of a stored run. Raises InputError where its states are not there any more."""
        if self.chart is not None or self.states is not None:
            return self
        if self.path is None:
            raise InputError(
                f"{self.what}: this run has states that were given in Python; go on with "
                'run(..., states=..., out=..., exist="resume") there'
            )
        found = self._of_file(self.what, self.path, "put the file back")
        if found.sha256 != self.sha256:
            raise InputError(f"{found.what}: is not the file of states that the run began with; put that one back")
        return replace(found, degrees=self.degrees)

    def describe(self) -> dict[str, Any]:
        """The entry of run.json."""
        file = {} if self.path is None else {"file": str(self.path)}
        turned = {"degrees": True} if self.degrees else {}
        return {**file, "rows": self.rows, "sha256": self.sha256, **turned}

    def read(self, disk: Disk, first: int, count: int) -> Block:
        """Rows first ... first + count - 1. Raises InputError where the file has been damaged since."""
        if self.opened is not self:
            return self.opened.read(disk, first, count)
        row = {"row": np.arange(first, first + count)}
        if self.states is not None:
            states = self.states.at(np.arange(first, first + count))
            return Block(states, row | coordinates_of(states), {})
        assert self.chart is not None
        if self.columns is None:
            table = self._piece(self.chart, first, count)
        else:
            table = {name: values[first : first + count] for name, values in self.columns.items()}
        states = self.chart.states(disk, table, self.degrees)
        known = coordinates_of(states)
        # Those that were given stay as they are, to the last digit and also where they are no state.
        if not self.degrees:
            known |= {name: table[name] for name in self.chart.present(table) if name in known}
        # A column in degrees must not come back under a name that stands for radians.
        turned = set(self.chart.names) & set(ANGULAR) if self.degrees else ()
        own = {f"given_{k}" if k in turned else k: v for k, v in table.items() if self.degrees or k not in known}
        return Block(states, row | known, own)

    def _piece(self, chart: Chart, first: int, count: int) -> Columns:
        """Some rows of a Parquet file: only the row groups that hold them are read."""
        import pyarrow.parquet as pq

        with (
            _reading(self.what, "put the file back"),
            pq.ParquetFile(self.path, page_checksum_verification=True) as file,
        ):
            groups = range(file.metadata.num_row_groups)
            ends = np.cumsum([0, *(file.metadata.row_group(i).num_rows for i in groups)])
            low, high = np.searchsorted(ends[1:], [first, first + count - 1], side="right")
            table = file.read_row_groups(range(low, high + 1)).slice(first - ends[low], count)
        return _read(table, chart, self.what)


def coordinates_of(states: States) -> Columns:
    """phi, phidot, sigma3, sigma4 in the units of the disk; NaN where there is no state."""
    good = states.status != compiled.status.Status.BAD_INPUT
    return {name: np.where(good, getattr(states, name), np.nan) for name in COORDINATES}


# Tables


@contextmanager
def _reading(what: str, remedy: str) -> Iterator[None]:
    """Say in one sentence that a file cannot be read."""
    import pyarrow as pa

    try:
        yield
    except (OSError, UnicodeError, pa.ArrowException) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise InputError(f"{what}: cannot be read ({shorten(reason, 120)}); {remedy}") from None


def _table(given: Any, what: str) -> "pa.Table":
    """A table in memory as Arrow has it: of a frame of any library, or of a mapping of columns.

    Raises InputError where it is none.
    """
    import pyarrow as pa

    if isinstance(getattr(given, "columns", None), Mapping):  # a result of a call
        given = given.columns
    try:
        if hasattr(given, "iloc"):  # of pandas, which would hand over its index as well
            return pa.Table.from_pandas(given, preserve_index=False)
        return pa.table(given)
    except (TypeError, ValueError, pa.ArrowException) as error:
        raise InputError(
            f"{what}: is no table ({shorten(str(error), 120)}); give a path, a DataFrame, a dict of columns of "
            "one length, or States"
        ) from None


def _csv(path: Path) -> "pa.Table":
    """A CSV file, with commas, semicolons or tabs."""
    from pyarrow import csv

    with path.open(encoding="utf-8") as stream:
        separator = max(",;\t", key=stream.readline().count)
    # In one block, so that all of a column decides on its type.
    how = csv.ReadOptions(use_threads=False, block_size=min(path.stat().st_size + 1, 2**31 - 1))
    table = csv.read_csv(path, how, csv.ParseOptions(delimiter=separator))
    return table.rename_columns([name.strip() for name in table.column_names])


def _chart(names: list[str], what: str) -> Chart:
    """Which columns say where the disk is. Raises InputError where they say no state or not which."""
    twice = sorted(name for name in names if names.count(name) > 1)
    if twice:
        raise InputError(f"{what}: has several columns {twice[0]!r}; rename or drop all but one")
    return recognise(names, what)


def _read(table: "pa.Table", chart: Chart, what: str) -> Columns:
    """Columns that say where the disk is as numbers, and the user's own as they can be stored."""
    numbers = chart.present(table.column_names)
    return {
        name: _numbers(table.column(name), f"{what}: column {name!r}")
        if name in numbers
        else _own(table.column(name), f"{what}: column {name!r}")
        for name in table.column_names
    }


def _numbers(column: Any, what: str) -> Array:
    """Doubles; NaN for cells that are no number. Raises InputError where no cell is."""
    import pyarrow.types as types

    if any(test(column.type) for test in (types.is_integer, types.is_floating, types.is_decimal)):
        return np.array(column.cast("float64", safe=False).to_numpy())
    numbers = np.array([double_of(cell) for cell in column.to_pylist()], np.float64)  # None becomes NaN
    if numbers.size and np.isnan(numbers).all():
        raise InputError(f"{what} holds no numbers, but {column.type}; give numbers, or rename the column")
    return numbers


def _own(column: Any, what: str) -> NDArray[Any]:
    """A column of the user's own as it can be stored: numbers, truth values, times, or text."""
    import pyarrow.types as types

    kind = column.type.value_type if types.is_dictionary(column.type) else column.type
    if types.is_nested(kind):
        raise InputError(f"{what} holds {kind}, which results cannot keep; leave it out")
    values = column.cast("float64" if types.is_decimal(kind) else kind).to_numpy()
    if values.dtype.kind in "fiubMm":
        return np.array(values)
    return np.array(["" if cell is None else str(cell) for cell in values.tolist()], np.str_)


def _digest(arrays: Mapping[str, Any]) -> str:
    digest = hashlib.sha256()
    for name, values in arrays.items():
        digest.update(f"{name}:{values.dtype}:{values.shape};".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()
