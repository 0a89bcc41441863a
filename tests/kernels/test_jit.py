"""The compiler's cache: never stale, never in the way."""

import importlib
import json
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Annotated, get_args, get_origin, get_type_hints

import pytest
from numba import types as nb

import kernels
from kernels import _jit

ROOT = Path(__file__).parents[2]

ASK = """
import numpy as np
from kernels.disk import falling
from kernels.disk.body import make_disk
disk = make_disk(0.25, 0.5)
out = np.empty((4, 1))
# A kernel that compiles in a second; it calls solutions() in another file.
falling.line_chart_batch(np.ones(1), np.zeros(1), disk, out)
print(round(float(out[0, 0]), 12), falling.line_chart_batch.is_cached())
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


def copy_of_kernels(folder):
    shutil.copytree(ROOT / "kernels", folder / "kernels", ignore=shutil.ignore_patterns("__pycache__"))
    return folder


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """A copy of the package, and a cache that holds its kernel; what a first process said."""
    copy, cache = copy_of_kernels(tmp_path_factory.mktemp("copy")), tmp_path_factory.mktemp("cache")
    assert run(ASK, copy, NUMBA_CACHE_DIR=str(cache)).stdout.split() == ["1.0", "True"]
    return copy, cache


def compiled_files(cache):
    return {path: path.stat().st_mtime_ns for path in cache.rglob("*.nb[ic]")}


def test_editing_a_called_function_in_another_file_gives_the_new_answer(tmp_path):
    """The caller's file is untouched, so numba alone would serve the old code (numba #1833)."""
    copy, cache = copy_of_kernels(tmp_path), {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    first = run(ASK, copy, **cache).stdout.split()
    again = run(ASK, copy, **cache).stdout.split()
    assert first == again == ["1.0", "True"]
    chaplygin = copy / "kernels" / "disk" / "chaplygin.py"
    text = chaplygin.read_text()
    assert "rho, half_c = S * g" in text
    chaplygin.write_text(text.replace("rho, half_c = S * g", "rho, half_c = 3.0 * S * g"))
    edited = run(ASK, copy, **cache).stdout.split()
    assert edited == ["3.0", "True"]


LATER = """
import sys, numba
print("numba.np.arraymath" in sys.modules, round(float(numba.njit(lambda a: a @ a + np.sin(a[0]))(np.ones(3))), 6))
"""


@pytest.mark.parametrize(("known", "loaded"), [("True", "False"), ("False", "True")])
def test_from_the_cache_a_kernel_comes_without_what_compiles_which_others_still_have(warm, known, loaded):
    copy, cache = warm
    code = f"from kernels import _jit\n_jit._AS_KNOWN = {known}\n{ASK}{LATER}"
    assert run(code, copy, NUMBA_CACHE_DIR=str(cache)).stdout.split() == ["1.0", "True", loaded, "3.841471"]


def test_the_second_process_loads_and_does_not_compile(warm):
    copy, cache = warm
    before = compiled_files(cache)
    assert before
    run(ASK, copy, NUMBA_CACHE_DIR=str(cache))
    assert compiled_files(cache) == before


# Of all that kernels call, `seek` changes most when it is optimised once more with its caller.
SEEK = """
import numpy as np
import seeking
from kernels.disk.body import make_disk
from kernels.integrals import sums, tables, tabulated
numbers = np.random.default_rng(3)
lanes = numbers.normal(size=sums.ROWS * sums.LANES)
scan = abs(numbers.normal(size=(len(tables.Fixed._fields), 40)))
cached = seeking.seek_batch.is_cached()
seeking.seek_batch(lanes, scan, make_disk(0.25, 0.5).body)
(made,) = seeking.seek_batch._compiled.overloads.values()
defined = [function for function in made.library._final_module.functions if not function.is_declaration]
print(cached, lanes.tobytes().hex(), *(f.name for f in defined if f.linkage.name != "internal"))
"""
SEEKING = """
from kernels._jit import kernel
from kernels.disk.body import Body
from kernels.integrals import wide
from kernels.types import Matrix, Vector

@kernel
def seek_batch(lanes: Vector, scan: Matrix, b: Body) -> None:
    wide.seek(lanes, scan, b)
"""


@pytest.fixture(scope="module")
def sought(tmp_path_factory):
    """Of the process that compiles a kernel and of a later one: whether it was cached, its numbers, its names."""
    folder = copy_of_kernels(tmp_path_factory.mktemp("seeking"))
    (folder / "seeking.py").write_text(SEEKING)
    return [run(SEEK, folder, NUMBA_CACHE_DIR=str(folder / "cache")).stdout.split() for _ in range(2)]


def test_the_process_that_compiles_computes_bit_for_bit_what_later_ones_do(sought):
    (fresh, first, *_), (cached, later, *_) = sought
    assert (fresh, cached) == ("False", "True")
    assert first == later


def test_the_loader_sees_a_kernel_and_nothing_that_it_calls(sought):
    """Of two kernels that call the same function, the later one would else run that of the first."""
    seen = sought[0][2:]
    assert seen
    assert all("seek_batch" in name for name in seen)


def test_without_a_writable_cache_folder_it_works_with_one_warning(warm, tmp_path):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where the folder should be")
    done = run(ASK, warm[0], NUMBA_CACHE_DIR=str(blocked))
    assert done.stdout.split() == ["1.0", "False"]
    assert done.stderr.count("no cache for compiled code") == 1


@pytest.fixture
def folder_below(monkeypatch):
    """The cache folder that a process would choose below a place, and what it warns of."""

    def look(place):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(place))
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            return _jit.cache_folder.__wrapped__(), "".join(str(each.message) for each in said)

    return look


