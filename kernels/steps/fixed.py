"""One fixed step: the classical fourth-order Runge-Kutta method."""

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.field import State, field, shift
from kernels.steps.tableaux import CLASSICAL_RK4, floats

_A = tuple(map(floats, CLASSICAL_RK4.a[1:]))
_B = floats(CLASSICAL_RK4.b)


@device
def rk4_step(x: State, h: float, b: Body) -> State:
    """The state one step of length h in s later."""
    k1 = field(x, b)
    k2 = field(shift(x, h * _A[0][0], k1), b)
    k3 = field(shift(x, h * _A[1][1], k2), b)
    k4 = field(shift(x, h * _A[2][2], k3), b)
    y = shift(shift(x, h * _B[0], k1), h * _B[1], k2)
    return shift(shift(y, h * _B[2], k3), h * _B[3], k4)
