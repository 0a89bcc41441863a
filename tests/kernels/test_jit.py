"""The compiler's cache: never stale, never in the way."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# A package with the compiler of this one, and one kernel that calls a function in another file.
CALLED = """
from kernels._jit import subroutine

@subroutine
def twice(x: float) -> float:
    return 2.0 * x
"""
CALLER = """
import math
from kernels._jit import kernel
from kernels.called import twice
from kernels.types import Vector

@kernel
def sum_batch(values: Vector, out: Vector) -> None:
    for i in range(values.size):
        if math.isnan(values[i]):
            out[1] += 1.0
        else:
            out[0] += twice(values[i])
"""
ASK = """
import numpy as np
from kernels import caller
from kernels._jit import cached_names
out = np.zeros(2)
caller.sum_batch(np.array([0.5, np.nan, 1.0]), out)
print(*out, caller.sum_batch.name in cached_names())
"""


def run(code, folder, *arguments, **environment):
    done = subprocess.run(
        [sys.executable, "-W", "always", "-c", code, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


def small_package(folder, called=CALLED):
    """`kernels` of one kernel."""
    (folder / "kernels").mkdir(parents=True)
    for name in ("__init__.py", "_jit.py", "types.py"):
        shutil.copy(ROOT / "kernels" / name, folder / "kernels")
    (folder / "kernels" / "called.py").write_text(called)
    (folder / "kernels" / "caller.py").write_text(CALLER)
    return folder


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """The small package, and a cache that holds its kernel; what a first process said."""
    package, cache = small_package(tmp_path_factory.mktemp("package")), tmp_path_factory.mktemp("cache")
    assert run(ASK, package, NUMBA_CACHE_DIR=str(cache)).stdout.split() == ["3.0", "1.0", "True"]
    return package, cache


def compiled_files(cache):
    return {path: path.stat().st_mtime_ns for path in cache.rglob("*.nb[ic]")}


def test_editing_a_called_function_in_another_file_gives_the_new_answer(warm, tmp_path):
    """The caller's file is untouched, so numba alone would serve the old code (numba #1833)."""
    cache = shutil.copytree(warm[1], tmp_path / "cache")
    edited = small_package(tmp_path / "edited", CALLED.replace("2.0 * x", "6.0 * x"))
    assert run(ASK, edited, NUMBA_CACHE_DIR=str(cache)).stdout.split() == ["9.0", "1.0", "True"]


LATER = """
import numba
print(round(float(numba.njit(lambda a: a @ a + np.sin(a[0]))(np.ones(3))), 6))
"""


def test_the_second_process_loads_and_does_not_compile_and_what_its_user_compiles_is_right(warm):
    copy, cache = warm
    before = compiled_files(cache)
    assert before
    assert run(ASK + LATER, copy, NUMBA_CACHE_DIR=str(cache)).stdout.split() == ["3.0", "1.0", "True", "3.841471"]
    assert compiled_files(cache) == before


def test_without_a_writable_cache_folder_it_works_with_one_warning(warm, tmp_path):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where the folder should be")
    done = run(ASK, warm[0], NUMBA_CACHE_DIR=str(blocked))
    assert done.stdout.split() == ["3.0", "1.0", "False"]
    assert done.stderr.count("no cache for compiled code") == 1


USED = "from kernels._jit import cache_folder, cached_names\nprint(cache_folder(), cached_names())"


@pytest.mark.skipif(os.name != "posix", reason="modes and owners are those of POSIX")
def test_compiled_code_that_others_could_have_written_is_not_loaded(warm, tmp_path):
    """It is a pickle: whoever can write it runs as the one who loads it."""
    cache = tmp_path / "cache"
    shutil.copytree(warm[1], cache)
    (folder,) = cache.iterdir()
    assert {made.stat().st_mode & 0o777 for made in (warm[1], folder)} == {0o700}
    of_another = "import os\nmine = os.geteuid()\nos.geteuid = lambda: mine + 1\n" + USED
    refused = [run(of_another, warm[0], NUMBA_CACHE_DIR=str(cache))]
    folder.chmod(0o755)
    refused.append(run(USED, warm[0], NUMBA_CACHE_DIR=str(cache)))
    for done in refused:
        assert done.stdout.split() == ["None", "set()"]
        assert "not private to you" in done.stderr


