"""The one door to the compiled layer.

`kernels` is a generic name: another distribution installs an import package of that name, and the
one found first on the path wins. So everything in `explorer` reaches kernels through here.
"""

import importlib
import importlib.util
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

_OURS = Path(__file__).resolve().parent.parent / "kernels"
_MODULES = (
    "algebra",
    "batch",
    "body",
    "constants",
    "events",
    "falling",
    "field",
    "forces",
    "orbits",
    "passages",
    "quadrature",
    "status",
    "steps",
    "tables",
    "trajectory",
    "variation",
)
_LOCK = threading.RLock()


def _load(name: str) -> ModuleType:
    # Found by looking, not by importing: a foreign package must not run any of its code.
    spec = importlib.util.find_spec("kernels")
    found = Path(spec.origin).resolve().parent if spec and spec.origin else None
    if found != _OURS:
        where = found or (list(spec.submodule_search_locations or []) if spec else "nowhere")
        raise ImportError(
            f"nearflat found another package called 'kernels' first ({where}) instead of its own ({_OURS}); "
            "install nearflat in a fresh virtual environment, or take the other one off PYTHONPATH"
        )
    return importlib.import_module(f"kernels.{name}")


def __getattr__(name: str) -> Any:
    """Modules of the compiled layer, imported on first use: `compiled.batch`, `compiled.body`, ..."""
    if name in _MODULES:
        with _LOCK:
            module = globals()[name] = _load(name)
        return module
    raise AttributeError(name)


def source_digest() -> str:
    """Digest of the kernels' source and of the versions that compile them."""
    return _load("_jit").source_digest()


def warmup(say: Callable[[str], None] = lambda text: None) -> int:
    """Compile every kernel or load it from the cache; returns how many had to be compiled.

    `say` receives a line before each compilation, which takes a few seconds.
    """
    for name in _MODULES:
        _load(name)
    registry = _load("_jit").KERNELS
    fresh = [kernel for kernel in registry.values() if not kernel.is_cached()]
    for number, kernel in enumerate(fresh, 1):
        say(f"compiling {kernel.name} ({number} of {len(fresh)}; once for this version, then cached)")
        kernel.compile()
    for kernel in registry.values():
        kernel.compile()
    return len(fresh)
