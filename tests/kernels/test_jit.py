"""The compiler's cache: never stale, never in the way."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

ASK = """
import numpy as np
from kernels.disk import algebra, chaplygin
from kernels.disk.body import make_body
body, series = make_body(0.25, 0.5)
out = np.empty((6, 1))
# So small a q goes to constants_of, which calls energy() in another file.
state = np.array([[1e-308], [1.0], [-1.0], [1.0], [0.5]])
algebra.constants_batch(state, chaplygin.make_whole(series), body, series, out)
print(repr(float(out[3, 0])), algebra.constants_batch.is_cached())
"""


def run(code, folder, **environment):
    done = subprocess.run(
        [sys.executable, "-W", "always", "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture
def copy(tmp_path):
    """A copy of the package that a test may edit."""
    shutil.copytree(ROOT / "kernels", tmp_path / "kernels", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_editing_a_called_function_in_another_file_gives_the_new_answer(copy, tmp_path):
    """The caller's file is untouched, so numba alone would serve the old code (numba #1833)."""
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    first = run(ASK, copy, **cache).stdout.split()
    again = run(ASK, copy, **cache).stdout.split()
    assert first == again == ["0.9375", "True"]
    field = copy / "kernels" / "disk" / "field.py"
    text = field.read_text()
    assert "0.5 * b.J * x.sigma4" in text
    field.write_text(text.replace("0.5 * b.J * x.sigma4", "1.5 * b.J * x.sigma4"))
    edited = run(ASK, copy, **cache).stdout.split()
    assert edited == ["1.3125", "True"]


def test_the_second_process_loads_and_does_not_compile(copy, tmp_path):
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    run(ASK, copy, **cache)
    stamps = {path: path.stat().st_mtime_ns for path in (tmp_path / "cache").rglob("*.nb[ic]")}
    assert stamps
    run(ASK, copy, **cache)
    assert stamps == {path: path.stat().st_mtime_ns for path in (tmp_path / "cache").rglob("*.nb[ic]")}


def test_without_a_writable_cache_folder_it_works_with_one_warning(copy, tmp_path):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where the folder should be")
    done = run(ASK, copy, NUMBA_CACHE_DIR=str(blocked))
    assert done.stdout.split() == ["0.9375", "False"]
    assert done.stderr.count("no cache for compiled code") == 1


def test_a_corrupted_cache_is_replaced_or_ignored(copy, tmp_path):
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    run(ASK, copy, **cache)
    for path in (tmp_path / "cache").rglob("*.nb[ic]"):
        path.write_bytes(b"\x00garbage" * 10)
    assert run(ASK, copy, **cache).stdout.split()[0] == "0.9375"


PLAIN = """
import sys, numpy as np, numba
from kernels.disk import field
from kernels.steps import attempt as steps, batch, events
from kernels.disk.body import make_body
body, series = make_body(0.25, 0.5)
states = np.zeros((8, 3))
states[0], states[2], states[3], states[4] = 1.0, [-1.0, 0.4, -0.2], [1.0, 0.3, -0.7], [0.6, -0.2, 0.9]
out, constants_error, steps_ = np.empty((8, 3)), np.empty((3, 3)), np.empty(3, np.int32)
for method, control in ((steps.RK4, 0.1), (steps.DOPRI5, 1e-5)):
    status = np.zeros(3, np.int8)
    batch.first_event_batch(method, field.ANGLES, states, np.full(3, control), events.TURNING_POINT, 0.0,
                            5000, 1e-2, body, series, out, status, steps_, constants_error)
    print([x.hex() for x in out.ravel()], status.tolist(), steps_.tolist())
"""


def test_interpreted_kernels_agree_with_compiled_ones():
    """Also shows that nothing depends on how the compiler treats the code."""
    compiled = run(PLAIN, ROOT).stdout
    plain = run(PLAIN, ROOT, NUMBA_DISABLE_JIT="1").stdout
    assert compiled == plain
    assert compiled.count("[0, 0, 0]") == 2


def test_the_kernels_stay_inside_their_arrays(tmp_path):
    """Bounds checks on, with a cache of its own."""
    done = run(PLAIN, ROOT, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path))
    assert done.stdout == run(PLAIN, ROOT).stdout


def test_relaxed_arithmetic_differs_by_rounding_only_and_keeps_its_checks():
    strict = run(PLAIN, ROOT).stdout
    relaxed = run(PLAIN, ROOT, NEARFLAT_ARITHMETIC="relaxed").stdout
    assert relaxed != strict
    for line, other in zip(strict.splitlines(), relaxed.splitlines(), strict=True):
        numbers, others = (re.findall(r"-?0x[0-9a-fp.+-]+", text) for text in (line, other))
        assert len(numbers) == len(others) == 24
        for a, b in zip(numbers, others, strict=True):
            # Rounding shifts the adaptive steps a little; their own error is near 1e-5.
            assert float.fromhex(a) == pytest.approx(float.fromhex(b), rel=1e-9, abs=1e-11)
    spoilt = PLAIN.replace("[0.6, -0.2, 0.9]", "[0.6, np.nan, 0.9]")
    answers = run(spoilt, ROOT, NEARFLAT_ARITHMETIC="relaxed").stdout
    assert "[0, 5, 0]" in answers  # not finite
    assert "[0, 4, 0]" in answers  # step too small


def test_an_arithmetic_that_does_not_exist_is_named():
    done = subprocess.run(
        [sys.executable, "-c", "from kernels.steps import batch"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NEARFLAT_ARITHMETIC": "sloppy"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "NEARFLAT_ARITHMETIC = 'sloppy'" in done.stderr