@pytest.mark.skipif(os.name != "posix", reason="modes are those of POSIX")
def test_the_cache_folder_is_for_its_owner_only(folder_below, tmp_path):
    """Compiled code is a pickle: whoever can write it runs as the one who loads it."""
    made, said = folder_below(tmp_path / "new")
    assert (made.stat().st_mode & 0o777, made.parent.stat().st_mode & 0o777, said) == (0o700, 0o700, "")
    made.chmod(0o770)
    refused, said = folder_below(made.parent)
    assert refused is None
    assert "can be written by other users; remove" in said
    made.chmod(0o700)
    made.parent.chmod(0o777)
    assert "may replace what is in it" in folder_below(made.parent)[1]
    made.parent.chmod(0o1777)  # as /tmp: nobody removes what another owns
    assert folder_below(made.parent) == (made, "")


@pytest.mark.skipif(os.name != "posix", reason="owners are those of POSIX")
def test_a_cache_folder_of_another_user_is_refused(folder_below, tmp_path, monkeypatch):
    mine = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: mine + 1)
    refused, said = folder_below(tmp_path)
    assert refused is None
    assert "belongs to another user" in said


def test_a_corrupted_cache_is_replaced_or_ignored(warm, tmp_path):
    copy, cache = warm[0], tmp_path / "cache"
    shutil.copytree(warm[1], cache)
    for path in compiled_files(cache):
        path.write_bytes(b"\x00garbage" * 10)
    assert run(ASK, copy, NUMBA_CACHE_DIR=str(cache)).stdout.split()[0] == "1.0"


def test_moving_or_renaming_a_file_is_a_new_source(tmp_path, monkeypatch):
    """The digest that names the cache's folder sees sub-folders, names and contents."""
    copy = copy_of_kernels(tmp_path) / "kernels"
    monkeypatch.setattr(_jit, "__file__", str(copy / "_jit.py"))
    digest = _jit.source_digest.__wrapped__

    digests = [digest()]
    (copy / "disk" / "field.py").rename(copy / "disk" / "fields.py")
    digests.append(digest())
    (copy / "disk" / "fields.py").rename(copy / "steps" / "field.py")
    digests.append(digest())
    with (copy / "steps" / "field.py").open("a") as file:
        file.write("# more\n")
    digests.append(digest())
    assert len(set(digests)) == 4
    (copy / "disk" / "__pycache__").mkdir(exist_ok=True)
    assert digest() == digests[-1]


def test_the_annotations_of_a_kernel_are_its_signature():
    from kernels.disk import falling

    names = [str(argument) for argument in falling.critical_X2_batch.signature.args]
    assert names[0] == names[2] == "array(float64, 1d, C)"
    assert names[1].startswith("Disk(")
    assert str(falling.critical_X2_batch.signature.return_type) == "none"


def gives_arrays(hint):
    """Whether what is annotated so is or holds an array."""
    if get_origin(hint) is Annotated:
        return isinstance(get_args(hint)[1], nb.Array)
    record = get_origin(hint) or hint
    fields = get_type_hints(record, include_extras=True).values() if hasattr(record, "_fields") else []
    return any(map(gives_arrays, [*fields, *get_args(hint)]))


