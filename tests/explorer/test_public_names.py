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


ORDERS = """
import importlib, inspect, sys
from types import ModuleType

FIRST = (
    "import explorer.view.page",
    "import explorer.view",
    "from explorer.view.page import view",
    "import explorer; explorer.view; import explorer.view.assembly",
    "import explorer.commands.view",
    "import explorer.pictures; import explorer.pictures.calls",
    "import explorer; importlib.reload(explorer); import explorer.view.start",
    "import explorer; [getattr(explorer, name) for name in explorer.__all__]",
    "import explorer; [getattr(explorer, name) for name in explorer.__all__[::-1]]",
)
for first in FIRST:
    for name in [name for name in sys.modules if name.partition(".")[0] == "explorer"]:
        del sys.modules[name]
    exec(first, {"importlib": importlib})
    import explorer as ex
    from explorer import pictures, view

    assert inspect.isfunction(ex.view) and view is ex.view is sys.modules["explorer.view.page"].view, first
    assert pictures is ex.pictures and "rotation" in pictures, first
    for name in ex.__all__ if "__all__" in first else ():
        value = getattr(ex, name)
        assert not isinstance(value, ModuleType), (first, name)
        assert name == "pictures" or value.__name__ == name, (first, name)
"""


def test_names_mean_the_same_whatever_was_imported_or_touched_before():
    """`view` and `pictures` are folders too; forwards and backwards every name comes before every other."""
    done = subprocess.run([sys.executable, "-c", ORDERS], capture_output=True, text=True, check=False)
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