FLIPPED = """
import sys, warnings
import numpy as np
from pathlib import Path
from kernels import caller
from kernels._jit import Kernel
(path,) = Path(sys.argv[1]).rglob("*.nbc")
for place in np.linspace(0.0, 1.0, 30):
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[int(place * (len(whole) - 1))] ^= 1 << int(7 * place)
    path.write_bytes(damaged)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        out = np.zeros(2)
        Kernel(caller.sum_batch.function)(np.array([0.5, np.nan, 1.0]), out)
    assert out.tolist() == [3.0, 1.0], (place, out)
    assert len(told) == 1, (place, told)
    (path,) = Path(sys.argv[1]).rglob("*.nbc")
print("right")
"""


def test_one_wrong_bit_of_compiled_code_changes_no_number(warm, tmp_path):
    """It would give other numbers with status ok, or end Python without a word; a checksum notices it."""
    copy, cache = warm[0], tmp_path / "cache"
    shutil.copytree(warm[1], cache)
    assert run(FLIPPED, copy, cache, NUMBA_CACHE_DIR=str(cache)).stdout == "right\n"


def test_a_second_copy_of_the_same_source_takes_what_the_first_has_compiled(warm, tmp_path):
    copy, before = small_package(tmp_path / "copy"), compiled_files(warm[1])
    assert run(ASK, copy, NUMBA_CACHE_DIR=str(warm[1])).stdout.split() == ["3.0", "1.0", "True"]
    assert compiled_files(warm[1]) == before


@pytest.mark.skipif(os.name != "posix", reason="elsewhere homes are not told by HOME")
def test_without_any_home_folder_it_works_with_one_warning(warm):
    """As in containers, for a user whom the system does not know."""
    unknown = "import os\nfrom pathlib import Path\n"
    unknown += "def no_home(): raise RuntimeError('Could not determine home directory.')\nPath.home = no_home\n"
    done = run(unknown + ASK, warm[0], NUMBA_CACHE_DIR="", XDG_CACHE_HOME="")
    assert done.stdout.split() == ["3.0", "1.0", "False"]
    assert done.stderr.count("no cache for compiled code") == 1


def test_a_corrupted_cache_is_replaced(warm, tmp_path):
    copy, cache = warm[0], tmp_path / "cache"
    shutil.copytree(warm[1], cache)
    for path in compiled_files(cache):
        path.write_bytes(b"\x00garbage" * 10)
    done = run(ASK, copy, NUMBA_CACHE_DIR=str(cache))
    assert done.stdout.split() == ["3.0", "1.0", "True"]
    assert done.stderr.count("is damaged") == 1
    assert run(ASK, copy, NUMBA_CACHE_DIR=str(cache)).stderr == ""