def test_arrays_that_are_given_back_are_counted_on_both_sides_or_on_neither():
    """A kernel would free what a function gives back that does not count; that would keep what is new for ever."""
    names = [found.name for found in pkgutil.walk_packages(kernels.__path__, "kernels.")]
    modules = [importlib.import_module(name) for name in names]
    found = [each for module in modules for each in vars(module).values()]
    callees = {each.py_func: "_nrt" not in each.targetoptions for each in found if isinstance(each, _jit.Callee)}
    givers = {made.__name__: n for made, n in callees.items() if gives_arrays(_hints(made).get("return"))}
    assert givers.keys() >= {"grade_at", "make_room", "work_array"}
    assert givers["make_room"]
    assert not givers["grade_at"]
    callers = callees | {each.function: True for each in found if isinstance(each, _jit.Kernel)}
    for caller, counts in callers.items():
        called = set(caller.__code__.co_names) & givers.keys()
        assert {name for name in called if givers[name] != counts} == set(), caller


def _hints(function):
    return get_type_hints(function, include_extras=True)


PLAIN = """
import sys, numpy as np, numba
MOVED = [0]  # units of rounding
from kernels.disk import field
from kernels.steps import attempt as steps, batch, events
from kernels.disk.body import make_disk
from kernels.disk.chaplygin import make_whole
disk = make_disk(0.25, 0.5)
for moved, last in [(units * 2.3e-16, last) for units in MOVED for last in (-0.2, np.nan)]:
    states = np.zeros((8, 3))
    states[0], states[2], states[3] = 1.0, [-1.0, 0.4, -0.2], [1.0, 0.3, -0.7]
    states[4] = np.array([0.6, last, 0.9]) * (1.0 + moved)
    out, constants_error, steps_ = np.empty((8, 3)), np.empty((3, 3)), np.empty(3, np.int32)
    for method, control in ((steps.RK4, 0.1), (steps.DOPRI5, 1e-5)):
        status = np.zeros(3, np.int8)
        how = steps.Integration(method, field.ANGLES, np.full(3, control), 5000, 1e-2)
        stop = events.Stop(events.TURNING_POINT, 0.0)
        outcome = steps.Outcome(status, steps_, constants_error)
        free = np.full((3, 3), np.nan)
        batch.FIRST_EVENT[method](batch.Work(how, stop, states, free, out, outcome), disk, make_whole(disk.series))
        print([x.hex() for x in out.ravel()], status.tolist(), steps_.tolist())
"""


@pytest.fixture(scope="module")
def strict():
    """What PLAIN prints with strict arithmetic, the default: good states by two methods, then with a NaN.

    First from its start, then from starts that units of rounding move.
    """
    printed = run(PLAIN.replace("MOVED = [0]", "MOVED = [0, -3, -2, -1, 1, 2, 3]"), ROOT).stdout.splitlines()
    return [printed[i : i + 4] for i in range(0, 28, 4)]


def test_interpreted_steps_agree_with_compiled_ones(strict):
    """Also shows that nothing depends on how the compiler treats the code."""
    assert run(PLAIN, ROOT, NUMBA_DISABLE_JIT="1").stdout.splitlines() == strict[0]
    assert sum("[0, 0, 0]" in line for line in strict[0]) == 2


