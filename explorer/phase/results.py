"""What all results of Python calls share: their columns as a table, and a short description."""

import html
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, shown
from explorer.phase.columns import COLUMNS, SI, Column
from explorer.phase.disk import Disk

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

Columns = dict[str, NDArray[Any]]  # by name, of one length
Status = compiled.status.Status
_NAMES = [code.name.lower() for code in Status]
_SHOWN = 6  # columns whose medians the description gives: what fits on a screen beside code
COORDINATES = ("phi", "phidot", "sigma3", "sigma4")
_SIDED = ("race_angle", "delta_chi", "delta_psi")  # whose medians are told for each side of F
_AXES = {3: "xyz"}  # what the entries of a vector are called; others are counted


class Shaped:
    """Base class of samples that have a shape: a dataclass of arrays, which is indexed as each of them.

    All arrays have this shape, with axes of their own behind it, of vectors for instance. A single sample has the
    shape (), and numbers of numpy. If there are `states`, there is one for each sample, or for as many samples in
    a row as the axes behind those of the states have entries.
    """

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape that all arrays share."""
        return min((values.shape for values in self._arrays().values()), key=len, default=())

    @property
    def size(self) -> int:
        """Number of samples, whatever the shape."""
        return math.prod(self.shape)

    def __len__(self) -> int:
        """Number of entries along the first axis, as of an array. A single sample has none: TypeError."""
        if not self.shape:
            raise TypeError(f"{type(self).__name__} of a single sample has no length")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return (self[place] for place in range(len(self)))

    def __getitem__(self, key: Any) -> Self:
        """Some of the samples. Index as you would an array of this shape: by numbers, slices, masks or lists.

        Examples
        --------
        >>> import explorer as ex
        >>> states = ex.phi_to_states(ex.Disk.uniform(), [[0.0], [0.1]], 1.0, [1.0, 2.0, 3.0], 0.7)
        >>> states[1].shape, states[0, 2].sigma3, ex.constants(states)[states.sigma3 > 1.5].energy.shape
        ((3,), np.float64(3.0), (4,))
        """
        places = np.asarray(np.arange(self.size).reshape(self.shape)[key])
        return self.at(places.ravel()).reshaped(places.shape)

    def at(self, rows: NDArray[np.intp]) -> Self:
        """Some of the samples in a row, by their numbers among all."""
        rows = np.arange(self.size)[rows]
        arrays = {name: v.reshape(self.size, *v.shape[len(self.shape) :]) for name, v in self._arrays().items()}
        states = getattr(self, "states", None)
        if states is not None:
            states = states.at(rows // max(self.size // max(states.size, 1), 1))
        return self._with({name: values[rows] for name, values in arrays.items()}, states)

    def reshaped(self, shape: tuple[int, ...]) -> Self:
        """These samples, whose arrays have a first axis for all of them, in a shape of their own."""
        states = getattr(self, "states", None)
        arrays = {name: in_shape(values, shape) for name, values in self._arrays().items()}
        return self._with(arrays, None if states is None else states.reshaped(shape))

    def _title(self) -> str:
        """What the description calls it."""
        shape = " x ".join(map(str, self.shape))
        return f"{type(self).__name__} of {self.size:,}" + (f" ({shape})" if len(self.shape) > 1 else "")

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """All arrays of this object by name, also where they have a single entry and no axis."""
        named = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        arrays = np.ndarray | np.generic
        return {name: np.asarray(values) for name, values in named.items() if isinstance(values, arrays)}

    def _with(self, arrays: dict[str, NDArray[Any]], states: Any) -> Self:
        """This object with other arrays, and other states where it has any."""
        more = {} if states is None else {"states": states}
        return replace(self, **arrays, **more)  # type: ignore[type-var]


def in_shape(values: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """Values of samples along a first axis, in the shape of these; without any axis, a number of numpy."""
    reshaped: NDArray[Any] = values.reshape((*shape, *values.shape[1:]))[()]
    return reshaped


class WithStatus(Shaped):
    """Base class of what has a status for each sample."""

    status: NDArray[np.int8]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which samples were computed to the accuracy asked."""
        good: NDArray[np.bool_] = self.status == Status.OK
        return good

    @property
    def status_names(self) -> NDArray[np.str_]:
        """The status of each sample as a word, such as 'ok' or 'falls'."""
        names: NDArray[np.str_] = np.array(_NAMES)[self.status]
        return names

    def _counted(self) -> str:
        """How many samples have each status, in words."""
        counts = count_status(np.ravel(self.status))
        return ", ".join(f"{name} {count:,}" for name, count in counts.items()) or "none"


