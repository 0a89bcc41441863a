"""The bridge to the kernels: what is compiled, and when."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


SMALL = ("counting.histogram_batch", "falling.critical_X2_batch")
MISSING = f"""
import sys
from explorer import compiled
print(compiled.warmup({SMALL}, print), "kernels.disk.counting" in sys.modules)
print(compiled.warmup({SMALL}, print))
"""


def test_what_is_asked_for_is_compiled_once_and_said_in_one_line(tmp_path):
    """What the cache has is not even imported to find that out."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", MISSING]
    first, again = (
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    names = ["histogram_batch", "critical_X2_batch"]
    assert first == "compiling 2 kernel(s); once for this version, then kept\n2 True\n0\n"
    assert again == "0 False\n0\n"
    found = {path.name.split(".")[1].rpartition("-")[0] for path in tmp_path.rglob("*.nbi")}
    assert found == set(names)  # nothing else is compiled
