"""The house rules that a machine can check."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted([*ROOT.glob("explorer/**/*.py"), *ROOT.glob("kernels/**/*.py")])
README = (ROOT / "README.md").read_text(encoding="utf-8")


def imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


@pytest.mark.parametrize("path", sorted(ROOT.glob("kernels/**/*.py")), ids=lambda p: str(p.relative_to(ROOT)))
def test_the_compiled_layer_imports_only_numbers(path):
    allowed = set(sys.stdlib_module_names) | {"kernels", "numpy", "numba", "llvmlite"}
    assert set(imported(path)) <= allowed
    if path.name != "_jit.py":
        forbidden = {"os", "sys", "io", "pathlib", "random", "logging", "warnings", "subprocess", "tempfile"}
        assert not set(imported(path)) & forbidden


@pytest.mark.parametrize("path", sorted(ROOT.glob("explorer/**/*.py")), ids=lambda p: str(p.relative_to(ROOT)))
def test_only_one_module_opens_the_door_to_the_compiled_layer(path):
    if path.name != "compiled.py":
        assert "kernels" not in set(imported(path))
        assert "numba" not in set(imported(path))


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_files_and_functions_stay_small(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 400
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno - node.lineno < 75, node.name


def test_no_scene_names_a_kernel():
    for path in ROOT.glob("explorer/scenes/*.py"):
        text = path.read_text(encoding="utf-8")
        assert "compiled.batch" not in text
        assert "compiled.trajectory" not in text


@pytest.mark.parametrize("command", [["ruff", "check"], ["ruff", "format", "--check"], ["mypy"]], ids=" ".join)
def test_the_linters_are_content(command):
    done = subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_help_loads_neither_the_compiler_nor_the_plotting():
    code = (
        "import sys, contextlib, io\n"
        "from explorer.commands.main import main\n"
        "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()): main(['--help'])\n"
        "print(sorted({'numba', 'matplotlib', 'numpy', 'pyarrow', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_readme_has_the_two_lines_and_ci_runs_the_second():
    lines = re.findall(r"^python3 -m venv .*$", README, flags=re.MULTILINE)
    assert len(lines) == 2
    assert lines[0].endswith(".venv/bin/nearflat demo")
    assert lines[1].endswith(".venv/bin/python -m pytest")
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "python -m pytest$" in ci
    assert "README.md" in ci
