"""The only way into the compiled layer.

`kernels` is a generic name: another distribution installs an import package of that name, and the
one found first on the path wins. So everything in `explorer` reaches kernels through here. A module of
`kernels` is imported on first use, because numba takes a second to load.
"""

import importlib
import importlib.util
import os
import platform
import sys
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

_OURS = Path(__file__).resolve().parent.parent / "kernels"
_LOCK = threading.RLock()

if TYPE_CHECKING:
    import subprocess

    from kernels import status as status
    from kernels import types as types
    from kernels._jit import Kernel
    from kernels.arcs import motions as motions
    from kernels.arcs import nutation as nutation
    from kernels.arcs import pieces as pieces
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
    from kernels.disk import membership as membership
    from kernels.disk import polynomials as polynomials
    from kernels.near_flat import passages as passages
    from kernels.near_flat import tables as tables
    from kernels.steps import attempt as attempt
    from kernels.steps import engine as engine
    from kernels.steps import events as events
    from kernels.steps import variation as variation
else:

    def __getattr__(name: str) -> ModuleType:
        """Modules of the compiled layer, whichever folder they are in: `compiled.batch`, `compiled.body`, ..."""
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
    return importlib.import_module(module)


def source_digest() -> str:
    """Digest of the kernels' source and of the versions that compile them."""
    digest: str = _load("kernels._jit").source_digest()
    return digest


def target() -> tuple[str, bool]:
    """The kind of processor that kernels are compiled for, and whether it rounds a product and a sum together."""
    from llvmlite import binding
    from numba.core import config  # here: numba takes a second to load

    name, chosen = config.CPU_NAME or binding.get_host_cpu_name(), config.CPU_FEATURES
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return name, True  # all others that numba compiles for do
    if chosen is None:  # numba adds all that the machine has to whatever kind is named
        return name, bool(binding.get_host_cpu_features().get("fma"))
    return name, "+fma" in chosen.split(",")


def warmup(names: Iterable[str] | None = None, say: Callable[[str], None] = lambda text: None) -> int:
    """Compile the kernels that the cache lacks, each for all later processes; returns how many there were.

    names: such as "passages.fall_batch", by default every kernel. What the cache has is loaded when it is called:
    of some that are named few may be. `say` receives a line before anything is compiled, which takes from seconds
    to a minute.
    """
    cached = _load("kernels._jit").cached_names()
    kernels = _kernels(names if names is None else [name for name in names if name not in cached])
    fresh = [kernel for kernel in kernels if not kernel.is_loaded and kernel.name not in cached]
    if fresh:
        say(f"compiling {len(fresh)} kernel(s); once for this version, then kept")
    helper = _second_process(fresh) if len(fresh) > 1 else None
    try:
        for kernel in fresh:
            kernel.compile()
    finally:
        if helper is not None:
            helper.kill()
            helper.wait()
    return len(fresh)


def _kernels(names: Iterable[str] | None) -> "list[Kernel[Any]]":
    """Kernels by their names, or all."""
    modules = _modules()
    for module in modules if names is None else dict.fromkeys(name.partition(".")[0] for name in names):
        _load(modules[module])
    registry: dict[str, Kernel[Any]] = _load("kernels._jit").KERNELS
    # What stands together shares code, which each of two processes compiles for itself.
    return [registry[name] for name in sorted(set(registry if names is None else names))]


def usable_cores() -> int:
    """How many cores this process may use, of those that the machine has."""
    from joblib import cpu_count  # whose import takes a sixth of a second

    return int(cpu_count())


def _second_process(kernels: "list[Kernel[Any]]") -> "subprocess.Popen[bytes] | None":
    """A process that compiles these into the cache from the end of the list, while this one begins at the front.

    Each takes from the cache what the other has made. None where there is no use or no way of having one.
    """
    import subprocess

    python = Path(sys.executable or "").stem.lower().startswith("python")  # else another program has Python in it
    if usable_cores() == 1 or not python or _load("kernels._jit").cache_folder() is None:
        return None
    names = [kernel.name for kernel in kernels]
    code = f"from explorer import compiled\nfor kernel in reversed(compiled._kernels({names})): kernel.compile()"
    path = os.pathsep.join([str(_OURS.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment, none = {**os.environ, "PYTHONPATH": path}, subprocess.DEVNULL
    try:
        return subprocess.Popen(
            [sys.executable, "-c", code], env=environment, stdin=none, stdout=none, stderr=none
        )
    except OSError:  # no memory, no processes left: it takes longer
        return None
