"""What a plain install brings, without any extra."""

import ast
import importlib.metadata
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from explorer.commands.demo import Demo

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs" / "tutorials").glob("*.md"))]
# Frames and data frames are made with it: no block imports it by name.
BEHIND = {"pandas"}


def imported(source):
    """Names of the packages that a text of Python imports."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield str(node.module).partition(".")[0]


def code_of(page):
    """The Python of a page; of a block with prompts what stands behind them."""
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL):
        typed = re.findall(r"^(?:>>>|\.\.\.) ?(.*)$", block, flags=re.MULTILINE)
        yield "\n".join(typed) if typed else block


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_plain_install_runs_the_readme_and_the_tutorials(page):
    """Other tests run the blocks with every tool of the tests there: this one asks what they need."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    required = {re.split(r"[^\w-]", line)[0] for line in project["dependencies"]}
    brought = {
        name for name, homes in importlib.metadata.packages_distributions().items() if required & set(homes)
    }
    needed = {name for code in code_of(page) for name in imported(code)} | BEHIND
    assert needed - {"explorer"} - set(sys.stdlib_module_names) <= brought


def test_a_demo_writes_where_git_does_not_look():
    if not (ROOT / ".git").exists():
        pytest.skip("only a clone knows what git ignores")
    folder = Demo().out
    told = subprocess.run(
        ["git", "-C", ROOT, "check-ignore", f"{folder}/README.md"], capture_output=True, text=True
    )
    assert told.stdout.strip() == f"{folder}/README.md"
    tracked = subprocess.run(["git", "-C", ROOT, "ls-files", folder], capture_output=True, text=True, check=True)
    assert not tracked.stdout


ONE_PACKAGE = "import nearflat, explorer; assert nearflat is explorer; print(nearflat.Disk.uniform().kappa)"


def test_nearflat_is_imported_by_its_own_name_where_it_is_edited(tmp_path):
    said = subprocess.run([sys.executable, "-c", ONE_PACKAGE], cwd=tmp_path, capture_output=True, text=True)
    assert (said.stdout, said.stderr) == (f"{5**0.5}\n", "")


def test_nearflat_is_imported_by_its_own_name_from_a_wheel(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", tmp_path]
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(tmp_path / "site")
    # Packages of the path come before those that are installed.
    said = subprocess.run(
        [sys.executable, "-c", f"{ONE_PACKAGE}; print(nearflat.__file__)"],
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert said.stderr == ""
    assert said.stdout.split() == [str(5**0.5), str(tmp_path / "site" / "explorer" / "__init__.py")]
