"""What all results of Python calls share: their columns as a table, and a short description."""

import html
from collections import Counter
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.columns import COLUMNS

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

_SHOWN = 6  # columns whose medians the description gives: what fits on a screen beside code


class Result:
    """Base class of results: a dataclass with one array for each column, all of one shape, `status` among them.

    The arrays have the shape to which the arguments broadcast, and the arguments are columns too. What else a
    result knows, the method for instance, are plain fields.
    """

    status: NDArray[np.int8]

    def __len__(self) -> int:
        """Number of samples, whatever the shape."""
        return int(self.status.size)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape to which the arguments broadcast."""
        return self.status.shape

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Where the sample was computed to the accuracy asked."""
        return np.asarray(self.status == compiled.status.Status.OK)

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """All arrays by name."""
        named = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: values for name, values in named.items() if isinstance(values, np.ndarray)}

    @property
    def status_names(self) -> NDArray[np.str_]:
        """The status of each sample as a word, such as 'ok' or 'falls'."""
        names = np.array([code.name.lower() for code in compiled.status.Status])
        return np.asarray(names[self.status])

    def reshaped(self, shape: tuple[int, ...]) -> Self:
        """The same result with arrays of another shape."""
        arrays = {name: values.reshape(shape) for name, values in self.columns.items()}
        return replace(self, **arrays)  # type: ignore[type-var]

    def to_pandas(self) -> "pd.DataFrame":
        """A DataFrame with one row for each sample, in the order of flattened arrays; status by name.

        Raises
        ------
        ImportError
            Where pandas is not installed.
        """
        import pandas as pd  # an extra: nothing else needs it

        frame = pd.DataFrame({name: values.ravel() for name, values in self.columns.items()})
        names = [code.name.lower() for code in compiled.status.Status]
        frame["status"] = pd.Categorical(self.status_names.ravel(), names)
        return frame

    def to_arrow(self) -> "pa.Table":
        """An Arrow table as `to_pandas`; each field says its meaning, unit and equation in its metadata."""
        return to_arrow({**self.columns, "status": self.status_names})

    def _lines(self) -> list[tuple[str, str]]:
        """What the description says: name and text."""
        counts = Counter(self.status_names.ravel().tolist())
        lines = [("status", ", ".join(f"{name} {count:,}" for name, count in counts.items()) or "no samples")]
        good = self.ok
        for name, values in self.columns.items():
            known = values[good & np.isfinite(values)] if values.dtype.kind == "f" else values[:0]
            if known.size and len(lines) <= _SHOWN:
                unit = COLUMNS[name].unit if name in COLUMNS else ""
                low, middle, high = known.min(), np.median(known), known.max()
                lines.append((name, f"median {middle:.6g}, {low:.6g} to {high:.6g} {unit}".rstrip()))
        return lines

    def _title(self) -> str:
        shape = " x ".join(map(str, self.shape))
        return f"{type(self).__name__} of {len(self):,}" + (f" ({shape})" if len(self.shape) > 1 else "")

    def __repr__(self) -> str:
        return "\n".join([self._title(), *(f"  {name}: {text}" for name, text in self._lines())])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th><td style='text-align:left'>"
            f"{html.escape(text)}</td></tr>"
            for name, text in self._lines()
        )
        return f"<table><caption>{html.escape(self._title())}</caption>{rows}</table>"


def to_arrow(columns: dict[str, NDArray[Any]]) -> "pa.Table":
    """An Arrow table of columns, with meaning, unit and equation in the metadata of each known one."""
    import pyarrow as pa  # loaded only by those who ask for a table

    arrays, kinds = [], []
    for name, values in columns.items():
        array = pa.array(values.ravel())
        array = array.dictionary_encode() if name == "status" else array
        known = COLUMNS.get(name)
        arrays.append(array)
        kinds.append(pa.field(name, array.type, metadata=known.describe() if known else None))
    return pa.Table.from_arrays(arrays, schema=pa.schema(kinds))
