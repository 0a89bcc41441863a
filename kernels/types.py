"""numba types of what kernels take, for their explicit signatures."""

from numba import float64, int8, int32, int64
from numba.types import NamedTuple, NamedUniTuple, UniTuple

from kernels.body import Body
from kernels.chaplygin import DEGREE
from kernels.events import Event
from kernels.tables import LOW_DEGREE, Low, Tables, Whole

body = NamedUniTuple(float64, len(Body._fields), Body)
event = NamedUniTuple(float64, len(Event._fields), Event)
number = float64
integer = int64
vector = float64[::1]
matrix = float64[:, ::1]
table = float64[:, :, ::1]
low = NamedUniTuple(UniTuple(float64, LOW_DEGREE + 1), len(Low._fields), Low)
whole = NamedUniTuple(UniTuple(float64, DEGREE + 1), len(Whole._fields), Whole)
tables = NamedTuple((matrix, matrix, matrix, matrix, low), Tables)
codes = int8[::1]
counts = int32[::1]
longs = int64[::1]
