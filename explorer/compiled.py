"""The one door to the compiled layer.

`kernels` is a generic name: another distribution installs an import package of that name, and the
one found first on the path wins. So everything in `explorer` reaches kernels through here. A module of
`kernels` is imported on first use, because numba takes a second to load.
"""

import importlib
import importlib.util
import platform
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

_OURS = Path(__file__).resolve().parent.parent / "kernels"
_LOCK = threading.RLock()

if TYPE_CHECKING:
    from kernels import status as status
    from kernels import types as types
    from kernels.disk import algebra as algebra
    from kernels.disk import body as body
    from kernels.disk import chaplygin as chaplygin
    from kernels.disk import constants as constants
    from kernels.disk import counting as counting
    from kernels.disk import falling as falling
    from kernels.disk import field as field
    from kernels.disk import polynomials as polynomials
    from kernels.integrals import bounces as bounces
    from kernels.integrals import forces as forces
    from kernels.integrals import orbits as orbits
    from kernels.integrals import passages as passages
    from kernels.integrals import point as point
    from kernels.integrals import quadrature as quadrature
    from kernels.integrals import tables as tables
    from kernels.steps import attempt as attempt
    from kernels.steps import batch as batch
    from kernels.steps import events as events
    from kernels.steps import recording as recording
    from kernels.steps import trajectory as trajectory
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
    return importlib.import_module(module)


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
    if chosen is None and config.CPU_NAME is None:
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


def warmup(say: Callable[[str], None] = lambda text: None) -> int:
    """Compile every kernel or load it from the cache; returns how many had to be compiled.

    `say` receives a line before each compilation, which takes a few seconds.
    """
    for module in _modules().values():
        _load(module)
    registry = _load("kernels._jit").KERNELS
    # Those loaded before are not looked for again: a search of the cache takes a while.
    idle = [kernel for kernel in registry.values() if kernel._compiled is None]
    fresh = [kernel for kernel in idle if not kernel.is_cached()]
    for number, kernel in enumerate(fresh, 1):
        say(f"compiling {kernel.name} ({number} of {len(fresh)}; once for this version, then cached)")
        kernel.compile()
    for kernel in idle:
        kernel.compile()
    return len(fresh)