# Every kernel, by the public functions that call it.
EVERY_KERNEL = """
import json
import numpy as np
import explorer as ex
from explorer import compiled
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.lines import line_chart
from explorer.phase.membership import barrier
from explorer.phase.states import constants_to_states
from explorer.measure.log_counts import SignedLogCounts
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.race_angles import RaceAngles
from numba.core.runtime import _nrt_python, rtsys
_nrt_python.memsys_enable_stats()
called, compiled_call = set(), compiled._load("kernels._jit").Kernel.__call__
def call(kernel, *arguments, **keywords):
    called.add(kernel.name)
    compiled_call(kernel, *arguments, **keywords)
compiled._load("kernels._jit").Kernel.__call__ = call
disk = ex.Disk.uniform()
state = {"phi": -0.4, "phidot": 0.5, "sigma3": 0.05, "sigma4": -0.3}
states = ex.phi_to_states(disk, **state)
scene = RaceAngles.of({"samples": 8, "eta_hat": "1e-4:9e-4"})
tally = scene.tally(0, scene.compute(0))
faces = FallingSet.of({"samples": 70, "theta_min": "near", "box": "phi=-1:1"}).process(0)[1]["faces"]
numbers = [
    ex.passages(disk, [1.0, 0.3], [1e-3, -1e-9], [1.0, 1e-3]).race_angle,
    ex.passages(disk, 1.0, 1e-3, 1.0, accuracy=1e-3).race_angle,
    *(
        ex.passages(disk, 1.0, 1e-3, 1.0, method=method, accuracy=1e-3).race_angle
        for method in ("rk4", "rk8", "dopri5", "dop853")
    ),
    ex.passage_forces(disk, 1.0, 1e-3, 1.0).min_normal_force,
    ex.periods(constants_to_states(disk, 1.0, 1e-3, 1.0)).period,
    # Hardly any moment of inertia about the axis: lanes leave it to the rules of one motion at a time.
    ex.periods(ex.phi_to_states(ex.Disk(I1=0.5, I3=0.02), 0.5, 0.1, 1.0, 1.0), accuracy=1e-10).period,
    ex.falls(states).theta_min_estimate,
    ex.flow_stretch(states).determinant,
    ex.limit_motion(ex.phi_to_states(disk, 0.0, 1.0, 1.0, 0.7285923160189477), side=1)(1.0).chi,
    smallest_tilt(states, plan(("theta_min",), 1e-6))[0],
    barrier(disk)[1](np.array([0.5])),
    line_chart(disk, np.ones(1), np.zeros(1)).bar_to_sigma4,
    (motion := ex.simulate(states, t_end=2.0, accuracy=1e-6)).phi[..., -1],
    motion([0.5, 1.7]).chi,
    *(
        ex.simulate(states, t_eval=[0.0, 1.0, 2.0], accuracy=1e-2, method=method, observables=names).phi
        for method in ("rk4", "rk8", "dopri5", "dop853")
        for names in (("phi",), ("phi", "path"))
    ),
    list(faces.values()),
    tally["plus"]["bins"], tally["minus"]["sum"], SignedLogCounts(tally["decades"]["-4"]["plus"]).quantile(0.5),
]
print(json.dumps([float(x) for row in numbers for x in np.ravel(row)]))
print(sorted(set(compiled._load("kernels._jit").KERNELS) - called))
print(*rtsys.get_allocation_stats())
"""


@pytest.mark.long
def test_every_interpreted_kernel_agrees_with_the_compiled_one_and_stays_inside_its_arrays():
    """Python checks every index. Where a compiler may fuse a product and a sum, the last digits differ."""
    plain, left_out, _nothing = run(EVERY_KERNEL, ROOT, NUMBA_DISABLE_JIT="1").stdout.splitlines()
    assert left_out == "[]"
    compiled, _, counts = run(EVERY_KERNEL, ROOT).stdout.splitlines()
    assert json.loads(plain) == pytest.approx(json.loads(compiled), rel=1e-12)
    made, freed, counted, let_go = map(int, counts.split())
    assert made > 100
    assert (made, counted) == (freed, let_go)  # no kernel keeps an array


def numbers_of(printed):
    """The first two lines of what PLAIN prints: 24 numbers each."""
    lines = [re.findall(r"-?0x[0-9a-fp.+-]+", line) for line in printed[:2]]
    assert [len(line) for line in lines] == [24, 24]
    return [float.fromhex(number) for line in lines for number in line]


@pytest.mark.long
def test_relaxed_arithmetic_differs_by_rounding_only_and_keeps_its_checks(strict):
    """Every number is one that strict arithmetic gives from this start, or from one moved by units of rounding:
    those may decide with which of two partial steps a landing begins, so a few alternatives are as good."""
    relaxed = run(PLAIN, ROOT, NEARFLAT_ARITHMETIC="relaxed").stdout.splitlines()
    assert relaxed != strict[0]
    for others, b in zip(zip(*map(numbers_of, strict), strict=True), numbers_of(relaxed), strict=True):
        assert any(a == pytest.approx(b, rel=1e-9, abs=1e-11) for a in others)
    fixed, adaptive = relaxed[2:]
    assert "[0, 5, 0]" in fixed  # not finite
    assert "[0, 4, 0]" in adaptive  # step too small


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
