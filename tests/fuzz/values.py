"""Values that users give by mistake, or to see what happens; and sensible ones, by the name of the argument."""

import decimal
import fractions
import math
import warnings

import numpy as np
import pandas as pd

import explorer as ex

from . import hostile

SIZES = (
    0.0,
    -0.0,
    5e-324,
    1e-310,
    1e-300,
    1e-150,
    1e-20,
    1e-9,
    1e-3,
    0.5,
    1.0,
    1.5707963,
    3.0,
    1e3,
    1e9,
    1e100,
    1e155,
)
EDGES = (*SIZES, 1e200, 1e308, math.inf, math.nan, 0.5 * math.pi, math.pi)
TEXTS = (
    "",
    " ",
    "x",
    "1",
    "²",
    "１",
    "1_000",
    "nan",
    "inf",
    "1e400",
    "9" * 5000,
    "\0",
    "a\nb",
    "../up",
    "x" * 5000,
    "-1:2",
    ":",
)


def size(random):
    """A number of any size, as often sensible as not."""
    if random.random() < 0.5:
        return random.choice((0.1, 0.3, 0.7, 1.0, 1.3)) * random.choice((1.0, -1.0))
    return random.choice(EDGES) * random.choice((1.0, -1.0))


def column(random):
    """Numbers of any size in an array of some shape."""
    shape = random.choice(((), (), (), (1,), (3,), (2, 1), (1, 3)))
    values = np.array([size(random) for _ in range(math.prod(shape))]).reshape(shape)
    return float(values) if shape == () and random.random() < 0.7 else values


NASTY = (
    lambda r: None,
    lambda r: r.choice((True, False, np.True_)),
    lambda r: r.choice(TEXTS),
    lambda r: r.choice(TEXTS).encode(),
    lambda r: r.choice((1j, complex(math.nan, 1.0), np.complex64(1.0))),
    lambda r: np.array([1.0 + 1.0j, 2.0]),
    lambda r: 10 ** r.choice((17, 30, 309, 400, 6000)) * r.choice((1, -1)),
    lambda r: size(r),
    lambda r: np.float32(r.choice((0.3, 1e-40, 1e38, math.inf))),
    lambda r: np.longdouble("1e4000"),
    lambda r: np.array([1.0, 1e-19], np.longdouble) + np.longdouble(1.0),
    lambda r: np.array([size(r), 0.3], ">f8"),
    lambda r: np.array([0.3, 0.4], np.float16),
    lambda r: np.array([1, 2, 3], np.uint64),
    lambda r: np.array([], dtype=float),
    lambda r: np.empty((0, 3)),
    lambda r: np.array(size(r)),
    lambda r: np.full((2, 3, 2), 0.3),
    lambda r: np.full(7, 0.2),
    lambda r: np.array([0.1, None], object),
    lambda r: np.array([0.1, pd.NA, "x"], object),
    lambda r: np.array(["0.1", "b"]),
    lambda r: np.array(["2026-01-01"], "M8[ns]"),
    lambda r: np.timedelta64(5, "ns"),
    lambda r: pd.Timestamp("2026-01-01"),
    lambda r: np.ma.array([0.1, 0.2, math.nan], mask=[0, 1, 0]),
    lambda r: np.ma.masked,
    lambda r: np.ma.array(0.3, mask=True),
    lambda r: pd.Series([0.1, None, 0.3]),
    lambda r: pd.Series([1, None], dtype="Int64"),
    lambda r: pd.Series(["a", "b"]),
    lambda r: pd.Series([0.1, 0.2], index=[5, 5]),
    lambda r: pd.DataFrame({"phi": [0.1], "phidot": [0.2]}),
    lambda r: pd.Categorical(["a", "b"]),
    lambda r: pd.NA,
    lambda r: [],
    lambda r: [0.1, [0.2, 0.3]],
    lambda r: [0.1, 10**400],
    lambda r: (size(r), size(r)),
    lambda r: {"phi": 0.1},
    lambda r: {0.1, 0.2},
    lambda r: range(3),
    lambda r: (x for x in (0.1, 0.2)),
    lambda r: memoryview(b"abcdefgh"),
    lambda r: decimal.Decimal(r.choice(("0.1", "1e400", "NaN", "Infinity"))),
    lambda r: fractions.Fraction(1, 3),
    lambda r: fractions.Fraction(10**400, 3),
    lambda r: np.matrix([[0.1, 0.2]]),
    lambda r: np.zeros(2, [("phi", float), ("phidot", float)]),
    lambda r: np.broadcast_to(0.1, (200_000, 1)) if r.random() < 0.1 else np.zeros((1, 0)),
    *(hostile.any_of,) * 6,
    lambda r: object(),
    lambda r: np.random.default_rng(0),
    lambda r: lambda *given, **named: None,
    lambda r: ex.Disk,
    lambda r: r.choice((np, np.float64, np.ndarray, int)),
    lambda r: r.choice((2**31, 2**63, 2**64)),
    lambda r: ex.Disk.uniform(),
    lambda r: states(r),
    lambda r: "hoop",
)

