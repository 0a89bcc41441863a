"""Packages whose public names are loaded on first use; each name stands once, where type checkers look for it."""

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any


def make_lazy(name: str) -> list[str]:
    """Load names that package `name` imports under `if TYPE_CHECKING` when asked for. Returns its `__all__`."""
    package = sys.modules[name]
    assert package.__file__ is not None
    homes = _homes_in(Path(package.__file__))
    vars(package).update(_homes=homes)
    package.__class__ = _Package
    return sorted(each for each in homes if not each.startswith("_"))


def _homes_in(path: Path) -> dict[str, str]:
    """Every name that is imported for types, with the module it comes from."""
    block = next(node for node in ast.parse(path.read_text("utf-8")).body if isinstance(node, ast.If))
    return {
        alias.name: str(node.module)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname == alias.name
    }


class _Package(ModuleType):
    """A package of which no file or folder takes the place of the function of its name when it is imported.

    The import system sets each of them on its package as an attribute; without one, `__getattr__` is asked.
    """

    _homes: dict[str, str]

    def __getattr__(self, name: str) -> Any:
        own = vars(self)
        if name not in own["_homes"]:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        value = own[name] = getattr(import_module(own["_homes"][name]), name)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in vars(self)["_homes"] or not isinstance(value, ModuleType):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        """The public names, without files and folders."""
        return list(vars(self)["_homes"])

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        """Packed by its name, like any module, for code of a user that travels to other processes."""
        return import_module, (self.__name__,)
