"""What the README says can be typed."""

import re
import shlex

import pytest
from imports import ROOT

from explorer.commands.main import _parser

README = (ROOT / "README.md").read_text("utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
COMMANDS = [
    line for kind, block in BLOCKS if kind == "sh" for line in block.splitlines() if line.startswith("nearflat ")
]


def test_the_readme_has_the_two_lines_and_ci_runs_the_second():
    lines = re.findall(r"^python3 -m venv .*$", README, flags=re.MULTILINE)
    assert len(lines) == 2
    assert lines[0].endswith(".venv/bin/nearflat demo")
    assert lines[1].endswith(".venv/bin/python -m pytest")
    ci = (ROOT / ".ci" / "run").read_text("utf-8")
    assert "python -m pytest$" in ci
    assert "README.md" in ci


@pytest.mark.parametrize("line", COMMANDS)
def test_every_command_of_the_readme_has_options_that_exist(line):
    _parser().parse_args(shlex.split(line, comments=True)[1:])


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = (block for kind, block in BLOCKS if kind == "python" and "import explorer as ex" in block)
    names = {}
    exec(compile(block.replace("samples=100_000", "samples=1000"), "README.md", "exec"), names)
    assert names["run"].summary["samples"] == 1000