DISKS = (
    ex.Disk.uniform(),
    ex.Disk.uniform(),
    ex.Disk.hoop(),
    ex.Disk.matching(),
    ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81),
    ex.Disk(I1=0.5, I3=0.3, name="thick"),
    ex.Disk(I1=0.3, I3=0.0, name="needle"),
    ex.Disk(I1=1e-6, I3=2e-6, name="core"),
    ex.Disk(I1=1e6, I3=1e6, name="rim"),
    ex.Disk(I1=0.25, I3=1e-9, name="rod"),
)


def states(random):
    """States that are often sensible, sometimes at the ends of what doubles hold, sometimes none."""
    disk = random.choice(DISKS)
    if random.random() < 0.3 and disk.I3 > 0.0:
        return ex.constants_to_states(disk, column(random), random.choice((1e-3, -1e-9, 1e-200, 0.0, 0.3)), 0.7)
    return ex.phi_to_states(disk, 0.3 * size(random), column(random), size(random), size(random))


def state(random):
    """One state on F, or near it."""
    return ex.constants_to_states(
        random.choice(DISKS[:4]), size(random), random.choice((0.0, 1e-9)), abs(size(random))
    )


# Sensible values by the name of the argument; others are columns.
SENSIBLE = {
    "disk": lambda r: r.choice(DISKS),
    "states": states,
    "state": state,
    "state_on_f": state,
    "side": lambda r: r.choice((1, -1)),
    "face": lambda r: r.choice((1, -1, 1.0, [1, -1, 1])),
    "jobs": lambda r: r.choice((1, 2)),
    "count": lambda r: r.choice((1, 2, 5)),
    "batch": lambda r: r.choice((1, 4096)),
    "accuracy": lambda r: r.choice((1e-6, 1e-3, 1e-9)),
    "method": lambda r: r.choice(("auto", "quadrature", "dopri5", "dop853", "rk8", "rk4")),
    "window": lambda r: r.choice((None, 0.5)),
    "degrees": lambda r: r.random() < 0.5,
    "t_end": lambda r: r.choice((0.5, 2.0, None)),
    "t_eval": lambda r: r.choice((None, [0.5, 1.0])),
    "observables": lambda r: r.choice((("phi",), ("phi", "chi", "contact"), ["sigma3"])),
    "chi0": size,
    "max_steps": lambda r: r.choice((10, 100_000)),
    "observable": lambda r: r.choice(("theta_min", "energy", "race_angle", len, int, lambda batch: batch.phi)),
    "steps": lambda r: r.choice((1, 20)),
    "step": lambda r: r.choice((0.05, 1.0)),
    "time": lambda r: r.choice((0.3, 1.0)),
    "samples": lambda r: r.choice((60, 200)),
    "seed": lambda r: r.choice((0, 7)),
    "rng": lambda r: r.choice((0, 7)),
    "row": lambda r: 0,
    "box": lambda r: r.choice((None, "phi=-0.3:0.3", "phi=0.2,sigma3=0.3")),
    "gaussian": lambda r: r.choice((None, "phidot=0.5:0.3")),
    "density": lambda r: r.choice((None, lambda a, b, c, d: 1.0 + 0.0 * a)),
    "energy": lambda r: r.choice((None, (None, 3.0), 3.0)),
    "points": lambda r: r.choice((3, 5)),
    "width": lambda r: 0.1,
    "disks": lambda r: [r.choice(DISKS)],
    "eta_hat": lambda r: r.choice((column(r), [0.1, -0.01])),
    "path": lambda r: r.choice(("line", "spinning", "rolling")),
    "parameter": lambda r: [0.1, 0.2],
    "places": lambda r: r.choice((None, [(0.2, 2.0)])),
    "halves": lambda r: [0.1, 1e-6],
    "frames": lambda r: r.choice((2, 10)),
    "bounces": lambda r: r.choice((1, 2)),
    "cells": lambda r: r.choice((2, 10)),
    "turns": lambda r: r.choice((1, 2)),
    "between": lambda r: (0.1, 0.3),
    "excess": lambda r: r.choice((None, [1.1, 20.0])),
}


def sensible(name, random):
    """A sensible value for an argument of this name."""
    return SENSIBLE.get(name, column)(random)


def nasty(random):
    """Any of the values above."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # numpy warns where some of them are made
        return random.choice(NASTY)(random)
