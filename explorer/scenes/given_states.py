"""States that a user gives: in a file, as a table in memory, or as `States`.

A cell that says that its number is missing becomes NaN, so that its row is bad input and the others are computed.
A cell with any other text is a mistake, and refused, as is a column without a number.
"""

import codecs
import gzip
import hashlib
import math
import re
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, double_of, number, said, shorten
from explorer.paths import path_of
from explorer.phase.columns import COLUMNS
from explorer.phase.constants import constants
from explorer.phase.coordinates import CHARTS, KNOWN, Chart, angle_unit, recognise
from explorer.phase.disk import Disk
from explorer.phase.results import Columns, Table
from explorer.phase.states import COORDINATES, Array, States

if TYPE_CHECKING:
    import pyarrow as pa

_PARQUET, _GZIP = b"PAR1", b"\x1f\x8b"  # how such files begin
_HEAD = 1 << 16  # characters of a CSV file that show how it is written
_AGREE = 1e-3  # two sets of coordinates in a table agree to the digits that people keep
_ASIDE = ("#", "%", "sep=")  # how lines before a table begin; Excel writes the last
_SPEEDS = {"phidot", "thetadot", "tilt_rate", "energy"}
# What stands in cells without a number, in small letters.
_MISSING = ("", "-", "--", "?", "n/a", "#n/a", "na", "<na>", "nan", "-nan", "null", "none")
_RECORD = {"file", "rows", "sha256", "degrees"}  # what run.json says of given states


class Block(NamedTuple):
    """Some states of a chunk.

    columns: phi, phidot, sigma3, sigma4, and `row` where the states were given. own: the user's own columns.
    """

    states: States
    columns: Columns
    own: Columns

    def at(self, rows: NDArray[np.intp] | slice) -> "Block":
        """Some of the states."""
        columns, own = ({name: values[rows] for name, values in part.items()} for part in self[1:])
        return Block(self.states.at(rows), columns, own)

    def with_results(self, results: Columns) -> Columns:
        """One table: the coordinates, the results, and the user's own columns.

        One of these whose name the others have is called given_NAME.
        """
        table = self.columns | results
        return table | _apart(self.own, table)


