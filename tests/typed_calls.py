"""One run of mypy, over both packages and over calls through the door that are right or wrong."""

import os
import subprocess
import sys

from imports import ROOT

# Each call stands in a function of its own.
CALLS = {
    "a right call": "compiled.falling.critical_X2_batch(phi, disk.natural, out)",
    "a misspelt module": "compiled.faling.critical_X2_batch(phi, disk.natural, out)",
    "a misspelt kernel": "compiled.falling.critical_X3_batch(phi, disk.natural, out)",
    "an argument too few": "compiled.falling.critical_X2_batch(phi, disk.natural)",
    "an argument too many": "compiled.falling.critical_X2_batch(phi, disk.natural, out, out)",
    "a number for an array": "compiled.falling.critical_X2_batch(0.5, disk.natural, out)",
    "a matrix for a vector": "compiled.falling.critical_X2_batch(matrix, disk.natural, out)",
    "arguments exchanged": "compiled.falling.critical_X2_batch(phi, out, disk.natural)",
}
BOTH = "both packages"


def complaints(folder):
    """What mypy says about the packages, and about each call; folder: where the calls are written."""
    lines = ["import numpy as np", "from explorer import compiled", "from explorer.phase.disk import Disk"]
    starts = {}
    for number, (name, call) in enumerate(CALLS.items()):
        lines += [
            f"def f{number}(disk: Disk) -> None:",
            "    phi, matrix, out = np.empty(3), np.empty((4, 3)), np.empty(3)",
        ]
        starts[name] = len(lines) + 1
        lines.append(f"    {call}")
    (folder / "calls_of_kernels.py").write_text("\n".join(lines) + "\n")
    what = ["-p", "explorer", "-p", "kernels", "-m", "calls_of_kernels"]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-error-summary", *what],
        cwd=ROOT,
        env={**os.environ, "MYPYPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr  # wrong calls are there
    said = done.stdout.splitlines()
    found = {
        name: "\n".join(text for text in said if f"calls_of_kernels.py:{line}:" in text)
        for name, line in starts.items()
    }
    return {**found, BOTH: "\n".join(text for text in said if "calls_of_kernels.py:" not in text)}
