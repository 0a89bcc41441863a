"""The door to the kernels keeps their types: what is wrong with a call is seen before it is made."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Each snippet is a function of its own; mypy reads all of them in one run, with what it knows of the package.
SNIPPETS = {
    "a right call": "compiled.falling.critical_X2_batch(phi, disk.natural, out)",
    "a misspelt module": "compiled.faling.critical_X2_batch(phi, disk.natural, out)",
    "a misspelt kernel": "compiled.falling.critical_X3_batch(phi, disk.natural, out)",
    "an argument too few": "compiled.falling.critical_X2_batch(phi, disk.natural)",
    "an argument too many": "compiled.falling.critical_X2_batch(phi, disk.natural, out, out)",
    "a number for an array": "compiled.falling.critical_X2_batch(0.5, disk.natural, out)",
    "a matrix for a vector": "compiled.falling.critical_X2_batch(matrix, disk.natural, out)",
    "arguments exchanged": "compiled.falling.critical_X2_batch(phi, out, disk.natural)",
}
MESSAGES = {
    "a right call": "",
    "a misspelt module": 'Module has no attribute "faling"',
    "a misspelt kernel": 'Module has no attribute "critical_X3_batch"',
    "an argument too few": 'Missing positional argument "out"',
    "an argument too many": "Too many arguments",
    "a number for an array": 'Argument 1 to "__call__" of "Kernel" has incompatible type "float"',
    "a matrix for a vector": 'Argument 1 to "__call__" of "Kernel" has incompatible type "ndarray[tuple[int, int]',
    "arguments exchanged": 'Argument 2 to "__call__" of "Kernel" has incompatible type "ndarray',
}


@pytest.fixture(scope="module")
def complaints(tmp_path_factory):
    """What mypy says about each snippet."""
    lines = ["import numpy as np", "from explorer import compiled", "from explorer.phase.disk import Disk"]
    starts = {}
    for number, (name, call) in enumerate(SNIPPETS.items()):
        lines += [
            f"def f{number}(disk: Disk) -> None:",
            "    phi, matrix, out = np.empty(3), np.empty((4, 3)), np.empty(3)",
        ]
        starts[name] = len(lines) + 1
        lines.append(f"    {call}")
    path = tmp_path_factory.mktemp("snippets") / "calls.py"
    path.write_text("\n".join(lines) + "\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-error-summary", "--config-file", "pyproject.toml", str(path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    said = done.stdout.splitlines()
    return {name: "\n".join(text for text in said if f"calls.py:{line}:" in text) for name, line in starts.items()}


@pytest.mark.parametrize("name", SNIPPETS)
def test_mypy_follows_a_call_through_the_door(complaints, name):
    assert MESSAGES[name] in complaints[name]
    assert bool(complaints[name]) == bool(MESSAGES[name])
