"""Who imports whom: the sources of both packages, read and not run."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("explorer", "kernels")


@cache
def sources(package: str) -> dict[str, Path]:
    """Every module of a package by its dotted name; `explorer.plot` is the file `explorer/plot/__init__.py`."""
    found = {}
    for path in sorted(ROOT.glob(f"{package}/**/*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path: Path) -> Iterator[str]:
    """Dotted names of what a file imports: at its top, inside functions, and for types only."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f"{path}: relative imports are not used"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and _imports(node) and isinstance(node.args[0], ast.Constant):
            yield str(node.args[0].value)


def unreadable(path: Path) -> list[str]:
    """Imports whose target is computed when the program runs, which no tool can follow."""
    calls = (node for node in ast.walk(tree(path)) if isinstance(node, ast.Call) and _imports(node))
    return [ast.unparse(call) for call in calls if not isinstance(call.args[0], ast.Constant)]


def _imports(call: ast.Call) -> bool:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    return name in ("import_module", "__import__")


@cache
def arrows(package: str) -> dict[str, frozenset[str]]:
    """For every module, the modules of the same package that it imports."""
    modules = sources(package)

    def module_of(name: str) -> str | None:
        # `from explorer.phase.disk import Disk` names the module explorer.phase.disk.
        return name if name in modules else module_of(name.rpartition(".")[0]) if "." in name else None

    return {
        module: frozenset(filter(None, map(module_of, imports(path)))) - {module}
        for module, path in modules.items()
    }


def circles(graph: dict[str, frozenset[str]]) -> list[list[str]]:
    """Groups of two modules or more that reach each other: strongly connected components, after Tarjan."""
    number: dict[str, int] = {}
    lowest: dict[str, int] = {}
    waiting: list[str] = []
    found = []

    def visit(module: str) -> None:
        number[module] = lowest[module] = len(number)
        waiting.append(module)
        for other in graph[module]:
            if other not in number:
                visit(other)
                lowest[module] = min(lowest[module], lowest[other])
            elif other in waiting:
                lowest[module] = min(lowest[module], number[other])
        if lowest[module] == number[module]:
            start = waiting.index(module)
            group, waiting[start:] = waiting[start:], []
            if len(group) > 1:
                found.append(sorted(group))

    for module in graph:
        if module not in number:
            visit(module)
    return found
