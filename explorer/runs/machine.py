"""What a run was computed on: what may change the last digits of its numbers, and what is only of interest."""

import platform
import sys
from typing import Any

import numpy as np

from explorer import compiled


def machine() -> dict[str, Any]:
    """The entry of run.json."""
    return {
        "system": platform.system(),
        "processor": platform.machine(),
        "compiled_for": compiled.target()[0],
        "arithmetic": arithmetic(),
        "cores": compiled.usable_cores(),
        "byteorder": sys.byteorder,
    }


def arithmetic() -> str:
    """What decides the last digits beside the source: where this text is the same, so is the digest of a run.

    Compiled code may round a product and a sum together where the processor can; numpy and the C library choose
    their exponentials and powers by the instructions that they find.
    """
    known = np.show_config(mode="dicts")["SIMD Extensions"]  # what numpy has code of its own for, and found
    numpy = [*known["baseline"], *known.get("found", ())][-1]  # which is left out where it is empty
    fused = "fused" if compiled.target()[1] else "not fused"
    libc = " ".join(platform.libc_ver()).strip() or platform.system()
    return f"{platform.machine()}, products {fused}, numpy {numpy}, {libc}"
