"""The door to the kernels: what goes through it, what it compiles, and whose compiled code it refuses."""

import _thread
import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

from explorer import compiled

ROOT = Path(__file__).parents[2]


def test_scenes_read_nothing_but_statuses_through_the_door():
    """A scene says what it asks; which kernel answers is decided in `motion.plan`."""
    texts = [path.read_text("utf-8") for path in (ROOT / "explorer" / "scenes").glob("*.py")]
    named = {
        name for text in texts for name in re.findall(r"(?<!`)\bcompiled\.(\w+)|explorer\.compiled import", text)
    }
    assert named <= {"status"}


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


@pytest.fixture
def shared(monkeypatch):
    """Compiles eight pretended kernels with a helper that runs some code; returns the names that it left."""

    def compile_with(code):
        helper = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        monkeypatch.setattr(compiled, "_second_process", lambda: helper)
        here, slow = [], threading.Event()
        kernels = [
            SimpleNamespace(name=f"k{n}", compile=lambda n=n: (slow.wait(0.05), here.append(n))) for n in range(8)
        ]
        compiled._compile_by_two(kernels)
        assert helper.poll() is not None
        return here

    return compile_with


def test_two_processes_share_the_kernels_from_both_ends(shared):
    here = shared("import sys\nfor line in sys.stdin: print(line, flush=True)")
    assert here == list(range(len(here)))
    assert 0 < len(here) < 8


def test_a_second_process_that_ends_leaves_its_kernels_to_the_first(shared):
    here = shared("raise SystemExit(1)")
    assert here == list(range(len(here)))
    assert len(here) >= 7  # the one that was given out is compiled when it is loaded


@pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")
def test_compiled_code_that_others_own_or_can_change_is_not_loaded(tmp_path, monkeypatch):
    """Also below the top folder; where they cannot enter that, modes below do not matter."""
    code = tmp_path / "disk_1" / "field.nbi"
    code.parent.mkdir(mode=0o755)
    code.write_bytes(b"")
    code.chmod(0o644)
    for path in (code, code.parent):
        before = path.stat().st_mode
        path.chmod(0o777)
        tmp_path.chmod(0o700)
        assert compiled._foreign(tmp_path) is None
        tmp_path.chmod(0o755)
        assert compiled._foreign(tmp_path) == f"{path} can be written by other users"
        path.chmod(before)
        assert compiled._foreign(tmp_path) is None
    link = tmp_path / "steps_1"
    for target in (code.parent, code, tmp_path / "nothing"):
        link.symlink_to(target)
        assert compiled._foreign(tmp_path) == f"{link} is a link"
        link.unlink()
    mine = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: mine + 1)
    assert compiled._foreign(tmp_path) == f"{code.parent} belongs to another user"


@pytest.mark.skipif(os.name != "posix", reason="modes are those of POSIX")
def test_a_cache_that_others_can_change_is_refused_before_a_kernel_is_there(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    digest = compiled.source_digest()[:16]
    inside = tmp_path / f"nearflat-{digest}" / "disk_1"
    inside.mkdir(parents=True)
    inside.chmod(0o777)
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
    assert f"compiled code is not loaded: {inside} can be written by other users; remove" in done.stderr


def test_ctrl_c_waits_until_numba_is_loaded(monkeypatch):
    """A package that was loaded by half lacks its own parts when it is loaded again."""
    done = []

    def loads(module):
        _thread.interrupt_main()
        done.extend(range(1000))
        return module

    monkeypatch.delitem(sys.modules, "numba", raising=False)
    monkeypatch.setattr(compiled.importlib, "import_module", loads)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    try:
        with pytest.raises(KeyboardInterrupt):
            compiled._load("kernels.status")
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(done) == 1000