# Every kernel, by the public functions that call it.
EVERY_KERNEL = """
import json
import numpy as np
import explorer as ex
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.linear_constants import line_chart
from explorer.phase.falling_set import barrier
from explorer.phase.coordinates import constants_to_states
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.race_angles import RaceAngles
from numba.core.runtime import _nrt_python, rtsys
_nrt_python.memsys_enable_stats()
disk = ex.Disk.uniform()
state = {"phi": -0.4, "phidot": 0.5, "sigma3": 0.05, "sigma4": -0.3}
states = ex.phi_to_states(disk, **state)
tally = RaceAngles.of(dict(samples=8, eta_hat="1e-4:9e-4")).chunk(0)[1]
faces = FallingSet(samples=70, theta_min="near", box="phi=-1:1").chunk(0)[1].faces
numbers = [
    ex.passages(disk, [1.0, 0.3], [1e-3, -1e-9], [1.0, 1e-3]).race_angle,
    ex.passages(disk, 1.0, 1e-3, 1.0, accuracy=1e-3).race_angle,
    *(
        ex.passages(disk, 1.0, 1e-3, 1.0, method=method, accuracy=1e-3).race_angle
        for method in ("rk4", "rk8", "dopri5", "dop853")
    ),
    ex.passage_forces(disk, 1.0, 1e-3, 1.0).min_normal_force,
    ex.periods(constants_to_states(disk, 1.0, 1e-3, 1.0)).period,
    ex.bounces(constants_to_states(disk, 1.0, [1e-3, 0.3], 1.0), 2).race_angle,
    ex.periods(ex.phi_to_states(disk, 0.5, 1e-3, 1.0, 0.9), accuracy=1e-10).period,
    ex.falls(states).theta_min_estimate,
    ex.flow_stretch(states).determinant,
    ex.limit_motion(ex.phi_to_states(disk, 0.0, 1.0, 1.0, 0.7285923160189477), side=1)(1.0).chi,
    smallest_tilt(states, plan(("theta_min",), 1e-6))[0],
    barrier(disk, np.array([0.2])),
    line_chart(disk, np.ones(1), np.zeros(1)).bar_to_sigma4,
    (motion := ex.simulate(states, t_end=2.0, accuracy=1e-6)).phi[..., -1],
    motion([0.5, 1.7]).chi,
    *(
        ex.simulate(states, t_eval=[0.0, 1.0, 2.0], accuracy=1e-2, method=method, observables=names).phi
        for method in ("rk4", "rk8", "dopri5", "dop853")
        for names in (("phi",), ("phi", "path"))
    ),
    list(faces.values()),
    tally.angles["plus"].counts, float(tally.deviations["-8"]), tally.decades.part([-7]).quantile(0.5),
]
print(json.dumps([float(x) for row in numbers for x in np.ravel(row)]))
print(*rtsys.get_allocation_stats())
"""


@pytest.mark.long
def test_every_interpreted_kernel_agrees_with_the_compiled_one_and_stays_inside_its_arrays():
    """Python checks every index. Where a compiler may fuse a product and a sum, the last digits differ."""
    plain, _nothing = run(EVERY_KERNEL, ROOT, NUMBA_DISABLE_JIT="1").stdout.splitlines()
    compiled, counts = run(EVERY_KERNEL, ROOT).stdout.splitlines()
    assert json.loads(plain) == pytest.approx(json.loads(compiled), rel=1e-12)
    made, freed, counted, let_go = map(int, counts.split())
    assert made > 100
    assert (made, counted) == (freed, let_go)  # no kernel keeps an array


CHART = """
import numpy as np
from kernels.disk import falling
from kernels.disk.body import make_disk
random, out = np.random.default_rng(1), np.empty((4, 400))
q = random.uniform(0.1, 0.9, 400)
falling.line_chart_batch(q, np.sqrt(1.0 - q * q), make_disk(0.25, 0.5), out)
print(*(x.hex() for x in out.ravel()))
"""


def test_the_process_that_compiles_and_later_ones_give_the_same_bits(tmp_path):
    """Products and sums that may be rounded together are paired alike in both."""
    first, later = (run(CHART, ROOT, NUMBA_CACHE_DIR=str(tmp_path)).stdout.split() for _ in range(2))
    assert len(first) == 1600
    assert first == later


def test_a_processor_that_is_named_is_not_overruled():
    code = "import kernels._jit\nfrom numba.core import config\nprint(config.CPU_NAME, config.CPU_FEATURES)"
    assert run(code, ROOT, NUMBA_CPU_NAME="haswell").stdout.split() == ["haswell", "None"]
