"""The one door to the compiled layer.

`kernels` is a generic name: another distribution installs an import package of that name, and the
one found first on the path wins. So everything in `explorer` reaches kernels through here. A module of
`kernels` is imported on first use, because numba takes a second to load.
"""

import contextlib
import importlib
import importlib.util
import os
import platform
import signal
import stat
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

_OURS = Path(__file__).resolve().parent.parent / "kernels"
_LOCK = threading.RLock()
# Two processes compile from the two ends of this list of modules: what shares most of its code stands together,
# and what takes longest stands outside. Others stand where "falling" does.
_TWO_ENDED = (
    *("batch", "motions", "recording", "variation"),
    *("counting", "falling", "algebra", "nutation", "turning_points", "rules", "passages"),
)
_NAMED = 4  # kernels that are named when they are compiled

if TYPE_CHECKING:
    import subprocess

    from kernels import status as status
    from kernels import types as types
    from kernels._jit import Kernel
    from kernels.arcs import nutation as nutation
    from kernels.arcs import potential as potential
    from kernels.arcs import rules as rules
    from kernels.arcs import turning_points as turning_points
    from kernels.disk import algebra as algebra
    from kernels.disk import body as body
    from kernels.disk import chaplygin as chaplygin
    from kernels.disk import constants as constants
    from kernels.disk import counting as counting
    from kernels.disk import falling as falling
    from kernels.disk import field as field
    from kernels.disk import philox as philox
    from kernels.disk import polynomials as polynomials
    from kernels.disk import race_law as race_law
    from kernels.disk import sifting as sifting
    from kernels.near_flat import passages as passages
    from kernels.near_flat import races as races
    from kernels.near_flat import tables as tables
    from kernels.steps import attempt as attempt
    from kernels.steps import batch as batch
    from kernels.steps import events as events
    from kernels.steps import motion_lanes as motion_lanes
    from kernels.steps import motions as motions
    from kernels.steps import recording as recording
    from kernels.steps import trail as trail
    from kernels.steps import variation as variation
else:

    def __getattr__(name: str) -> ModuleType:
        """Modules of the compiled layer, whichever room they are in: `compiled.batch`, `compiled.body`, ..."""
        module = _modules().get(name)
        if module is None:
            raise AttributeError(f"the compiled layer has no module {name!r}")
        with _LOCK:
            loaded = globals()[name] = _load(module)
        return loaded


def _modules() -> dict[str, str]:
    """Every module of `kernels`, by its own name."""
    paths = [path.relative_to(_OURS.parent).with_suffix("") for path in _OURS.rglob("[a-z]*.py")]
    return {path.name: ".".join(path.parts) for path in paths}


def _load(module: str) -> ModuleType:
    # Found by looking, not by importing: a foreign package must not run any of its code.
    spec = importlib.util.find_spec("kernels")
    found = Path(spec.origin).resolve().parent if spec and spec.origin else None
    if found != _OURS:
        where = found or (list(spec.submodule_search_locations or []) if spec else "nowhere")
        raise ImportError(
            f"nearflat found another package called 'kernels' first ({where}) instead of its own ({_OURS}); "
            "install nearflat in a fresh virtual environment, or take the other one off PYTHONPATH"
        )
    with _uninterrupted():
        loaded = importlib.import_module(module)
    if module != "kernels._jit" and "kernels._jit" in sys.modules:  # some modules have no kernels
        _check_cache()
    return loaded


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Let Ctrl-C wait until numba is loaded: broken off half-way, it cannot be loaded again in that process."""
    main = threading.current_thread() is threading.main_thread()
    before = signal.getsignal(signal.SIGINT)
    if "numba" in sys.modules or not main or before is None:  # None: another language handles it
        yield
        return
    heard = threading.Event()
    signal.signal(signal.SIGINT, lambda *_: heard.set())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if heard.is_set():
        signal.raise_signal(signal.SIGINT)


@cache
def _check_cache() -> None:
    """Raise ImportError where another user may own or change compiled code: it runs as whoever loads it.

    `kernels` itself looks at the top folder only. This is done once, before any kernel can be called.
    """
    folder: Path | None = _load("kernels._jit").cache_folder()
    fault = _foreign(folder) if folder is not None and os.name == "posix" else None
    if fault:
        remedy = f"remove {folder}, or set NUMBA_CACHE_DIR to a folder of your own"
        raise ImportError(f"compiled code is not loaded: {fault}; {remedy}")


def _foreign(folder: Path) -> str | None:
    """What inside a folder another user owns or can change, in words; None where nothing is.

    A link is one more way to change it, and no folder is looked at behind one; numba makes none.
    """
    user, others = os.geteuid(), stat.S_IWGRP | stat.S_IWOTH
    if not folder.stat().st_mode & (stat.S_IXGRP | stat.S_IXOTH):
        others = 0  # nobody else gets as far; an umask of 002 leaves such modes in everybody's own cache
    for path in folder.rglob("*"):
        with contextlib.suppress(FileNotFoundError):  # another process has just given it its name
            found = path.lstat()
            if stat.S_ISLNK(found.st_mode):
                return f"{path} is a link"
            if found.st_uid != user:
                return f"{path} belongs to another user"
            if found.st_mode & others:
                return f"{path} can be written by other users"
    return None


def source_digest() -> str:
    """Digest of the kernels' source and of the versions that compile them."""
    digest: str = _load("kernels._jit").source_digest()
    return digest


