"""Types of what kernels take.

Each name is what an editor and mypy see; the numba type stands in its annotation, from which `_jit.kernel`
reads the signature. Arrays are contiguous, in the order of C.
"""

from typing import Annotated

import numpy as np
from numba import float64, int8, int32, int64

_VECTOR, _MATRIX, _TABLE = float64[::1], float64[:, ::1], float64[:, :, ::1]
_CODES, _COUNTS, _LONGS = int8[::1], int32[::1], int64[::1]

Vector = Annotated[np.ndarray[tuple[int], np.dtype[np.float64]], _VECTOR]
Matrix = Annotated[np.ndarray[tuple[int, int], np.dtype[np.float64]], _MATRIX]
Table = Annotated[np.ndarray[tuple[int, int, int], np.dtype[np.float64]], _TABLE]
Codes = Annotated[np.ndarray[tuple[int], np.dtype[np.int8]], _CODES]
Counts = Annotated[np.ndarray[tuple[int], np.dtype[np.int32]], _COUNTS]
Longs = Annotated[np.ndarray[tuple[int], np.dtype[np.int64]], _LONGS]