@dataclass(frozen=True, eq=False)
class GivenStates:
    """States that a user gives. A row that is no state gets the status BAD_INPUT, and the others are computed.

    what: how messages call them. sha256: of the bytes in files or of the numbers; it identifies a run. path: of a
    file, or of a folder of Parquet files. columns: of a table; None for `States`, and for Parquet, which is read
    piece by piece. groups: of Parquet, the file, number and rows of each row group. stamps: what `_stamps` said of
    its files before the digest was taken. chart: which columns say where the disk is; None for `States`, and of a
    stored run, whose file is opened when a row is needed. degrees:
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
    groups: tuple[tuple[Path, int, int], ...] = ()
    stamps: tuple[Any, ...] = ()

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
            digest = _digest({"natural": value.natural, "status": value.codes} | given)
            return cls(flag, value.size, digest, states=value)
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
        """From CSV or Parquet: a file, or a folder of Parquet. Raises InputError where it says no state."""
        what, digest = f"{flag} {path}", hashlib.sha256()
        with _reading(what, remedy):
            stamps = _stamps(path)
            for file, *_ in stamps:
                with file.open("rb") as stream:
                    hashlib.file_digest(stream, lambda: digest)
            with stamps[0][0].open("rb") as stream:
                parquet = path.is_dir() or stream.read(len(_PARQUET)) == _PARQUET
            if parquet:
                return cls._of_parquet(what, path, stamps, digest.hexdigest())
            table, point = _csv(path)
            _require_still(what, path, stamps)
        chart = _chart(table.column_names, what)
        columns = _read(table, chart, what, point=point)
        return cls(what, table.num_rows, digest.hexdigest(), path, chart, columns, stamps=stamps)

    @classmethod
    def _of_parquet(cls, what: str, path: Path, stamps: tuple[Any, ...], digest: str) -> "GivenStates":
        """From Parquet files, which are read piece by piece."""
        import pyarrow.parquet as pq

        groups = list[tuple[Path, int, int]]()
        for file, *_ in stamps:
            with _reading(f"{what}: {file.name}", "remove it, or write it again"):
                about = pq.read_metadata(file)
            groups += [(file, n, about.row_group(n).num_rows) for n in range(about.num_row_groups)]
        table = pq.read_schema(stamps[0][0]).empty_table()
        chart = _chart(table.column_names, what)
        _read(table, chart, what)  # refuses columns of types that are of no use
        count = sum(rows for *_, rows in groups)
        return cls(what, count, digest, path, chart, groups=tuple(groups), stamps=stamps)

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

    def read(self, disk: Disk, first: int, count: int, quiet: bool = True) -> Block:
        """Rows first ... first + count - 1. Raises InputError where the file has been damaged since.

        quiet: gives no warning of tilts that look like degrees.
        """
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
        states = self.chart.states(disk, table, self.degrees, quiet)
        known = coordinates_of(states)
        self._refuse_contradictions(disk, self.chart, table, states, first)
        # Those that were given stay as they are, to the last digit and also where they are no state. Others, and
        # those in degrees, must not come back under names that have a meaning here.
        kept = {} if self.degrees else {name: table[name] for name in self.chart.present(table)}
        own = _apart({name: values for name, values in table.items() if name not in kept}, COLUMNS)
        exact = {name: kept.pop(name) for name in COORDINATES if name in kept}
        return Block(states, row | known | exact, kept | own)

    def _refuse_contradictions(self, disk: Disk, chart: Chart, table: Columns, states: States, first: int) -> None:
        """Raise InputError where the table says other states too, but for mirror images."""
        found = constants(states)
        # sigma3_bar and sigma4_bar differ between mirror images, which other charts do not tell apart.
        names = ("sigma3_bar", "sigma4_bar", "energy") if "sigma3_bar" in chart.names else ("energy",)
        known = coordinates_of(states) | {name: getattr(found, name) for name in names}
        others = [other for other in CHARTS if {*other.names} - {"face", "tilt_rate"} <= {*table}]
        used = {name for each in (chart, *others) for name in each.names}
        for other in (*others, None):  # None: what belongs to no complete set
            lone = tuple(name for name in known if name in table and name not in used)
            sets = chart.present(table), other.present(table) if other else lone
            if other is chart or any(table[name].dtype.kind not in "iuf" for name in sets[1]):
                continue
            if other:
                seen = known | coordinates_of(other.states(disk, table, self.degrees, True))
                if not all(_SPEEDS & {*each} for each in sets):
                    seen["phidot"] = known["phidot"]  # only one of them says it
            else:
                seen = known | {name: table[name] * angle_unit(name, self.degrees) for name in lone}
            size = sum(abs(part[name]) for part in (known, seen) for name in COORDINATES[1:])
            both: dict[str, Any] = {name: abs(known[name]) + abs(seen[name]) for name in known}
            near = {name: _AGREE * (values + size) for name, values in both.items()}
            near |= {"phi": _AGREE, "energy": _AGREE * both["energy"]}
            if "energy" in sets[0] + sets[1]:  # of whose digits a rate has half
                near["phidot"] = math.sqrt(_AGREE) * (size + disk.rate_unit)
            for name in known:
                one, two = (abs(x[name]) if name in ("phi", "phidot") else x[name] for x in (known, seen))
                off = np.flatnonzero(abs(one - two) > near[name])
                if off.size:
                    values = f"by {', '.join(sets[0])} {one[off[0]]:g}, by {', '.join(sets[1])} {two[off[0]]:g}"
                    raise InputError(f"{self.what}: row {first + off[0]}: {name} is {values}; leave one set out")

    def _piece(self, chart: Chart, first: int, count: int) -> Columns:
        """Some rows of Parquet files: only the row groups that hold them are read."""
        import pyarrow as pa
        from pyarrow.parquet import ParquetFile

        ends = np.cumsum([0, *(rows for _, _, rows in self.groups)])
        low, high = np.searchsorted(ends[1:], [first, first + count - 1], side="right")
        with _reading(self.what, "put the file back"):
            some = self.groups[low : high + 1]
            parts = [ParquetFile(file, page_checksum_verification=True).read_row_group(n) for file, n, _ in some]
            table = pa.concat_tables(parts, promote_options="permissive").slice(first - ends[low], count)
            _require_still(self.what, self.path or Path(), self.stamps)
        return _read(table, chart, self.what, first)

    def told(self, rows: list[int]) -> list[str]:
        """Rows by number, each with those of its cells, as they are written, that hold no number."""
        given = self.opened
        if given.chart is None:
            return list(map(str, rows))
        columns = given._piece(given.chart, 0, max(rows) + 1) if given.columns is None else given.columns
        names = given.chart.present(columns)
        texts = columns
        if given.path and given.columns:
            texts = _csv(given.path, names)[0]
            _require_still(given.what, given.path, given.stamps)
        cells = [[f"{n} {str(texts[n][row])!r}" for n in names if math.isnan(columns[n][row])] for row in rows]
        return [f"{row} ({', '.join(at)})" if at else f"{row}" for row, at in zip(rows, cells, strict=True)]


def coordinates_of(states: States) -> Columns:
    """phi, phidot, sigma3, sigma4 in the units of the disk; NaN where there is no state."""
    return {name: getattr(states, name) for name in COORDINATES}


def _require_still(what: str, path: Path, stamps: tuple[Any, ...]) -> None:
    """Raise InputError where the files are not those whose digest was taken."""
    if _stamps(path) != stamps:
        raise InputError(f"{what}: was changed or replaced meanwhile; put it back")


def _stamps(path: Path) -> tuple[tuple[Path, int, int, int], ...]:
    """The files at a path, and what tells that one was changed or replaced: its size, time and number."""
    files = (path.is_dir() and sorted(path.glob("*.parquet"))) or [path]  # a folder without any cannot be read
    return tuple((file, (at := file.stat()).st_size, at.st_mtime_ns, at.st_ino) for file in files)


# Tables


def _apart(own: Columns, taken: Collection[str]) -> Columns:
    """A user's own columns, called given_NAME where their names are taken."""
    apart: Columns = {}
    for name, values in own.items():
        while name in taken or name in apart:
            name = f"given_{name}"
        apart[name] = values
    return apart