def target() -> tuple[str, bool]:
    """The kind of processor that kernels are compiled for, and whether it rounds a product and a sum together."""
    from llvmlite import binding
    from numba.core import config  # here: numba takes a second to load

    name = config.CPU_NAME or binding.get_host_cpu_name()
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return name, True  # all others that numba compiles for do
    chosen = config.CPU_FEATURES
    if chosen is None:  # numba adds all that the machine has to whatever kind is named
        return name, bool(binding.get_host_cpu_features().get("fma"))
    if chosen and "fma" in chosen:
        return name, "+fma" in chosen.split(",")
    return name, _has_fma(name)


def _has_fma(name: str) -> bool:
    """Whether LLVM's kind of processor of that name has the instruction: asked of what it makes of a product."""
    from llvmlite import binding

    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    module = binding.parse_assembly(
        "declare double @llvm.fma.f64(double, double, double)\n"
        "define double @f(double %a, double %b, double %c) {\n"
        "  %d = call double @llvm.fma.f64(double %a, double %b, double %c)\n  ret double %d\n}"
    )
    target = binding.Target.from_triple(binding.get_process_triple())
    return "vfmadd" in target.create_target_machine(cpu=name).emit_assembly(module)


def warmup(names: Iterable[str] | None = None, say: Callable[[str], None] = lambda text: None) -> int:
    """Compile kernels or load them from the cache; returns how many had to be compiled.

    names: such as "passages.fall_batch", by default every kernel. `say` receives a line before anything is
    compiled, which takes from seconds to a minute.
    """
    idle, fresh = _missing(names, say)
    for kernel in idle:
        kernel.compile()
    return fresh


def compile_missing(names: Iterable[str] | None = None, say: Callable[[str], None] = lambda text: None) -> int:
    """As `warmup`, but what the cache has is not loaded: of some kernels that are named few may be called."""
    cached = _load("kernels._jit").cached_names()
    # By their names: what has them takes a while to import.
    return _missing(None if names is None else [name for name in names if name not in cached], say)[1]


def _missing(names: Iterable[str] | None, say: Callable[[str], None]) -> "tuple[list[Kernel[Any]], int]":
    """Compile what the cache lacks; returns the kernels that were not loaded before, and how many it lacked."""
    modules = _modules()
    for module in modules if names is None else dict.fromkeys(name.partition(".")[0] for name in names):
        _load(modules[module])
    registry = _load("kernels._jit").KERNELS
    asked = registry if names is None else dict.fromkeys(names)
    idle = [registry[name] for name in sorted(asked, key=_place) if not registry[name].is_loaded]
    cached = _load("kernels._jit").cached_names() if idle else ()
    fresh = [kernel for kernel in idle if kernel.name not in cached]
    if fresh:
        called = ", ".join(kernel.function.__name__ for kernel in fresh[:_NAMED])
        others = f" and {len(fresh) - _NAMED} more" if len(fresh) > _NAMED else ""
        say(f"compiling {called}{others}; once for this version, then kept")
        _compile_by_two(fresh)
    return idle, len(fresh)


def _place(name: str) -> tuple[int, str]:
    """Where a kernel stands in the order in which two processes compile, each from its own end."""
    module = name.partition(".")[0]
    return _TWO_ENDED.index(module) if module in _TWO_ENDED else _TWO_ENDED.index("falling"), name


def _compile_by_two(kernels: "list[Kernel[Any]]") -> None:
    """Compile into the cache, with a second process where that helps; what it could not do is left."""
    left = deque(kernels)
    helper = _second_process() if len(kernels) > 1 else None
    try:
        if helper is not None:
            others = threading.Thread(target=_give_out, args=(left, helper), daemon=True)
            others.start()
        while left:
            with contextlib.suppress(IndexError):  # the other was faster
                left.popleft().compile()
        if helper is not None:
            others.join()
    finally:
        if helper is not None:
            helper.kill()
            helper.communicate()


def _second_process() -> "subprocess.Popen[str] | None":
    """A process that compiles kernels by their names, or None where there is no use or no way of having one."""
    import subprocess

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    python = Path(sys.executable or "").stem.lower().startswith("python")  # else another program has Python in it
    if cores == 1 or not python or _load("kernels._jit").cache_folder() is None:
        return None
    path = os.pathsep.join([str(_OURS.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    try:
        return subprocess.Popen(
            [sys.executable, "-c", "from explorer.compiled import compile_as_told; compile_as_told()"],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
    except OSError:  # no memory, no processes left: it takes longer
        return None


def _give_out(left: "deque[Kernel[Any]]", helper: "subprocess.Popen[str]") -> None:
    """Have the helper compile from the end of the list, for as long as it answers."""
    assert helper.stdin is not None
    assert helper.stdout is not None
    with contextlib.suppress(IndexError, OSError, ValueError):
        while left:
            helper.stdin.write(left.pop().name + "\n")
            helper.stdin.flush()
            if not helper.stdout.readline():
                return


def compile_as_told() -> None:
    """Compile the kernels whose names come on stdin, a line each, and answer each with a line."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started this process ends it
    for line in sys.stdin:
        name = line.strip()
        _load(_modules()[name.partition(".")[0]])
        _load("kernels._jit").KERNELS[name].compile()
        print(name, flush=True)
