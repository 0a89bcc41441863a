"""Many states of a box in one pass: drawn, judged and counted in lanes; only those near F leave it.

A state is judged on the face whose line is nearer. What lanes cannot tell for rounding is told for one state at a
time, by what judges single states.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel, subroutine
from kernels.disk import philox
from kernels.disk.algebra import LANES, depth
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import Solutions, Whole, whole_solutions
from kernels.disk.constants import from_solutions, nearer_plus
from kernels.disk.elementary import SMALLEST, cosine, logarithm, sine
from kernels.disk.falling import (
    FALLS_BACK,
    PASSES,
    UNDECIDED,
    Obstacle,
    contracted_potential_above_flat,
    contracted_rates_on_f,
    passes_barrier,
    reaches_flat,
    tilt,
)
from kernels.disk.field import contracted_energy, reduced_state
from kernels.types import Counts, Longs, Matrix, Vector, Words

# Rows of the work array: coordinates, the state, the solutions at its tilt, and what is found.
_COORDINATES = 4
_PHI, _PHIDOT, _SIGMA3, _SPIN = range(_COORDINATES)
_Q, _Z, _P, _RHO, _SIGMA4 = range(4, 9)
_SOLUTIONS, _U_NEAR, _U_FAR = 9, 14, 15
_X, _ENERGY, _FACE, _ETA, _DISTANCE, _PLACE, _VERDICT = range(16, 23)
_SMALLEST_ONE, _LARGEST_ONE = 23, 24
_ROWS = 25
# Relative to their sum: an energy and a potential nearer than this are compared one state at a time.
_TIE = 1e-12
# Of a bin: a distance this near to its edge is placed by the library's logarithm.
_EDGE = 1e-8
_HALF_PI = 0.5 * math.pi
_BEYOND = 3  # a verdict that awaits the barrier's


class Draw(NamedTuple):
    """Where states come from: the streams of a chunk, and the box, four rows each, in the units of the disk.

    keys: of all streams, one after the other. stream: how many states each of them gives, in whole blocks. block:
    states for which each free coordinate is drawn before the next one is. unit: sqrt(g/r).
    """

    keys: Words
    stream: int
    low: Vector
    width: Vector
    block: int
    unit: float


class Sieve(NamedTuple):
    """What is kept and how it is counted.

    near: states that could fall are kept up to this distance, |eta| over `eta_unit`. Entry `lowest` + k of the
    bins counts distances with k <= per_decade log10 distance < k + 1; no double lies in the first LANES of them.
    """

    obstacle: Obstacle
    eta_unit: float
    near: float
    per_decade: float
    lowest: int


class Found(NamedTuple):
    """What becomes of the states of a chunk; counts are added to what is there.

    faces (6): all states by nearer face, -1 before +1, and by eta < 0, = 0 and > 0. bins, ends (2): distances of
    those that could fall, the smallest and the largest. totals (3): how many could, how many of them have distance
    0, how many are kept. columns (4, n): coordinates of those, in their order.
    """

    faces: Longs
    bins: Counts
    ends: Vector
    totals: Longs
    columns: Matrix


@subroutine
def coordinates(numbers: Vector, first: int, draw: Draw, W: Vector) -> None:
    """Rows of coordinates; numbers `first` ... of each row of random numbers are theirs."""
    row = 0
    for c in range(_COORDINATES):
        # Slices: indices that may count from the end, for all the compiler knows, are gathered one by one.
        low, width, values = draw.low[c], draw.width[c], W[c * LANES : (c + 1) * LANES]
        if width > 0.0:
            place = row * philox.WORDS + first
            shares = numbers[place : place + LANES]
            for i in range(LANES):
                values[i] = low + width * shares[i]
            row += 1
        else:
            values[:] = low


@contracted_subroutine
def tilts(W: Vector) -> None:
    """Rows _Q and _Z from _PHI; NaN where it is flat, so that nothing else is found of it."""
    for i in range(LANES):
        phi = W[_PHI * LANES + i]
        inside = abs(phi) < _HALF_PI
        W[_Q * LANES + i] = cosine(phi) if inside else math.nan
        W[_Z * LANES + i] = sine(phi) if inside else math.nan


@subroutine
def states(unit: float, W: Vector) -> None:
    """Rows of the state in natural units, from its coordinates and _Q."""
    for i in range(LANES):
        W[_P * LANES + i] = -W[_PHIDOT * LANES + i] / unit
        W[_RHO * LANES + i] = W[_SIGMA3 * LANES + i] / (W[_Q * LANES + i] * unit)
        W[_SIGMA4 * LANES + i] = W[_SPIN * LANES + i] / unit


@contracted_device
def part_of_spin(q: float, z: float, f: Solutions, b: Body) -> float:
    """U of V = X^2 U + q on F, where f are the solutions."""
    turn, sigma4 = contracted_rates_on_f(1.0, q, z, f, b)
    V, _spin = contracted_potential_above_flat(0.5 * b.I1 * (turn * q) * (turn * q), sigma4, 0.0, 0.0, b)
    return V


@contracted_subroutine
def at_tilts(W: Vector, whole: Whole, b: Body) -> None:
    """What depends on the tilt alone: the solutions, and U on either hemisphere."""
    for i in range(LANES):
        q, z = W[_Q * LANES + i], W[_Z * LANES + i]
        S, log_S = depth(q, z, logarithm(q))
        f = whole_solutions(S, log_S, b.c, whole)
        W[_SOLUTIONS * LANES + i] = f.rho
        W[(_SOLUTIONS + 1) * LANES + i] = f.drho
        W[(_SOLUTIONS + 2) * LANES + i] = f.rho_over_S
        W[(_SOLUTIONS + 3) * LANES + i] = f.D
        W[(_SOLUTIONS + 4) * LANES + i] = f.dD
        W[_U_NEAR * LANES + i] = part_of_spin(q, abs(z), f, b)
        # -0.0 counts as the near hemisphere.
        W[_U_FAR * LANES + i] = part_of_spin(q, -abs(z), f, b)


@contracted_subroutine
def judge(sieve: Sieve, W: Vector, b: Body) -> None:
    """Constants of motion, distance and verdict on the face whose line is nearer."""
    for i in range(LANES):
        x = reduced_state(
            W[_Q * LANES + i], W[_Z * LANES + i], W[_P * LANES + i], W[_RHO * LANES + i], W[_SIGMA4 * LANES + i]
        )
        f = Solutions(
            W[_SOLUTIONS * LANES + i],
            W[(_SOLUTIONS + 1) * LANES + i],
            W[(_SOLUTIONS + 2) * LANES + i],
            W[(_SOLUTIONS + 3) * LANES + i],
            W[(_SOLUTIONS + 4) * LANES + i],
        )
        constants = from_solutions(x, f, contracted_energy(x, b), b)
        plus = nearer_plus(constants.eta_plus, constants.eta_minus)
        X = constants.sigma3_bar / b.r0
        eta = constants.eta_plus if plus else constants.eta_minus
        z = x.z if plus else -x.z
        U_near, U_far = W[_U_NEAR * LANES + i], W[_U_FAR * LANES + i]
        U = U_near if z >= 0.0 else U_far
        V0, _spin = contracted_potential_above_flat(0.0, X / b.k, 0.0, 0.0, b)
        E, V = constants.energy, X * X * U + x.q
        # How far above both, in units of what rounding leaves open.
        above = min((E - V0) / (E + V0), (E - V) / (E + V))
        W[_X * LANES + i] = X
        W[_ENERGY * LANES + i] = E
        W[_FACE * LANES + i] = 1.0 if plus else -1.0
        W[_ETA * LANES + i] = eta
        verdict = PASSES if z >= 0.0 else _BEYOND
        W[_VERDICT * LANES + i] = verdict if above > _TIE else UNDECIDED if above > -_TIE else FALLS_BACK


@contracted_subroutine
def barriers(o: Obstacle, W: Vector) -> None:
    """Verdicts on starts beyond the vertical that have the energy for flat."""
    for i in range(LANES):
        z = W[_FACE * LANES + i] * W[_Z * LANES + i]
        passes = passes_barrier(z, W[_ENERGY * LANES + i], W[_X * LANES + i], o)
        verdict = W[_VERDICT * LANES + i]
        W[_VERDICT * LANES + i] = passes if verdict == _BEYOND else verdict


@contracted_subroutine
def places(sieve: Sieve, unit: float, W: Vector) -> None:
    """Distances, and where their logarithms lie among the bins."""
    scale = sieve.per_decade / math.log(10.0)
    for i in range(LANES):
        distance = abs(W[_ETA * LANES + i]) / sieve.eta_unit * unit
        W[_DISTANCE * LANES + i], W[_PLACE * LANES + i] = distance, scale * logarithm(distance) + sieve.lowest


@contracted_subroutine
def odd_ones(sieve: Sieve, W: Vector) -> bool:
    """Whether any lane needs to be looked at by itself: its verdict, its bin, or because it is kept."""
    odd = 0
    for i in range(LANES):
        place, verdict, distance = W[_PLACE * LANES + i], W[_VERDICT * LANES + i], W[_DISTANCE * LANES + i]
        inside = place - np.floor(place)
        edge = not (_EDGE < inside < 1.0 - _EDGE and distance > SMALLEST)
        odd += 1 if verdict != FALLS_BACK and (edge or verdict == UNDECIDED or distance <= sieve.near) else 0
    return odd > 0


@subroutine
def look(sieve: Sieve, W: Vector, disk: Disk, found: Found) -> None:
    """Lanes that need it, one at a time."""
    for i in range(LANES):
        verdict = W[_VERDICT * LANES + i]
        if verdict == UNDECIDED:
            z = W[_FACE * LANES + i] * W[_Z * LANES + i]
            at, X = tilt(W[_Q * LANES + i], z, disk), W[_X * LANES + i]
            falls = reaches_flat(at, W[_ENERGY * LANES + i], X, sieve.obstacle, disk)
            verdict = W[_VERDICT * LANES + i] = PASSES if falls else FALLS_BACK
        if verdict != PASSES:
            continue
        distance, place = W[_DISTANCE * LANES + i], W[_PLACE * LANES + i]
        if distance <= 0.0:
            found.totals[1] += 1
            W[_PLACE * LANES + i] = 0.0
        elif not (_EDGE < place - math.floor(place) < 1.0 - _EDGE and distance > SMALLEST):
            W[_PLACE * LANES + i] = math.floor(sieve.per_decade * math.log10(distance)) + sieve.lowest
        if distance <= sieve.near:
            kept = found.totals[2]
            for c in range(_COORDINATES):
                found.columns[c, kept] = W[c * LANES + i]
            found.totals[2] += 1


@subroutine
def count_lanes(W: Vector, found: Found) -> None:
    """Faces, verdicts and distances."""
    could = above = below = zero = above_plus = below_plus = zero_plus = 0
    for i in range(LANES):
        eta, plus = W[_ETA * LANES + i], W[_FACE * LANES + i] > 0.0
        above += 1 if eta > 0.0 else 0
        below += 1 if eta < 0.0 else 0
        zero += 1 if eta == 0.0 else 0
        above_plus += 1 if plus and eta > 0.0 else 0
        below_plus += 1 if plus and eta < 0.0 else 0
        zero_plus += 1 if plus and eta == 0.0 else 0
        could += 1 if W[_VERDICT * LANES + i] == PASSES else 0
    found.faces[0] += below - below_plus
    found.faces[1] += zero - zero_plus
    found.faces[2] += above - above_plus
    found.faces[3] += below_plus
    found.faces[4] += zero_plus
    found.faces[5] += above_plus
    found.totals[0] += could


@subroutine
def count_distances(W: Vector, bins: Counts) -> None:
    """Distances of those that could fall; their ends in rows of their own, so that lanes need not be compared."""
    for i in range(LANES):
        distance, place = W[_DISTANCE * LANES + i], W[_PLACE * LANES + i]
        smallest, largest = W[_SMALLEST_ONE * LANES + i], W[_LARGEST_ONE * LANES + i]
        passes = W[_VERDICT * LANES + i] == PASSES
        W[_SMALLEST_ONE * LANES + i] = distance if passes and distance < smallest else smallest
        W[_LARGEST_ONE * LANES + i] = distance if passes and distance > largest else largest
        # What is not counted goes to bins of its own, one for each lane: one count would wait for the other.
        W[_PLACE * LANES + i] = place if passes and place >= LANES else float(i)
    for i in range(LANES):
        bins[int(W[_PLACE * LANES + i])] += 1


@subroutine
def draw_block(place: int, size: int, keys: Words, draw: Draw, words: Words, numbers: Vector) -> None:
    """Random numbers of GROUPS groups of lanes, a row for each free coordinate; `place`: of the first one."""
    row = 0
    for c in range(_COORDINATES):
        if draw.width[c] > 0.0:
            first = row * philox.WORDS
            philox.uniforms(place + row * size, keys, words, numbers[first : first + philox.WORDS])
            row += 1


@kernel
def sift_batch(draw: Draw, count: int, sieve: Sieve, disk: Disk, whole: Whole, found: Found) -> None:
    """Draw `count` states, and count and sift them -> found."""
    W, words, numbers = np.zeros(_ROWS * LANES), np.empty(philox.WORDS, np.uint64), np.empty(4 * philox.WORDS)
    free, b = 0, disk.body
    for c in range(_COORDINATES):
        free += 1 if draw.width[c] > 0.0 else 0
    W[_SMALLEST_ONE * LANES : (_SMALLEST_ONE + 1) * LANES] = math.inf
    W[_LARGEST_ONE * LANES : (_LARGEST_ONE + 1) * LANES] = -math.inf
    fixed = not draw.width[_PHI] > 0.0
    if fixed:
        W[_Q * LANES : (_Q + 1) * LANES] = math.cos(draw.low[_PHI])
        W[_Z * LANES : (_Z + 1) * LANES] = math.sin(draw.low[_PHI])
        at_tilts(W, whole, b)
    for block in range(0, count, draw.block):
        size, place = min(draw.block, count - block), free * (block % draw.stream)
        keys = draw.keys[block // draw.stream * 2 * philox.ROUNDS :]
        for first in range(0, size, LANES):
            lane = first % philox.WORDS
            if lane == 0:
                draw_block(place + first, size, keys, draw, words, numbers)
            coordinates(numbers, lane, draw, W)
            if not fixed:
                tilts(W)
                at_tilts(W, whole, b)
            states(draw.unit, W)
            judge(sieve, W, b)
            if not (fixed and draw.low[_PHI] == 0.0):
                barriers(sieve.obstacle, W)
            places(sieve, draw.unit, W)
            for i in range(size - first, LANES):
                W[_ETA * LANES + i], W[_VERDICT * LANES + i] = math.nan, FALLS_BACK
            if odd_ones(sieve, W):
                look(sieve, W, disk, found)
            count_lanes(W, found)
            count_distances(W, found.bins)
    found.bins[:LANES] = 0
    # By hand: numba's own would load with the kernel all that numba can compile.
    for i in range(LANES):
        found.ends[0] = min(found.ends[0], W[_SMALLEST_ONE * LANES + i])
        found.ends[1] = max(found.ends[1], W[_LARGEST_ONE * LANES + i])
