"""What a run was computed on: what may change the last digits of its numbers, and what is only of interest."""

import os
import platform
import sys
from importlib import import_module
from typing import Any

from explorer import compiled


def machine() -> dict[str, Any]:
    """The entry of run.json."""
    return {
        "system": platform.system(),
        "processor": platform.machine(),
        "compiled_for": compiled.target()[0],
        "arithmetic": arithmetic(),
        "cores": os.cpu_count(),
        "byteorder": sys.byteorder,
    }


def arithmetic() -> str:
    """What decides the last digits beside the source: where this text is the same, so is the digest of a run.

    Compiled code may round a product and a sum together where the processor can; numpy and the C library choose
    their exponentials and powers by the instructions that they find.
    """
    fused = "fused" if compiled.target()[1] else "not fused"
    libc = " ".join(platform.libc_ver()).strip() or platform.system()
    return f"{platform.machine()}, products {fused}, numpy {_instructions_of_numpy()}, {libc}"


def _instructions_of_numpy() -> str:
    """The newest set of instructions that numpy has code of its own for and found; else its least one."""
    try:
        core = import_module("numpy._core._multiarray_umath")
        found = [name for name in core.__cpu_dispatch__ if core.__cpu_features__.get(name)]
        return str((found or core.__cpu_baseline__)[-1])
    except (ImportError, AttributeError, IndexError):
        return "unknown"
