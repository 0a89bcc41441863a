"""Columns that a user gives, in memory or in a file, as arrays of numbers or of text.

A cell that should be a number and is none becomes NaN, so that its row is bad input and the others are computed.
A column that no cell of which is a number is a mistake, and refused.
"""

import codecs
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, double_of
from explorer.phase.arguments import entry_of, plain_array
from explorer.phase.states import COORDINATES, Array

if TYPE_CHECKING:
    import pyarrow as pa

Columns = dict[str, NDArray[Any]]


class DataFrame(Protocol):
    """A table of any library that names its columns and gives one by its name."""

    @property
    def columns(self) -> Any: ...

    def __getitem__(self, name: Any, /) -> Any: ...


_SEPARATORS = (",", ";", "\t")
_TEXT = ("large_string", "string", "string_view")


def as_columns(given: Any, what: str) -> dict[str, Any]:
    """The columns of a table in memory, as they come; InputError where `given` is no table.

    A DataFrame of any kind, an Arrow table, a structured array, a mapping of columns (a number stands for a
    column), or an array with rows of phi, phidot, sigma3, sigma4.
    """
    import pyarrow as pa

    if isinstance(given, Mapping):
        return _together({str(name): values for name, values in given.items()}, what)
    if isinstance(given, np.ndarray) and given.dtype.names:
        return {name: np.ravel(given[name]) for name in given.dtype.names}
    if isinstance(given, np.ndarray | list | tuple):
        try:
            rows = plain_array(given)
        except ValueError:
            raise InputError(f"{what}: its rows differ in length; give rows of {', '.join(COORDINATES)}") from None
        if rows.ndim != 2 or rows.shape[1] != len(COORDINATES):
            raise InputError(f"{what}: shape {rows.shape} is not (n, 4); give rows of {', '.join(COORDINATES)}")
        return dict(zip(COORDINATES, rows.T, strict=True))
    if isinstance(given, pa.Table):
        return {name: from_arrow(given.column(name)) for name in _once(given.column_names, what)}
    columns = getattr(given, "columns", None)
    if isinstance(columns, Mapping):
        return _together(dict(columns), what)
    if columns is not None and hasattr(given, "__getitem__"):
        return {str(name): given[name] for name in _once(list(columns), what)}
    raise InputError(
        f"{what}: {type(given).__name__} is no table; give a path, a DataFrame, a structured array, a dict of "
        "columns, or States"
    )


def _once(names: list[Any], what: str) -> list[Any]:
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise InputError(f"{what}: has several columns {sorted(map(str, twice))[0]!r}; rename or drop all but one")
    return names


def _together(columns: dict[str, Any], what: str) -> dict[str, Any]:
    """Columns of one length, where a single number stands for a whole column."""
    arrays = {name: _array(name, values, what) for name, values in columns.items()}
    lengths = {name: len(values) for name, values in arrays.items() if values.ndim}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise InputError(f"{what}: columns differ in length: {said}")
    length = max(lengths.values(), default=1)
    return {name: values if values.ndim else np.full(length, values) for name, values in arrays.items()}


def as_numbers(name: str, values: Any, what: str) -> Array:
    """A column of coordinates as doubles; NaN for cells that are no number."""
    column = _plain(name, values, what)
    if column.dtype.kind in "fiu":
        return column.astype(np.float64)
    dates = column.dtype.kind in "mM"  # some of them become integers in a list
    numbers = np.array([np.nan if dates else _number(cell) for cell in column.tolist()], dtype=np.float64)
    if numbers.size and np.isnan(numbers).all():
        raise InputError(f"{what}: column {name!r} holds no numbers")
    return numbers


def as_own(name: str, values: Any, what: str) -> NDArray[Any]:
    """A column of the user's own as it can be stored: numbers, truth values, times, or text."""
    column = _plain(name, values, what)
    return column if column.dtype.kind in "fiubMmU" else _own(column.tolist())


