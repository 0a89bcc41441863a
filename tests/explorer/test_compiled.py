"""The bridge to the kernels: what is compiled, and whose compiled code is refused."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from explorer import compiled

ROOT = Path(__file__).parents[2]


SMALL = ("counting.sum_batch", "falling.critical_X2_batch")
WARM = f"""
from explorer import compiled
print(compiled.warmup({SMALL}, print))
"""


def test_what_is_asked_for_is_compiled_once_and_said_in_one_line(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", WARM]
    first, again = (
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    names = ["sum_batch", "critical_X2_batch"]
    assert first == f"compiling {', '.join(names)}; once for this version, then kept\n2\n"
    assert again == "0\n"
    found = {path.name.split(".")[1].rpartition("-")[0] for path in tmp_path.rglob("*.nbi")}
    assert found == set(names)  # nothing else is compiled


def test_what_the_cache_has_is_not_imported_to_find_that_out(tmp_path):
    code = (
        "import sys; from explorer import compiled\n"
        f"print(compiled.compile_missing({SMALL[:1]}), 'kernels.disk.counting' in sys.modules)"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", code]
    said = [
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    assert said == ["1 True\n", "0 False\n"]


def opened(folder):
    folder.chmod(0o777)


def linked(folder):
    folder.rmdir()
    folder.symlink_to(folder.parent)


@pytest.mark.skipif(os.name != "posix", reason="modes are those of POSIX")
@pytest.mark.parametrize(("change", "says"), [(opened, "can be written by other users"), (linked, "is a link")])
def test_a_cache_that_others_can_change_is_refused_before_a_kernel_is_there(change, says, tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    digest = compiled.source_digest()[:16]
    inside = tmp_path / f"nearflat-{digest}" / "disk_1"
    inside.mkdir(parents=True)
    change(inside)
    inside.parent.chmod(0o755)
    done = subprocess.run(
        [sys.executable, "-m", "explorer.commands.main", "warmup"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert f"compiled code is not loaded: {inside} {says}; remove" in done.stderr
