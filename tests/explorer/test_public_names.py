"""The public names: lazy, typed, and the same whatever was imported before."""

import ast
import pkgutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import pytest

import explorer as ex


def test_every_public_name_is_there_and_only_plot_is_a_module():
    assert {name for name in ex.__all__ if isinstance(getattr(ex, name), ModuleType)} == {"plot"}
    assert dir(ex) == sorted({*ex.__all__, "__version__"})
    with pytest.raises(AttributeError, match="no attribute 'passage'"):
        _ = ex.passage


def test_no_file_or_room_has_a_public_name_that_its_import_would_replace():
    """Importing `explorer.x` sets `x` on the package, so a function of that name would turn into a module.

    `plot` is meant as one; the package keeps `view` from it.
    """
    rooms = {module.name for module in pkgutil.iter_modules(ex.__path__)}
    assert rooms & set(ex.__all__) == {"plot", "view"}


@pytest.mark.parametrize(
    "first",
    [
        "import explorer.view.page",
        "import explorer.view",
        "from explorer.view.page import view",
        "import explorer; explorer.view; import explorer.view.assembly",
        "import explorer.commands.view",
        "from importlib import reload; import explorer; reload(explorer); import explorer.view.start",
    ],
)
def test_view_is_the_function_whatever_of_its_room_was_imported(first):
    code = (
        f"import inspect, sys\n{first}\nimport explorer as ex\nfrom explorer import view\n"
        "assert inspect.isfunction(ex.view) and view is ex.view is sys.modules['explorer.view.page'].view\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("order", ["", "[::-1]"], ids=["forwards", "backwards"])
def test_names_mean_the_same_in_whichever_order_they_are_touched(order):
    """Between them, both orders touch every name before and after every other."""
    code = (
        "import inspect\nfrom types import ModuleType\n"
        "import explorer as ex\n"
        f"for name in list(ex.__all__){order}:\n"
        "    getattr(ex, name)\n"
        "for name in ex.__all__:\n"
        "    value = getattr(ex, name)\n"
        "    assert isinstance(value, ModuleType) == (name == 'plot'), name\n"
        "    assert value.__name__ in (name, 'explorer.plot'), name\n"
        "assert inspect.isfunction(ex.view)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_importing_the_package_loads_nothing_heavy():
    code = "import sys, explorer; print(sorted({'numba', 'numpy', 'matplotlib', 'scipy'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(ex.__file__).read_text("utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.asname for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    seen |= {node.targets[0].id for node in block.body if isinstance(node, ast.Assign)}
    assert {name for name in seen if not name.startswith("_")} == set(ex.__all__)


def test_the_version_is_that_of_the_installed_package():
    assert ex.__version__ == version("nearflat")
