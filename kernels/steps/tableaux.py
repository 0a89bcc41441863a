"""Runge-Kutta coefficients that check themselves, as exact fractions.

A tableau verifies on construction that its nodes are its row sums and that every order
condition (one for each rooted tree) holds exactly up to the order it claims, for the solution
and for the embedded solution. A misprint cannot be imported.

Sources: Kutta (1901), the classical method; Dormand & Prince, J. Comput. Appl. Math. 6 (1980)
19-26, RK5(4)7M.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction as F
from functools import cache
from typing import Any

from kernels.steps import coefficients853 as dop853

Tree = tuple  # a rooted tree is the sorted tuple of its subtrees; () is the single node
Rows = tuple[tuple, ...]
Sum = Callable[[Iterable], Any]
Branches = dict[Tree, list]


@cache
def trees(nodes: int) -> tuple[Tree, ...]:
    """All rooted trees with that many nodes."""
    if nodes == 1:
        return ((),)
    grown = set()
    for size in range(1, nodes):
        for branch in trees(size):
            for rest in trees(nodes - size):
                grown.add(tuple(sorted((*rest, branch))))
    return tuple(sorted(grown))


@cache
def tree_size(tree: Tree) -> int:
    """How many nodes a tree has."""
    return 1 + sum(tree_size(branch) for branch in tree)


@cache
def tree_density(tree: Tree) -> int:
    """gamma(tree): the order condition is sum_i b_i Phi_i(tree) = 1 / gamma(tree)."""
    product = tree_size(tree)
    for branch in tree:
        product *= tree_density(branch)
    return product


def elementary_weight(a: Rows, weights: Iterable, tree: Tree, add: Sum, known: Branches | None = None) -> Any:
    """sum_i weights_i Phi_i(tree) of the method with rows a; `add` says how its numbers are added up.

    known: what the branches of other trees gave, with the same rows and the same `add`.
    """
    stages = _stage_weights(a, tree, add, {} if known is None else known)
    return add(w * s for w, s in zip(weights, stages, strict=True))


def _stage_weights(a: Rows, tree: Tree, add: Sum, known: Branches) -> list:
    result: list = [1] * len(a)
    for branch in tree:
        if branch not in known:
            inner = _stage_weights(a, branch, add, known)
            known[branch] = [add(x * inner[j] for j, x in enumerate(row)) for row in a]
        result = [stage * below for stage, below in zip(result, known[branch], strict=True)]
    return result


def defects(a: Rows, weights: Iterable, order: int, add: Sum) -> Iterator[tuple[str, Any]]:
    """By how much each order condition up to `order` fails, and which it is."""
    known: Branches = {}  # trees share most of their branches
    for nodes in range(1, order + 1):
        for tree in trees(nodes):
            defect = elementary_weight(a, weights, tree, add, known) - F(1, tree_density(tree))
            yield f"order condition {tree} of order {nodes} fails", defect


@dataclass(frozen=True)
class Tableau:
    """An explicit Runge-Kutta method: a (strictly lower rows), b, and optionally embedded b.

    Raises ValueError on construction if the coefficients do not have the orders claimed.
    """

    name: str
    order: int
    a: tuple[tuple[F, ...], ...]
    b: tuple[F, ...]
    c: tuple[F, ...]
    embedded: tuple[F, ...] | None = None
    embedded_order: int = 0

    def __post_init__(self) -> None:
        if len(self.a) != len(self.b) or any(len(row) != i for i, row in enumerate(self.a)):
            raise ValueError(f"tableau {self.name}: row i of a must have i entries, one row per stage")
        if any(sum(row, F(0)) != node for row, node in zip(self.a, self.c, strict=True)):
            raise ValueError(f"tableau {self.name}: a node differs from its row sum")
        self._verify(self.b, self.order)
        if self.embedded is not None:
            self._verify(self.embedded, self.embedded_order)

    def _verify(self, weights: tuple[F, ...], order: int) -> None:
        for condition, defect in defects(self.a, weights, order, sum):
            if defect != 0:
                raise ValueError(f"tableau {self.name}: {condition}")

    @property
    def a_floats(self) -> tuple[tuple[float, ...], ...]:
        """Rows of a from the second stage on."""
        return tuple(tuple(map(float, row)) for row in self.a[1:])

    @property
    def b_floats(self) -> tuple[float, ...]:
        """Weights of the solution."""
        return tuple(map(float, self.b))

    @property
    def error_floats(self) -> tuple[float, ...]:
        """b minus embedded b: the weights of the local error estimate."""
        assert self.embedded is not None
        return tuple(float(x - y) for x, y in zip(self.b, self.embedded, strict=True))


CLASSICAL_RK4 = Tableau(
    name="classical RK4",
    order=4,
    a=((), (F(1, 2),), (F(0), F(1, 2)), (F(0), F(0), F(1))),
    b=(F(1, 6), F(1, 3), F(1, 3), F(1, 6)),
    c=(F(0), F(1, 2), F(1, 2), F(1)),
)

DORMAND_PRINCE_54 = Tableau(
    name="Dormand-Prince 5(4)",
    order=5,
    a=(
        (),
        (F(1, 5),),
        (F(3, 40), F(9, 40)),
        (F(44, 45), F(-56, 15), F(32, 9)),
        (F(19372, 6561), F(-25360, 2187), F(64448, 6561), F(-212, 729)),
        (F(9017, 3168), F(-355, 33), F(46732, 5247), F(49, 176), F(-5103, 18656)),
        (F(35, 384), F(0), F(500, 1113), F(125, 192), F(-2187, 6784), F(11, 84)),
    ),
    b=(F(35, 384), F(0), F(500, 1113), F(125, 192), F(-2187, 6784), F(11, 84), F(0)),
    c=(F(0), F(1, 5), F(3, 10), F(4, 5), F(8, 9), F(1), F(1)),
    embedded=(F(5179, 57600), F(0), F(7571, 16695), F(393, 640), F(-92097, 339200), F(187, 2100), F(1, 40)),
    embedded_order=4,
)


@dataclass(frozen=True)
class Tableau853:
    """Dormand and Prince's explicit method of order 8 with twelve stages, in floating point.

    fifth, third: weights of the local errors of orders 5 and 3. Raises ValueError on construction if
    an order condition fails by more than rounding.
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    fifth: tuple[float, ...]
    third: tuple[float, ...]

    def __post_init__(self) -> None:
        solutions = ((self.b, 8), (_minus(self.b, self.fifth), 5), (_minus(self.b, self.third), 3))
        for weights, order in solutions:
            for condition, defect in defects(self.a, weights, order, math.fsum):
                # Digits of a double: every row rounds by some 1e-16.
                if abs(defect) > 1e-13:
                    raise ValueError(f"tableau 8(5,3): {condition}")


def _minus(x: tuple[float, ...], y: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(a - b for a, b in zip(x, y, strict=True))


DORMAND_PRINCE_853 = Tableau853(dop853.A, dop853.B, dop853.FIFTH, dop853.THIRD)