@contextmanager
def _reading(what: str, remedy: str) -> Iterator[None]:
    """Say in one sentence that a file cannot be read."""
    import pyarrow as pa

    try:
        yield
    except (OSError, EOFError, UnicodeError, zlib.error, IndexError, pa.ArrowException) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise InputError(f"{what}: cannot be read ({shorten(reason, 120)}); {remedy}") from None


def _table(given: Any, what: str) -> "pa.Table":
    """A table in memory as Arrow has it: of a frame of any library, or of a mapping of columns.

    Raises InputError where it is none.
    """
    import pyarrow as pa

    if isinstance(given, Table):  # a result of a call
        return given.to_arrow()
    try:
        if hasattr(given, "to_frame") and hasattr(given, "iloc"):  # a row of a frame of pandas
            if given.name in KNOWN or {*map(type, given.index)} != {str}:
                raise InputError(f"{what}: is a column of a frame, not a row; give the frame")
            given = given.to_frame().T
        if hasattr(given, "iloc"):  # of pandas, which would hand over its index as well
            return pa.Table.from_pandas(given, preserve_index=False)
        return pa.table(given)
    except (TypeError, ValueError, AttributeError, pa.ArrowException) as error:
        raise InputError(
            f"{what}: is no table ({shorten(str(error), 120)}); give a path, a DataFrame, a dict of columns of "
            "one length, or States"
        ) from None


