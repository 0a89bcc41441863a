"""States that a user gives in a file."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from explorer.errors import InputError
from explorer.phase.states import COORDINATES, Array


@dataclass(frozen=True)
class StateFile:
    """States that a user gives: a Parquet file with columns phi, phidot, sigma3, sigma4.

    The sha256 of its bytes is part of what identifies a run. A row that is no state gets the status BAD_INPUT.
    """

    path: Path
    rows: int
    sha256: str

    @classmethod
    def open(cls, path: Path) -> "StateFile":
        """Raises InputError where the file cannot be read or lacks a column of numbers."""
        try:
            with path.open("rb") as stream:
                sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
            file = pq.ParquetFile(path)
        except (OSError, pa.ArrowException) as error:
            raise InputError(f"--states {path}: cannot be read as Parquet ({error})") from None
        for name in COORDINATES:
            kind = (
                file.schema_arrow.field(name).type
                if file.schema_arrow.names.count(name) == 1 and name in file.schema_arrow.names
                else None
            )
            if kind is None or not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
                raise InputError(f"--states {path}: needs a column of numbers {name!r}")
        if file.metadata.num_rows == 0:
            raise InputError(f"--states {path}: holds no states")
        return cls(path.resolve(), file.metadata.num_rows, sha256)

    def read(self, first: int, count: int) -> dict[str, Array]:
        """Rows first ... first + count - 1. Missing values are NaN."""
        from pyarrow.dataset import dataset  # takes half a second, and few runs need it

        table = dataset(self.path, format="parquet").scanner(columns=list(COORDINATES))
        rows = table.take(pa.array(np.arange(first, first + count)))
        return {name: rows[name].to_numpy().astype(np.float64) for name in COORDINATES}

    def describe(self) -> dict[str, str | int]:
        return {"file": str(self.path), "rows": self.rows, "sha256": self.sha256}
