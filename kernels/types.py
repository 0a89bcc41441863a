"""numba types of what kernels take, for their explicit signatures."""

from numba import float64, int8, int32, int64

number = float64
integer = int64
vector = float64[::1]
matrix = float64[:, ::1]
table = float64[:, :, ::1]
codes = int8[::1]
counts = int32[::1]
longs = int64[::1]
