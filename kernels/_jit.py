"""The only place that knows how numba is called.

:func:`device` marks a function that is inlined into its callers, :func:`subroutine` one that is not.
:func:`kernel` marks a function that ``explorer`` calls: its annotations are its one explicit signature,
for mypy and for numba; it is compiled on first use, releases the GIL and is cached on disk.

numba's cache does not notice an edit of a *called* function in another file (numba #1833)
and would serve stale code. The cache folder is therefore keyed by a digest of every source
file of this package and of the compiler's version: new code, new folder.
"""

import hashlib
import os
import pickle
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, Generic, ParamSpec, TypeVar, get_args, get_origin, get_type_hints

import llvmlite
import numba
from numba import types as nb
from numba.core import config
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary, get_host_cpu_features
from numba.core.compiler import Compiler
from numba.core.runtime import rtsys
from numba.extending import typeof_impl

# The compiler may round a product and a sum together, once instead of twice, and nothing else: sums keep their
# order, so that no result depends on how many lanes a loop has left over, and NaN checks survive. Last digits
# depend on whether the processor can do it. (Single precision was tried: 1.8 times the steps per second, but
# errors of 2e-4 at the 99th percentile and no direction of races below |eta_hat| = 1e-5, where quadrature is
# both faster and exact.) 'numpy' makes 1/0 an infinity, not an exception.
_ARITHMETIC: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
# numba counts who holds an array: two atomic additions wherever a function is given one or reads it from a tuple,
# which took half of the time of passages by integration. A kernel holds its arrays as long as it runs, so what it
# calls need not count; what makes arrays does (`maker`).
_HELD, _COUNTED = {"_nrt": False}, {"_nrt": True}
_LOCK = threading.RLock()

_NUMBERS = {float: numba.float64, int: numba.int64, bool: numba.boolean}

KERNELS: dict[str, "Kernel"] = {}

P = ParamSpec("P")
F = TypeVar("F", bound=Callable)

# LLVM keeps to vectors of 256 bits on processors of Intel's that have 512, for the sake of old ones whose clock
# long vectors slow. Whole registers take 20 to 35 % off the time of quadrature there, 5 to 20 off integration.
# numba reads this once in a process, when it first compiles. Who names a processor is not overruled.
if config.CPU_NAME is None and config.CPU_FEATURES is None and "+avx512f" in get_host_cpu_features().split(","):
    config.CPU_FEATURES = f"{get_host_cpu_features()},-prefer-256-bit"


def numba_type(hint: Any) -> Any:
    """The numba type of an annotation: a number, an alias of `types`, or a NamedTuple of such."""
    if get_origin(hint) is Annotated:
        return get_args(hint)[1]
    if hint in _NUMBERS:
        return _NUMBERS[hint]
    fields = [numba_type(field) for field in get_type_hints(hint, include_extras=True).values()]
    if len(set(fields)) == 1:
        return nb.NamedUniTuple(fields[0], len(fields), hint)
    return nb.NamedTuple(fields, hint)


class Callee:
    """A function for compiled callers, without the two wrappers that numba makes for callers in Python and in C.

    They would take a fifth of the time in which a kernel compiles. Called from Python, the function is compiled
    once more, with them.
    """

    def __init__(self, function: Callable, options: dict[str, Any]) -> None:
        self.py_func, self.targetoptions = function, options
        self.__doc__ = function.__doc__

    def __reduce__(self) -> Any:
        """By its name: what numba writes into the key of a kernel that has it in a closure."""
        return str, (f"{self.py_func.__module__}.{self.py_func.__qualname__}",)

    @cached_property
    def for_kernels(self) -> Any:
        """What compiled callers see; not made where every caller comes from the cache."""
        return numba.njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **self.targetoptions)(self.py_func)

    @cached_property
    def _for_python(self) -> Any:
        return numba.njit(**{**self.targetoptions, **_COUNTED})(self.py_func)

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        return self._for_python(*arguments, **keywords)


@typeof_impl.register(Callee)
def _type_of_callee(callee: Callee, context: Any) -> Any:
    return typeof_impl(callee.for_kernels, context)


def _callee(**options: Any) -> Callable[[F], F]:
    """A decorator of functions that kernels call; it keeps their types."""

    def decorate(function: F) -> F:
        made: Any = function if config.DISABLE_JIT else Callee(function, _ARITHMETIC | options)
        return made

    return decorate


# A device is inlined into its callers and compiles together with them; a subroutine is not, where inlining only
# costs compile time. Neither makes arrays, and a subroutine that gives back some of those that it was given is not
# called by a kernel, which would let go of them. A maker is a subroutine that may make arrays; only kernels and
# other makers call one that gives them back.
device = _callee(forceinline=True, **_HELD)
subroutine = _callee(**_HELD)
maker = _callee(**_COUNTED)


class _Whole(JITCodeLibrary):  # type: ignore[misc]
    """Code of a kernel that carries all it calls, and takes nothing from elsewhere.

    By itself numba loads every compiled function under its name, and of each name the loader keeps the first. A
    kernel that is compiled in this process would then run the functions that it calls as they were compiled alone,
    but one from the cache those within itself, which were optimised once more with it: there products and sums
    that may be rounded together are paired in another way, and last digits differ between the first process and
    all later ones. So within a kernel what it calls has no name that the loader sees.
    """

    def _finalize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"
        super()._finalize_final_module()


