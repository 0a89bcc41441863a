"""The house rules that a machine can check: rooms, sizes, the door, mirrors, linters."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest
from imports import PACKAGES, ROOT, arrows, circles, imports, sources, tree, unreadable
from typed_calls import BOTH

# The rooms of each package, ground first. A file imports from its own room and from rows below, never from its own
# row's other rooms and never from above: also inside functions, also for types only.
EXPLORER = """
    errors compiled lazy version
    phase
    motion
    measure
    portrait
    plot
    scenes paper view
    runs
    commands
    __init__
"""
KERNELS = """
    _jit status types
    disk
    steps integrals
    __init__
"""
LEVELS = {
    package: [row.split() for row in order.split("\n") if row.strip()]
    for package, order in (("explorer", EXPLORER), ("kernels", KERNELS))
}
MODULES = [module for package in PACKAGES for module in sources(package)]
TESTS = sorted((ROOT / "tests").rglob("*.py"))


def path_of(module):
    return sources(module.partition(".")[0])[module]


def room(module):
    """`explorer.plot.maps` is in `plot`, `explorer.errors` in `errors`, `explorer` itself in `__init__`."""
    return [*module.split("."), "__init__"][1]


def level(module):
    (row,) = (row for row, rooms in enumerate(LEVELS[module.partition(".")[0]]) if room(module) in rooms)
    return row


@pytest.mark.parametrize("package", PACKAGES)
def test_every_room_has_its_place_in_the_order(package):
    rooms = [room for row in LEVELS[package] for room in row]
    assert sorted(rooms) == sorted({room(module) for module in sources(package)})
    assert len(LEVELS[package]) <= {"explorer": 10, "kernels": 4}[package]


def test_no_file_imports_from_a_room_above_or_beside():
    wrong = [
        f"{module} imports {other}"
        for package in PACKAGES
        for module, others in arrows(package).items()
        for other in others
        if room(other) != room(module) and level(other) >= level(module)
    ]
    assert not wrong


def test_no_files_import_each_other_in_a_circle():
    found = [" ".join(group) for package in PACKAGES for group in circles(arrows(package))]
    assert not found


def test_circles_are_found_where_they_are():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set(), "e": {"f"}, "f": {"g"}, "g": {"e", "a"}}
    assert sorted(circles(graph)) == [["b", "c"], ["e", "f", "g"]]


def test_imports_can_be_followed_by_tools():
    """Only lazy names and the door compute what they import, and all list it for type checkers."""
    allowed = {"explorer.compiled", "explorer.lazy"}
    found = {module for module in MODULES if unreadable(path_of(module))} - allowed
    assert not found


def test_the_compiled_layer_imports_only_numbers():
    allowed = set(sys.stdlib_module_names) | {"kernels", "numpy", "numba", "llvmlite"}
    forbidden = {"os", "sys", "io", "pathlib", "random", "logging", "warnings", "subprocess", "tempfile"}
    for module, path in sources("kernels").items():
        names = {name.partition(".")[0] for name in imports(path)}
        assert names <= allowed, module
        assert module == "kernels._jit" or not names & forbidden, module


def test_only_one_module_opens_the_door_to_the_compiled_layer():
    for module, path in sources("explorer").items():
        names = {name.partition(".")[0] for name in imports(path)}
        assert module == "explorer.compiled" or not names & {"kernels", "numba"}, module


def test_scenes_read_nothing_but_statuses_through_the_door():
    """A scene says what it asks; which kernel answers is decided in `motion.plan`."""
    for module in sources("explorer"):
        if room(module) == "scenes":
            assert behind_the_door(tree(path_of(module))) <= {"status"}, module


def test_what_is_read_through_the_door_is_found():
    made = "from explorer import compiled\nfrom explorer.compiled import batch\nx = compiled.orbits.tilt_batch\n"
    assert behind_the_door(ast.parse(made)) == {"batch", "orbits"}


def behind_the_door(module):
    """Modules of `kernels` that a file names, however it names them."""
    nodes = list(ast.walk(module))
    named = [
        node.attr for node in nodes if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "compiled"
    ]
    taken = [node for node in nodes if isinstance(node, ast.ImportFrom) and node.module == "explorer.compiled"]
    return {*named, *(name.name for node in taken for name in node.names)}


def functions(module):
    for node in ast.walk(tree(path_of(module))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield f"{module}.{node.name}", node


def arguments(function):
    """How many arguments a function takes; `self` is not counted, `*args` and `**kwargs` are one each."""
    a = function.args
    names = [arg.arg for arg in [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]]
    return len([name for name in names if name not in ("self", "cls")])


def test_no_function_takes_more_than_seven_arguments():
    """More of them travel together as a NamedTuple with a name from the field."""
    wrong = [name for module in MODULES for name, function in functions(module) if arguments(function) > 7]
    assert not wrong


def test_no_function_is_longer_than_sixty_lines():
    wrong = [
        name
        for module in MODULES
        for name, function in functions(module)
        if function.end_lineno - function.lineno + 1 > 60
    ]
    assert not wrong


def test_no_file_is_longer_than_four_hundred_lines():
    paths = [*(path_of(module) for module in MODULES), *TESTS]
    wrong = [str(path.relative_to(ROOT)) for path in paths if len(path.read_text("utf-8").splitlines()) > 400]
    assert not wrong


def test_every_module_says_what_it_is():
    paths = [*(path_of(module) for module in MODULES), *TESTS]
    silent = [str(path.relative_to(ROOT)) for path in paths if not ast.get_docstring(tree(path))]
    assert not silent


def home_of_tests(module):
    """`explorer.phase.disk` is tested in `tests/explorer/phase/test_disk.py`, `kernels._jit` in `test_jit.py`."""
    path = path_of(module).relative_to(ROOT)
    return Path("tests", path.parent, f"test_{path.name.lstrip('_')}").as_posix()


def test_tests_mirror_the_tree():
    files = {path.relative_to(ROOT).as_posix() for path in TESTS}
    homes = {home_of_tests(module) for module in MODULES if path_of(module).name != "__init__.py"}
    assert not homes - files


@pytest.mark.parametrize("command", [["ruff", "check"], ["ruff", "format", "--check"]], ids=" ".join)
def test_the_linters_are_content(command):
    done = subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mypy_is_content(mypy_says):
    assert not mypy_says[BOTH]


def test_help_loads_neither_the_compiler_nor_the_plotting():
    code = (
        "import sys, contextlib, io\n"
        "from explorer.commands.main import main\n"
        "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()): main(['--help'])\n"
        "print(sorted({'numba', 'matplotlib', 'numpy', 'pyarrow', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_both_packages_say_that_they_are_typed():
    assert all((ROOT / package / "py.typed").is_file() for package in PACKAGES)


SCRIPTS = [path for path in TESTS if not path.name.startswith("test_")]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_scripts_beside_the_tests_import_what_is_there(path):
    """Nothing runs them in the suite; some have the code of another process as text."""
    lines = re.findall(r"^ *from ((?:explorer|kernels)[\w.]*) import (.+)$", path.read_text("utf-8"), re.MULTILINE)
    for module, names in lines:
        for name in re.findall(r"(?:^|, )(\w+)", names):
            defined = re.search(
                rf"^(def |class |(\w+, )*){name}\b", path_of(module).read_text("utf-8"), re.MULTILINE
            )
            assert defined or f"{module}.{name}" in MODULES, f"{module}.{name}"