def count_status(status: NDArray[np.int8]) -> dict[str, int]:
    """Number of samples that ended in each status, for those that occur; names in lower case."""
    codes, counts = np.unique(status, return_counts=True)
    return {Status(code).name.lower(): count for code, count in zip(codes.tolist(), counts.tolist(), strict=True)}


def require_ok(found: WithStatus, what: str) -> None:
    """Raise InputError where a sample is not ok: `what`, and the sentence and the remedy of the first status."""
    failed = np.extract(~found.ok, found.status)
    if failed.size:
        code = Status(int(failed[0]))
        raise InputError(f"{what}: {code.sentence} {code.remedy}")


class Table(Shaped):
    """Base class of what has columns and no statuses: a dataclass of arrays, or of numbers."""

    _GIVEN: ClassVar[tuple[str, ...]] = ()  # arguments among the columns, which the description leaves out

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name, the arguments first."""
        states = getattr(self, "states", None)
        names = COORDINATES if states is not None else ()
        return {name: self._of_each_state(getattr(states, name)) for name in names} | self._arrays()

    def _of_each_state(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the states, one for each entry of the arrays.

        What follows a state has its axes first and may have more, for its bounces for instance.
        """
        shape = getattr(self, "states", self).shape
        more = (1,) * (len(self.shape) - len(shape))
        return np.broadcast_to(np.reshape(values, (*shape, *more)), self.shape)

    def to_pandas(self) -> "pd.DataFrame":
        """A DataFrame with one row for each sample, in the order of flattened arrays; status by name."""
        frame = self.to_arrow().to_pandas()
        if "status" in frame:
            frame["status"] = frame["status"].copy()  # what Arrow holds cannot be written
        return frame

    def to_arrow(self) -> "pa.Table":
        """The table of `to_pandas`, in Arrow; the metadata of each field states its meaning, unit and equation."""
        return to_arrow(self.columns, len(self.shape))

    def _good(self) -> NDArray[np.bool_]:
        """Samples whose numbers the description speaks of."""
        return np.ones(self.shape, dtype=bool)

    def _lines(self) -> list[tuple[str, str]]:
        """What the description says: name and text."""
        lines: list[tuple[str, str]] = []
        good = self._good()
        for name, values in self._arrays().items():
            if (
                name in self._GIVEN
                or values.dtype.kind != "f"
                or values.shape != good.shape
                or len(lines) == _SHOWN
            ):
                continue
            parts = {"": good & np.isfinite(values)}
            side = getattr(self, "side", None)
            if name in _SIDED and side is not None and np.unique(np.extract(parts[""], side)).size > 1:
                parts = {f" where eta {sign} 0": parts[""] & (side * s > 0) for s, sign in ((1, ">"), (-1, "<"))}
            unit = unit_of(name, getattr(getattr(self, "states", self), "disk", None))
            ranges = [
                f"{_spread(values[rows])} {unit}".rstrip() + where for where, rows in parts.items() if rows.any()
            ]
            if ranges:
                lines.append((name, "; ".join(ranges)))
        return lines

    def __repr__(self) -> str:
        return "\n".join([self._title(), *(f"  {name}: {text}" for name, text in self._lines())])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th><td style='text-align:left'>"
            f"{html.escape(text)}</td></tr>"
            for name, text in self._lines()
        )
        return f"<table><caption>{html.escape(self._title())}</caption>{rows}</table>"


R = TypeVar("R", bound="Result")
S = TypeVar("S", bound=np.generic)


class Result(WithStatus, Table):
    """Base class of results: a dataclass with one array for each column, all of one shape, `status` among them.

    The arrays have the shape to which the arguments broadcast; of plain numbers they are numbers of numpy. What a
    result has several of, such as bounces, has axes of its own behind. The arguments are columns too: own ones,
    or those of `states` where the result has that. What else a result knows, the method for instance, are plain
    fields.
    """

    def among(self, rows: NDArray[np.intp], status: NDArray[np.int8]) -> Self:
        """Put this result, of some rows, into one of all rows.

        status: of all rows, before this result was found for some of them. The others keep it, and are NaN, 0 or
        False.
        """
        expanded = np.empty((status.size, *self.shape[1:]), np.int8)
        expanded[:] = status.reshape(-1, *(1,) * (expanded.ndim - 1))
        expanded[rows] = self.status
        arrays: dict[str, NDArray[Any]] = {}
        for name, values in self._arrays().items():
            blank = np.array(np.nan if values.dtype.kind == "f" else 0, values.dtype)
            arrays[name] = np.full(expanded.shape, blank)
            arrays[name][rows] = np.where(self.ok, values, blank)
        return replace(self, **arrays | {"status": expanded})  # type: ignore[type-var]

    def _good(self) -> NDArray[np.bool_]:
        return self.ok

    def _lines(self) -> list[tuple[str, str]]:
        """What the description says: counts of statuses, their remedies, and medians of samples that are ok."""
        codes, numbers = [Status(code) for code in np.unique(self.status).tolist()], super()._lines()
        of = f" (numbers below: of the {self.ok.sum():,} ok)" if numbers and len(codes) > 1 else ""
        remedies = [(code.name.lower(), code.remedy) for code in codes if code != Status.OK]
        return [("status", self._counted() + of), *remedies, *numbers]


