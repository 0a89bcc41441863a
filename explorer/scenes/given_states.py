"""States that a user gives: in a file, as a table in memory, or as `States`."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, whole
from explorer.phase.charts import Chart, recognise
from explorer.phase.disk import Disk
from explorer.phase.paths import path_of
from explorer.phase.states import COORDINATES, States
from explorer.scenes.given_columns import (
    Columns,
    DataFrame,
    ParquetColumns,
    as_columns,
    as_numbers,
    as_own,
    csv_header,
    read_csv,
)

# What users may give.
Given = Path | str | DataFrame | np.ndarray[Any, Any] | Mapping[str, Any] | States

_PARQUET = b"PAR1"  # how such a file begins
_MOST_ROWS = 10**12
_RECORD = {"file", "rows", "sha256"}  # what run.json says of given states


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

    what: how messages call them. sha256: of the file's bytes or of the numbers; it identifies a run. columns: a
    table in memory, or a Parquet file that is read piece by piece; None for `States`, and where a stored run had
    states that were never in a file. chart: which columns say where the disk is.
    """

    what: str
    rows: int
    sha256: str
    path: Path | None = None
    columns: Columns | ParquetColumns | None = None
    chart: Chart | None = None
    states: States | None = None

    @classmethod
    def of(cls, flag: str, value: Any) -> "GivenStates":
        """From what a user writes: a path, a table, `States`; or from what run.json says. Raises InputError."""
        if isinstance(value, GivenStates):
            return value
        if isinstance(value, str | Path):
            return cls.open(flag, path_of(flag, value))
        if isinstance(value, States):
            return cls._of_states(flag, value)
        if isinstance(value, Mapping) and value and set(value) <= _RECORD:
            return cls._of_record(flag, value)
        return cls._of_columns(flag, as_columns(value, flag))

    @classmethod
    def open(cls, flag: str, path: Path) -> "GivenStates":
        """From a Parquet or a CSV file. Raises InputError where it cannot be read or says no state."""
        import pyarrow as pa

        what = f"{flag} {path}"
        try:
            with path.open("rb") as stream:
                parquet = stream.read(len(_PARQUET)) == _PARQUET
                if not parquet:
                    csv_header(path, what)  # before all of a file is read that may be anything
                stream.seek(0)
                sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
            columns: Columns | ParquetColumns
            if parquet:
                columns = ParquetColumns(path.resolve())
                chart, rows = recognise(columns.names, what), columns.rows
                columns.check(chart.present(columns.names), what)
            else:
                names = csv_header(path, what)[0]
                chart = recognise(names, what)
                columns = read_csv(path, dict.fromkeys(chart.present(names)), what)
                rows = next(iter(columns.values())).size
        except (OSError, UnicodeDecodeError, pa.ArrowException) as error:
            raise InputError(f"{what}: cannot be read ({_in_one_line(error)}); give Parquet or CSV") from None
        if rows == 0:
            raise InputError(f"{what}: holds no states; give a table with one row for each")
        return cls(what, rows, sha256, path.resolve(), columns, chart)

    @classmethod
    def _of_columns(cls, flag: str, given: Mapping[str, Any]) -> "GivenStates":
        chart = recognise(list(given), flag)
        columns = _read(given, chart, flag)
        lengths = {column.size for column in columns.values()}
        if len(lengths) > 1:
            raise InputError(f"{flag}: columns have {sorted(lengths)} entries; give one for each state")
        if lengths == {0}:
            raise InputError(f"{flag}: holds no states; give a table with one row for each")
        return cls(flag, lengths.pop(), _digest(columns), None, columns, chart)

    @classmethod
    def _of_states(cls, flag: str, states: States) -> "GivenStates":
        if len(states) == 0:
            raise InputError(f"{flag}: holds no states; give one or more")
        arrays = {"natural": states.natural, "status": states.status}
        if states.exact is not None:
            arrays.update(states.exact._asdict())
        return cls(flag, len(states), _digest(arrays), states=states)

    @classmethod
    def _of_record(cls, flag: str, record: Mapping[str, Any]) -> "GivenStates":
        if record.get("file") is None:
            try:
                return cls(flag, whole(f"{flag}: rows", record["rows"], 1, _MOST_ROWS), str(record["sha256"]))
            except KeyError:
                raise InputError(f"{flag}: run.json does not say which states they were; start anew") from None
        opened = cls.open(flag, path_of(flag, record["file"]))
        if opened.sha256 != record.get("sha256"):
            raise InputError(f"{flag} {opened.path}: is not the file of states that the run began with")
        return opened

    def describe(self) -> dict[str, str | int]:
        """The entry of run.json."""
        file = {} if self.path is None else {"file": str(self.path)}
        return {**file, "rows": self.rows, "sha256": self.sha256}

    def read(self, disk: Disk, first: int, count: int, degrees: bool = False) -> Block:
        """Rows first ... first + count - 1. Raises InputError where the file has been damaged since."""
        row = {"row": np.arange(first, first + count)}
        if self.states is not None:
            states = self.states.at(np.arange(first, first + count))
            return Block(states, row | _coordinates(states), {})
        if self.chart is None:
            raise InputError(
                f"{self.what}: this run has states that were given in Python; go on with "
                "run(..., states=..., resume=True) there"
            )
        table = self._table(first, count)
        states = self.chart.states(disk, table, degrees)
        # Coordinates that were given stay as they are, to the last digit and also where they are no state.
        given = {} if degrees else {name: table[name] for name in self.chart.present(table)}
        coordinates = {name: given.get(name, values) for name, values in _coordinates(states).items()}
        # A column in degrees must not come back under a name that stands for radians.
        relabelled = self.chart.in_radians(table) if degrees else ()
        own = {
            f"given_{name}" if name in relabelled else name: values
            for name, values in table.items()
            if name not in coordinates or degrees
        }
        return Block(states, row | coordinates, own)

    def _table(self, first: int, count: int) -> Columns:
        import pyarrow as pa

        if isinstance(self.columns, dict):
            return {name: values[first : first + count] for name, values in self.columns.items()}
        assert self.columns is not None
        assert self.chart is not None
        try:
            found = self.columns.read(first, count)
        except (OSError, UnicodeDecodeError, pa.ArrowException) as error:
            raise InputError(f"{self.what}: cannot be read ({_in_one_line(error)}); put the file back") from None
        return _read(found, self.chart, self.what)


def _read(given: Mapping[str, Any], chart: Chart, what: str) -> Columns:
    """Columns that say where the disk is as numbers, and the user's own as they can be stored."""
    numbers = chart.present(given)
    return {
        name: (as_numbers if name in numbers else as_own)(name, values, what) for name, values in given.items()
    }


def _coordinates(states: States) -> Columns:
    """phi, phidot, sigma3, sigma4 in the units of the disk; NaN where there is no state."""
    good = states.status != compiled.status.Status.BAD_INPUT
    return {name: np.where(good, getattr(states, name), np.nan) for name in COORDINATES}


def _digest(arrays: Mapping[str, Any]) -> str:
    digest = hashlib.sha256()
    for name, values in arrays.items():
        digest.update(f"{name}:{values.dtype}:{values.shape};".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def _in_one_line(error: Exception) -> str:
    lines = str(getattr(error, "strerror", None) or error).splitlines()
    return lines[0][:120] if lines else type(error).__name__
