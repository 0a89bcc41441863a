"""The public names: lazy, typed, and the same whatever was imported before."""

import ast
import subprocess
import sys
from importlib import resources
from pathlib import Path
from types import ModuleType

import pytest

import explorer as ex

HEAVY = {"numba", "numpy", "matplotlib", "scipy", "pyarrow"}
HELP = """
import contextlib
from explorer.commands.main import main
with contextlib.suppress(SystemExit):
    main(["--help"])
"""


def test_every_public_name_is_there_and_none_is_a_module():
    assert not [name for name in ex.__all__ if isinstance(getattr(ex, name), ModuleType)]
    assert dir(ex) == sorted({*ex.__all__, "__version__"})
    with pytest.raises(AttributeError, match="no attribute 'passage'"):
        _ = ex.passage


@pytest.mark.parametrize(
    "first",
    [
        "import explorer.view.page",
        "import explorer.view",
        "from explorer.view.page import view",
        "import explorer; explorer.view; import explorer.view.assembly",
        "import explorer.commands.view",
        "import explorer.pictures; import explorer.pictures.calls",
        "from importlib import reload; import explorer; reload(explorer); import explorer.view.start",
    ],
)
def test_view_and_pictures_are_no_rooms_whatever_of_them_was_imported(first):
    code = (
        f"import inspect, sys\n{first}\nimport explorer as ex\nfrom explorer import pictures, view\n"
        "assert inspect.isfunction(ex.view) and view is ex.view is sys.modules['explorer.view.page'].view\n"
        "assert pictures is ex.pictures and 'rotation' in pictures\n"
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
        "    assert not isinstance(value, ModuleType), name\n"
        "    assert name == 'pictures' or value.__name__ == name, name\n"
        "assert inspect.isfunction(ex.view)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("action", ["import explorer", HELP], ids=["import", "help"])
def test_the_package_and_help_load_nothing_heavy(action):
    code = f"import sys\n{action}\nprint(sorted({HEAVY} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("[]\n")


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(ex.__file__).read_text("utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.asname for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    seen |= {node.targets[0].id for node in block.body if isinstance(node, ast.Assign)}
    assert {name for name in seen if not name.startswith("_")} == set(ex.__all__)
    assert all(resources.files(package).joinpath("py.typed").is_file() for package in ("explorer", "kernels"))