def joined(parts: Sequence[R]) -> R:
    """The results of parts of samples, one after another along their first axis."""
    if len(parts) == 1:
        return parts[0]
    return replace(parts[0], **stacked([part._arrays() for part in parts]))  # type: ignore[type-var]


def stacked(tables: Sequence[dict[str, NDArray[S]]]) -> dict[str, NDArray[S]]:
    """Tables with the same columns, one below the other."""
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def unit_of(name: str, disk: Disk | None = None) -> str:
    """The unit of a column: of SI where the disk is not in natural units."""
    unit = COLUMNS[name].unit if name in COLUMNS else ""
    return unit if disk is None or disk.m == disk.r == disk.g == 1.0 else SI.get(unit, unit)


def _spread(values: NDArray[Any]) -> str:
    """A number, or the median of several and between which they lie."""
    low, middle, high = values.min(), np.median(values), values.max()
    return f"{middle:.6g}" if values.size == 1 else f"median {middle:.6g}, {low:.6g} to {high:.6g}"


def status_codes(names: NDArray[Any]) -> NDArray[np.int8]:
    """Statuses as numbers, from words. Raises ValueError for a word that is none."""
    known, place = np.unique(np.asarray(names, dtype=str), return_inverse=True)
    return np.array([_NAMES.index(str(name)) for name in known], dtype=np.int8)[place]


def to_arrow(columns: dict[str, NDArray[Any]], axes: int = 1, known: Mapping[str, Column] = COLUMNS) -> "pa.Table":
    """An Arrow table of columns, status by name, with meaning, unit and equation in the metadata of known ones.

    axes: how many the samples have. What has more is a vector, whose entries become columns, of `path` path_x,
    path_y and path_z. known: what columns mean, by name.
    """
    import pyarrow as pa  # loaded only by those who ask for a table

    arrays, kinds = dict[str, Any](), []
    for name, values in columns.items():
        texts, entries = known[name].texts if name in known else None, values.shape[axes:]
        for place in np.ndindex(entries):
            letters = [_AXES[n][i] if n in _AXES else str(i) for i, n in zip(place, entries, strict=True)]
            entry = "_".join([name, *letters])
            if entry in arrays or (letters and entry in columns):
                raise InputError(f"a table would have two columns {shown(entry)}; give arrays other names")
            array = _arrow_array(values[(..., *place)])
            if name == "status" and values.dtype.kind in "iu":
                array = pa.DictionaryArray.from_arrays(array.cast(pa.int8()), _arrow_texts(_NAMES))
            arrays[entry] = array
            kinds.append(pa.field(entry, array.type, metadata=texts))
    return pa.Table.from_arrays([*arrays.values()], schema=pa.schema(kinds))


def _arrow_array(values: NDArray[Any]) -> "pa.Array":
    """A column as Arrow has it.

    Numbers go there by hand: `pa.array` loads pandas first, a quarter of a second.
    """
    import pyarrow as pa

    flat = np.ascontiguousarray(values.ravel())
    if flat.dtype.kind == "b":
        return _arrow_array(flat.view(np.uint8)).cast(pa.bool_())
    if flat.dtype.kind in "iuf" and flat.dtype.isnative:
        return pa.Array.from_buffers(pa.from_numpy_dtype(flat.dtype), flat.size, [None, pa.py_buffer(flat)])
    return pa.array(flat)


def _arrow_texts(texts: list[str]) -> "pa.Array":
    """As `_arrow_array`, of texts."""
    import pyarrow as pa

    encoded = [text.encode() for text in texts]
    ends = np.cumsum([0, *map(len, encoded)], dtype=np.int32)
    return pa.StringArray.from_buffers(len(texts), pa.py_buffer(ends), pa.py_buffer(b"".join(encoded)))