class _KernelCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, but for the library into which it writes."""

    def compile_extra(self, function: Callable) -> Any:
        self.state.library = _Whole(self.state.targetctx.codegen(), function.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(function)


class _Place:
    """Where numba keeps the compiled code of a function: in our folder, wherever the source lies."""

    def __init__(self, function: Callable) -> None:
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: Callable, _source: str) -> "_Place":
        return cls(function)

    def ensure_cache_path(self) -> None:
        """It is there: `cache_folder` has made it."""

    def get_cache_path(self) -> str:
        return str(cache_folder())

    def get_source_stamp(self) -> str:
        return source_digest()

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Kept(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Place,)


class _Files(IndexDataCacheFile):  # type: ignore[misc]
    """Compiled code in files that end with their SHA-256: one wrong bit may give other numbers, or end Python."""

    def _dump(self, content: Any) -> bytes:
        data: bytes = super()._dump(content)  # what follows a pickle is not read as one
        return data + hashlib.sha256(data).digest()

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        if hashlib.sha256(data[:-32]).digest() != data[-32:]:
            raise ValueError("its checksum differs")
        return pickle.loads(data)


class _Cache(FunctionCache):  # type: ignore[misc]
    """numba's cache of one function, which takes from it without learning to compile first.

    By itself numba loads all that it can compile, and SciPy's linear algebra with it, before it looks whether
    there is anything to compile: 0.3 of the 0.9 s in which a command starts. Where it does compile, it does so
    then.
    """

    _impl_class = _Kept

    def __init__(self, function: Callable) -> None:
        super().__init__(function)
        self._cache_file = _Files(self.cache_path, self._impl.filename_base, source_digest())

    def load_overload(self, signature: Any, context: Any) -> Any:
        rtsys.initialize(context)  # what kernels call of numba's own
        with self._guard_against_spurious_io_errors():
            return self._load_overload(signature, context)


def kernel(function: Callable[P, None]) -> "Kernel[P]":
    """Declare a public kernel; the annotations of its arguments are its signature, and it returns nothing."""
    made = Kernel(function)
    KERNELS[made.name] = made
    return made


class Kernel(Generic[P]):
    """A kernel compiled on its first call, or by :meth:`compile`, and cached on disk."""

    def __init__(self, function: Callable[P, None]) -> None:
        self.name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
        self.function = function
        self.__doc__ = function.__doc__
        self._compiled: Callable | None = None

    def __call__(self, *arguments: P.args, **keywords: P.kwargs) -> None:
        (self._compiled or self.compile())(*arguments, **keywords)

    @property
    def is_loaded(self) -> bool:
        """True where it is ready in this process."""
        return self._compiled is not None

    def compile(self) -> Callable:
        """Load the kernel from the cache or compile it. Thread-safe."""
        with _LOCK:
            if self._compiled is None:
                self._compiled = self._build()
            return self._compiled

    def _build(self) -> Callable:
        folder = None if config.DISABLE_JIT else cache_folder()
        try:
            return self._build_in(folder)
        except Exception as error:  # whatever is wrong with the cache; a real error comes again below
            if folder is None:
                raise
            said = f"compiled code of {self.name} in {folder} is damaged ({type(error).__name__}); compiling anew"
            warnings.warn(said, RuntimeWarning, stacklevel=3)
            for path in folder.rglob(f"*.{self.function.__name__}-*.nb*"):
                path.unlink(missing_ok=True)
            return self._build_in(folder)

    def _build_in(self, folder: Path | None) -> Callable:
        made: Any = numba.njit(pipeline_class=_KernelCompiler, nogil=True, **_ARITHMETIC)(self.function)
        if folder is not None:
            made._cache = _Cache(self.function)
        if not config.DISABLE_JIT:
            hints = get_type_hints(self.function, include_extras=True)
            made.compile(numba.void(*(numba_type(hints[name]) for name in hints if name != "return")))
            made.disable_compile()
        found: Callable = made
        return found


@cache
def source_digest() -> str:
    """SHA-256 (hex) of this package's source files and of the versions that compile them."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(
            path.relative_to(Path(__file__).parent).as_posix().encode() + b"\0" + path.read_bytes() + b"\0"
        )
    digest.update(f"{numba.__version__} {llvmlite.__version__} {sys.version_info[:2]}".encode())
    return digest.hexdigest()


@cache
def cache_folder() -> Path | None:
    """Where compiled code is kept, or None (with one warning) where no folder of the user's own can be written.

    ``NUMBA_CACHE_DIR`` wins if set, so that an administrator's choice is respected. Compiled code is a pickle,
    which runs as whoever loads it: nobody else may enter the folder.
    """
    folder = Path()
    try:
        folder = Path(os.environ.get("NUMBA_CACHE_DIR") or _user_cache()) / f"nearflat-{source_digest()[:16]}"
        folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()  # on Windows folders are private by the rights of the profile, which no mode shows
        if os.name == "posix" and (found.st_uid != os.geteuid() or found.st_mode & 0o077):
            raise PermissionError("it is not private to you")
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: no home folder is known
        where = f" in {folder}" if folder.name else ""
        fault = f"no cache for compiled code{where} ({getattr(error, 'strerror', None) or error})"
        warnings.warn(f"{fault}; set NUMBA_CACHE_DIR to a folder of your own", RuntimeWarning, stacklevel=2)
    return None


def cached_names() -> set[str]:
    """Kernels, by name, of which an earlier process left compiled code for this source and compiler."""
    folder = cache_folder()
    return set() if folder is None else {path.name.partition("-")[0] for path in folder.rglob("*.nbi")}


def _user_cache() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "nearflat"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "nearflat"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "nearflat"
