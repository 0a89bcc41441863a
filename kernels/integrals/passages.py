"""Passages and falls of many samples: by tables where they serve, by adaptive quadrature elsewhere."""

import math

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.falling import potential_at_flat
from kernels.integrals import nodes, tabulated
from kernels.integrals.quadrature import FLOOR, VERTICAL, fall, passage, point
from kernels.integrals.tables import Tables
from kernels.integrals.tabulated import CHECK, LANES
from kernels.status import Status
from kernels.types import Codes, Longs, Matrix, Table, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)


@subroutine
def by_tables(first, sigma3_bar, eta, speed, target, tables, b, out, status, W):
    """LANES samples from `first` on -> out and W; row CHECK is 0 where the answer stands."""
    for i in range(LANES):
        j = first + i
        usable = j < eta.size and status[j] == _OK
        W[tabulated.X * LANES + i] = sigma3_bar[j] / b.r0 if usable else 0.0
        W[tabulated.Y * LANES + i] = eta[j] / b.I1 if usable else 0.0
        W[tabulated.SPEED * LANES + i] = speed[j] if usable else 1.0
    tabulated.passages(W, target, FLOOR, tables, b)
    for i in range(min(LANES, eta.size - first)):
        if W[CHECK * LANES + i] != 0.0:
            continue
        j = first + i
        out[0, j] = 2.0 * math.asin(0.5 * W[tabulated.H_TURN * LANES + i])
        out[1, j] = W[tabulated.CHI * LANES + i]
        out[2, j] = W[tabulated.PSI * LANES + i]
        out[3, j] = W[tabulated.TIME * LANES + i]
        out[4, j] = W[tabulated.LEVEL * LANES + i] + potential_at_flat(W[tabulated.X * LANES + i], b)
        out[5, j] = W[tabulated.ANGLE_ERROR * LANES + i]
        out[6, j] = W[tabulated.TIME_ERROR * LANES + i]
        out[7, j] = W[tabulated.WAY * LANES + i]


@kernel
def passage_batch(
    sigma3_bar: Vector,
    eta: Vector,
    speed: Vector,
    h_end: float,
    target: float,
    rules: Table,
    sizes: Longs,
    tables: Tables,
    b: Body,
    series: Matrix,
    out: Matrix,
    status: Codes,
) -> None:
    """The passage on face +1 of every sample, with phidot = `speed` at the vertical, cut at h_end.

    out (8, n): theta_min, chi, psi, time, energy, error of angles, relative error of time, way. status
    (n): samples that come in as not OK are skipped; eta = 0 is FALLS; a motion that does not come as
    far as h_end is BAD_INPUT. rules, sizes: as for quadrature.passage.
    """
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    V = np.zeros(tabulated.ROWS * LANES)
    for i in range(LANES):
        V[CHECK * LANES + i] = 1.0
    for i in range(eta.size):
        if i % LANES == 0 and h_end == VERTICAL:
            by_tables(i, sigma3_bar, eta, speed, target, tables, b, out, status, V)
        if status[i] == _OK and eta[i] == 0.0:
            status[i] = _FALLS
        if status[i] != _OK:
            out[:, i] = math.nan
        elif V[CHECK * LANES + i % LANES] != 0.0:
            X, Y = sigma3_bar[i] / b.r0, eta[i] / b.I1
            level = 0.5 * b.M * speed[i] * speed[i] + point(VERTICAL, X, Y, b, series).V
            rest = speed[i] == 0.0 and h_end == VERTICAL
            status[i], found = passage(h_end, rest, level, X, Y, target, rules, sizes, b, series, W)
            out[0, i] = 2.0 * math.asin(0.5 * found.h_turn)
            out[1, i], out[2, i], out[3, i] = found.chi, found.psi, found.time
            out[4, i] = level + potential_at_flat(X, b)
            out[5, i], out[6, i], out[7, i] = found.angle_error, found.time_error, found.way


@kernel
def fall_batch(
    sigma3_bar: Vector,
    energy: Vector,
    h_end: float,
    rules: Table,
    sizes: Longs,
    tables: Tables,
    b: Body,
    series: Matrix,
    out: Matrix,
) -> None:
    """The fall on F from h_end on face +1 of every sample: time, chi, psi, their error -> out (4, n).

    NaN where the energy does not exceed V_0. Time and chi are the same on face -1; psi changes sign.
    rules, sizes: as for quadrature.passage.
    """
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    V = np.zeros(tabulated.ROWS * LANES)
    for i in range(LANES):
        V[CHECK * LANES + i] = 1.0
    for i in range(energy.size):
        lane = i % LANES
        if lane == 0 and h_end == VERTICAL:
            for j in range(LANES):
                X = sigma3_bar[min(i + j, energy.size - 1)] / b.r0
                V[tabulated.X * LANES + j] = X
                V[tabulated.LEVEL * LANES + j] = energy[min(i + j, energy.size - 1)] - potential_at_flat(X, b)
            tabulated.falls(V, FLOOR, FLOOR, tables, b)
        X = sigma3_bar[i] / b.r0
        level = energy[i] - potential_at_flat(X, b)
        if V[CHECK * LANES + lane] == 0.0:
            out[0, i] = 0.5 * V[tabulated.TIME * LANES + lane]
            out[1, i] = 0.5 * V[tabulated.CHI * LANES + lane]
            out[2, i] = 0.5 * V[tabulated.PSI * LANES + lane]
            out[3, i] = 0.5 * V[tabulated.ANGLE_ERROR * LANES + lane]
            out[3, i] = max(out[3, i], V[tabulated.TIME_ERROR * LANES + lane] * out[0, i])
        elif level > 0.0:
            out[0, i], out[1, i], out[2, i], out[3, i] = fall(h_end, level, X, rules, sizes, b, series, W)
        else:
            out[:, i] = math.nan
