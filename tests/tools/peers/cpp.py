"""The loop in C++ (fixed_steps.cpp), compiled for this machine and called through ctypes.

The honest peer for fixed steps: the same tableaux and the same field as ours, in lanes, and nothing else. It
locates no event, holds no constant and reports no error; it is told where each motion ends.
"""

import ctypes
import os
import platform
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from tools.peers.problem import DISK, work

from kernels.steps.tableaux import CLASSICAL_RK4, DORMAND_PRINCE_853

SOURCE = Path(__file__).with_name("fixed_steps.cpp")
TABLEAUX = {"rk4": CLASSICAL_RK4, "rk8": DORMAND_PRINCE_853}
LANES = 16  # as many as ours
NO_COMPILER = "no C++ compiler was found, so there are no rows of a loop in C++"


def compiler():
    """The command of a C++ compiler, or None."""
    return next(filter(None, map(shutil.which, (os.environ.get("CXX", "g++"), "g++", "clang++"))), None)


def tableaux():
    """The header with the coefficients, to the last bit."""
    return "\n".join(_struct(name.upper(), tableau) for name, tableau in TABLEAUX.items())


def _struct(name, tableau):
    stages = len(tableau.b)
    rows = [_braces([*row, *(0.0,) * (stages - len(row))]) for row in tableau.a]
    return (
        f"struct {name} {{\n    static constexpr int STAGES = {stages};\n"
        f"    static constexpr double A[{stages}][{stages}] = {{{', '.join(rows)}}};\n"
        f"    static constexpr double B[{stages}] = {_braces(tableau.b)};\n}};\n"
    )


def _braces(numbers):
    return "{" + ", ".join(float(number).hex() for number in numbers) + "}"


def options(contracted):
    """What the compiler is told: strict arithmetic as ours, or products and sums rounded together."""
    machine = os.environ.get("NUMBA_CPU_NAME", "native")  # the processor that our kernels are compiled for
    vectors = ["-mprefer-vector-width=512"] if platform.machine() in ("x86_64", "AMD64") else []
    contract = f"-ffp-contract={'fast' if contracted else 'off'}"
    return ["-std=c++17", "-O3", f"-march={machine}", *vectors, contract, f"-DLANES={LANES}"]


@cache
def library(contracted):
    """The compiled loop."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "tableaux.h").write_text(tableaux(), encoding="utf-8")
        made = Path(folder, "fixed_steps.so")
        files = [f"-I{folder}", str(SOURCE), "-o", str(made)]
        command = [compiler(), *options(contracted), "-fPIC", "-shared", *files]
        subprocess.run(command, check=True, capture_output=True, text=True)
        return ctypes.CDLL(str(made))


def follow(name, contracted, states, s_end, longest):
    """Follow motions, columns of states (8, n), to their s_end (n) in equal steps; returns how many were made.

    `longest` bounds the steps; those of a group of lanes are as many as its longest way needs.
    """
    n = s_end.size
    if n % LANES or states.shape != (8, n) or not (states.flags.c_contiguous and s_end.flags.c_contiguous):
        raise ValueError(f"states (8, n) and s_end (n) must be contiguous, with n a multiple of {LANES}")
    b = DISK.body
    body = np.array([b.inv_kappa2, b.J_over_M, b.inv_M, b.k, b.inv_J])
    call = library(contracted)[f"follow_{name}"]
    call.restype = ctypes.c_long
    pointers = (ctypes.c_void_p(array.ctypes.data) for array in (states, s_end))
    made = call(ctypes.c_long(n), *pointers, ctypes.c_double(longest), ctypes.c_void_p(body.ctypes.data))
    return int(made)


def loop(name, contracted):
    """chi at t = 1.6, which each motion meets at the s_end that it is told; the setting is the longest step."""
    starts, s_end = np.zeros((8, work().s_end.size)), work().s_end
    starts[:5] = work().regular[:5]

    def make(longest):
        def solve(_n):
            states = starts.copy()
            follow(name, contracted, states, s_end, longest)
            return states[6]

        return solve

    return make
