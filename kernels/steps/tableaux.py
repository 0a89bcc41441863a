"""Runge-Kutta coefficients that check themselves, as exact fractions.

A tableau verifies on construction that every order condition (one for each rooted tree) holds exactly up to
the order it claims, for the solution and for the embedded ones. A misprint cannot be imported.

Sources: Kutta (1901), the classical method; Dormand & Prince, J. Comput. Appl. Math. 6 (1980)
19-26, RK5(4)7M, the embedded solution less the other; Hairer, Norsett & Wanner (1993), DOP853.
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
    """An explicit Runge-Kutta method: strictly lower rows a, weights b, and weights of local errors.

    errors: an order, and b less the weights of the embedded solution of that order. rounding: by how much an order
    condition may fail where coefficients are no fractions. Raises ValueError on construction if the coefficients
    do not have the orders claimed.
    """

    name: str
    order: int
    a: Rows
    b: tuple
    errors: tuple[tuple[int, tuple], ...] = ()
    rounding: float = 0.0

    def __post_init__(self) -> None:
        if len(self.a) != len(self.b) or any(len(row) != i for i, row in enumerate(self.a)):
            raise ValueError(f"tableau {self.name}: row i of a must have i entries, one row per stage")
        embedded = [(order, tuple(x - y for x, y in zip(self.b, e, strict=True))) for order, e in self.errors]
        for order, weights in ((self.order, self.b), *embedded):
            for condition, defect in defects(self.a, weights, order, math.fsum if self.rounding else sum):
                if abs(defect) > self.rounding:
                    raise ValueError(f"tableau {self.name}: {condition}")


def floats(weights: tuple) -> tuple[float, ...]:
    """Coefficients as doubles."""
    return tuple(map(float, weights))


CLASSICAL_RK4 = Tableau(
    name="classical RK4",
    order=4,
    a=((), (F(1, 2),), (F(0), F(1, 2)), (F(0), F(0), F(1))),
    b=(F(1, 6), F(1, 3), F(1, 3), F(1, 6)),
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
    errors=((4, (F(71, 57600), F(0), F(-71, 16695), F(71, 1920), F(-17253, 339200), F(22, 525), F(-1, 40))),),
)

# Digits of a double: every row rounds by some 1e-16.
DORMAND_PRINCE_853 = Tableau(
    name="Dormand-Prince 8(5, 3)",
    order=8,
    a=dop853.A,
    b=dop853.B,
    errors=((5, dop853.FIFTH), (3, dop853.THIRD)),
    rounding=1e-13,
)