def _csv(path: Path, texts: Collection[str] = ()) -> tuple["pa.Table", str]:
    """A CSV file, with commas, semicolons, tabs or spaces, and its decimal point; # and % begin comments.

    texts: columns whose cells are left as they are written.
    """
    import pyarrow as pa
    from pyarrow import csv

    content = _text(path)
    lines = content[:_HEAD].splitlines() or [""]
    first = next((n for n, line in enumerate(lines) if line.strip() and not line.startswith(_ASIDE)), 0)
    header, aside = lines[first], [line for line in lines[:first] if line.strip()]
    # numpy writes the names after a #, and then numbers.
    commented = bool(aside) and double_of(re.split(r"[,;\s]", header.strip())[0]) is not None
    if commented:
        header = max(reversed(aside), key=lambda line: len({*KNOWN} & {*re.findall(r"\w+", line)}))
    header = header.strip("#% ")
    separator = max(" ,;\t", key=header.replace(" ", "").count)
    blank = separator == " "
    names = [name.strip("\"' ") for name in header.split(None if blank else separator)]
    if blank:  # columns may be aligned
        content = re.sub(r"(?m)^ +| +(?=\r?$)", "", re.sub(" +", " ", content))
    if "\n#" in content or "\n%" in content:  # A label, as in #1, is no comment. Lines keep their numbers.
        content = re.sub(r"(?m)^[#%]+([ \t].*)?$", "", content)
    rows = [line.split(None if blank else separator) for line in lines[first:]]
    cells = [cell for row in rows for name, cell in zip(names, row, strict=False) if name in KNOWN]
    point = "." if separator == "," else max(".,", key=lambda each: sum(each in cell for cell in cells))
    missing = [spelt(word) for word in _MISSING for spelt in (str, str.upper, str.title)] + ["NaN"]
    whole = content.encode()
    # In one block, so that all of a column decides on its type.
    how = csv.ReadOptions(use_threads=False, block_size=min(len(whole) + 1, 2**31 - 1), skip_rows=first)
    if commented:
        how.column_names = names
    types = csv.ConvertOptions(decimal_point=point, null_values=[] if texts else missing)
    types.column_types = dict.fromkeys(texts, pa.string())
    table = csv.read_csv(pa.BufferReader(whole), how, csv.ParseOptions(delimiter=separator), types)
    return table.rename_columns([name.strip() for name in table.column_names]), point


def _text(path: Path) -> str:
    """What a text file holds, unpacked: UTF-8, UTF-16 where it says so, and Latin-1 where it is nothing else."""
    content = path.read_bytes()
    if content.startswith(_GZIP):
        content = gzip.decompress(content)
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        if wide or b"\0" in content:
            raise
        return content.decode("latin-1")


def _chart(names: list[str], what: str) -> Chart:
    """Which columns say where the disk is. Raises InputError where they say no state or not which."""
    twice = sorted(name for name in names if names.count(name) > 1)
    if twice:
        raise InputError(f"{what}: has several columns {twice[0]!r}; rename or drop all but one")
    return recognise(names, what)


def _read(table: "pa.Table", chart: Chart, what: str, first: int = 0, point: str = ".") -> Columns:
    """Columns that say where the disk is as numbers, and the user's own as they can be stored.

    first: number of the first row. point: the decimal point of texts.
    """
    numbers = chart.present(table.column_names)
    return {
        name: _numbers(table.column(name), f"{what}: column {name!r}", first, point)
        if name in numbers
        else _own(table.column(name), f"{what}: column {name!r}")
        for name in table.column_names
    }


def _numbers(column: Any, what: str, first: int, point: str) -> Array:
    """Doubles; NaN where a cell says that there is none. Raises InputError for another text."""
    import pyarrow.types as types

    if any(test(column.type) for test in (types.is_integer, types.is_floating, types.is_decimal)):
        return np.array(column.cast("float64", safe=False).to_numpy())
    cells = column.to_pylist()
    swap = str.maketrans(".,", ",.") if point == "," else {}  # a double has no comma
    plain = [cell.translate(swap) if isinstance(cell, str) else cell for cell in cells]
    read = [math.nan if c is None or str(c).strip().lower() in _MISSING else double_of(c) for c in plain]
    if None in read:
        row = read.index(None)
        where = f"{what}, row {first + row} (counted from 0)"
        number(where, cells[row])
        raise InputError(f"{said(where, cells[row])} is not a number where commas are decimal; write it with one")
    numbers = np.array(read, np.float64)
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