def _own(cells: list[Any]) -> NDArray[Any]:
    """Objects as numbers where all are, as text otherwise."""
    empty = [cell is None or str(cell) == "<NA>" or cell != cell for cell in cells]
    if all(none or isinstance(cell, int | float) for cell, none in zip(cells, empty, strict=True)):
        return np.array([np.nan if none else float(c) for c, none in zip(cells, empty, strict=True)], float)
    return np.array(["" if none else str(cell) for cell, none in zip(cells, empty, strict=True)], dtype=np.str_)


def _plain(name: str, values: Any, what: str) -> NDArray[Any]:
    """A flat array in the machine's own byte order; masked cells are missing."""
    column = _array(name, values, what)
    if column.ndim != 1:
        raise InputError(f"{what}: column {name!r} has shape {column.shape}; give one entry for each state")
    if column.dtype.kind == "S":
        column = column.astype(np.str_)
    if column.dtype.kind not in "fiubMmUO":
        raise InputError(f"{what}: column {name!r} holds {column.dtype}; give real numbers or text")
    return column.astype(column.dtype.newbyteorder("="), copy=False)


def _array(name: str, values: Any, what: str) -> NDArray[Any]:
    """An array that shows nothing masked. Raises InputError for lists in lists that differ in length."""
    try:
        return plain_array(values)
    except ValueError:
        raise InputError(f"{what}: column {name!r} holds several shapes; give one entry for each state") from None


def _number(cell: Any) -> float:
    """A cell of a table, where text may be a number too; NaN for what is none."""
    read = double_of(cell) if isinstance(cell, str) else entry_of(cell)
    return float("nan") if read is None else read


def from_arrow(column: Any) -> NDArray[Any]:
    """An Arrow column as an array; a dictionary's entries are looked up."""
    import pyarrow as pa

    if pa.types.is_dictionary(column.type):
        column = column.cast(column.type.value_type)
    values: NDArray[Any] = column.to_numpy()
    return values


def storable(kind: "pa.DataType") -> bool:
    """Whether a column of this Arrow type can be kept with the results."""
    import pyarrow as pa

    t = pa.types
    kind = kind.value_type if t.is_dictionary(kind) else kind
    tests = (t.is_boolean, t.is_integer, t.is_floating, t.is_decimal, t.is_temporal)
    return str(kind) in _TEXT or any(test(kind) for test in tests)


class ParquetColumns:
    """The columns of a Parquet file, read by row groups, so that memory does not grow with the file."""

    def __init__(self, path: Path) -> None:
        import pyarrow.parquet as pq

        self._path = path
        with pq.ParquetFile(path) as file:
            self._kinds = dict(zip(file.schema_arrow.names, file.schema_arrow.types, strict=True))
            self.names = list(file.schema_arrow.names)
            groups = [file.metadata.row_group(i).num_rows for i in range(file.metadata.num_row_groups)]
        self._ends = np.cumsum(groups)
        self.rows = int(sum(groups))

    def check(self, numbers: tuple[str, ...], what: str) -> None:
        """Raise InputError for a column of another type than is needed."""
        import pyarrow as pa

        for name, kind in self._kinds.items():
            t = pa.types
            if name in numbers and not (t.is_floating(kind) or t.is_integer(kind) or t.is_decimal(kind)):
                raise InputError(f"{what}: column {name!r} holds {kind}; it must hold numbers")
            if not storable(kind):
                raise InputError(f"{what}: column {name!r} holds {kind}, which results cannot keep; leave it out")
        _once(self.names, what)

    def read(self, first: int, count: int) -> dict[str, Any]:
        """Rows first ... first + count - 1. Raises OSError or ArrowException where the file is damaged."""
        import pyarrow.parquet as pq

        low, high = np.searchsorted(self._ends, [first, first + count - 1], side="right")
        with pq.ParquetFile(self._path, page_checksum_verification=True) as file:
            table = file.read_row_groups(range(low, high + 1))
        before = int(self._ends[low - 1]) if low else 0
        part = table.slice(first - before, count)
        return {name: from_arrow(part.column(name)) for name in self.names}


def read_csv(path: Path, numbers: Mapping[str, Any], what: str) -> Columns:
    """All columns of a CSV file: those among `numbers` as doubles, the others as they are best stored.

    The first line names the columns; they are separated by commas, semicolons or tabs. A line with too few or
    too many cells is a row without numbers.
    """
    import pyarrow as pa
    from pyarrow import csv

    names, separator = csv_header(path, what)
    _check_text(path, what)
    bad: list[int] = []

    def note(row: Any) -> str:
        bad.append(row.number)
        return "skip"

    table = csv.read_csv(
        path,
        read_options=csv.ReadOptions(use_threads=False, skip_rows=1, column_names=names, encoding="utf8"),
        parse_options=csv.ParseOptions(delimiter=separator, invalid_row_handler=note),
        convert_options=csv.ConvertOptions(
            column_types=dict.fromkeys(names, pa.string()), strings_can_be_null=True, null_values=[""]
        ),
    )
    # Rows are numbered as the file's lines, the header being the first; what was skipped goes back to its place.
    places = [number - 2 - i for i, number in enumerate(bad)]
    columns: Columns = {}
    for name in names:
        cells = table.column(name)
        column = _csv_numbers(name, cells, what) if name in numbers else _csv_own(cells)
        columns[name] = _with_gaps(column, places) if places else column
    return columns


def _with_gaps(column: NDArray[Any], places: list[int]) -> NDArray[Any]:
    """The column with an empty cell before each of the places."""
    if column.dtype.kind == "U":
        return np.insert(column, places, "")
    return np.insert(column.astype(np.float64), places, np.nan)


def _check_text(path: Path, what: str) -> None:
    """Raise InputError where a file is not text in UTF-8; its reader would print what it stumbles over."""
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        with path.open("rb") as stream:
            while piece := stream.read(1 << 20):
                decoder.decode(piece)
            decoder.decode(b"", final=True)
    except UnicodeDecodeError:
        raise InputError(f"{what}: is neither Parquet nor CSV in UTF-8; store it as one of them") from None


def csv_header(path: Path, what: str) -> tuple[list[str], str]:
    """The names in the first line, and what separates them."""
    with path.open("rb") as stream:
        line = stream.readline(1 << 16)
    try:
        text = line.decode("utf-8-sig").strip()
    except UnicodeDecodeError:
        raise InputError(f"{what}: is neither Parquet nor CSV in UTF-8; store it as one of them") from None
    if not text or "\0" in text:
        raise InputError(f"{what}: {'is empty' if not line else 'is neither Parquet nor CSV'}; give a table")
    separator = max(_SEPARATORS, key=text.count)
    names = [name.strip().strip('"').strip() for name in text.split(separator)]
    return _once(names, what), separator


def _csv_numbers(name: str, cells: Any, what: str) -> Array:
    import pyarrow as pa
    import pyarrow.compute as pc

    trimmed = pc.utf8_trim_whitespace(cells)
    try:
        return np.asarray(pc.cast(trimmed, pa.float64()).to_numpy(), dtype=np.float64)
    except pa.ArrowInvalid:  # some cell is no number; the others are
        return as_numbers(name, trimmed.to_numpy(), what)


def _csv_own(cells: Any) -> NDArray[Any]:
    """Whole numbers, numbers or text, whichever all cells are."""
    import pyarrow as pa
    import pyarrow.compute as pc

    for kind in (pa.int64(), pa.float64()):
        try:
            return from_arrow(pc.cast(pc.utf8_trim_whitespace(cells), kind))
        except pa.ArrowInvalid:
            continue
    return as_own("", cells.to_numpy(), "")
