"""What the README says can be typed."""

import re
import shlex
from pathlib import Path

import pytest

from explorer.commands.main import parser_of

ROOT = Path(__file__).parents[1]
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
    name, *words = shlex.split(line, comments=True)[1:]
    parser_of(name, words).parse_args(words)


def test_files_that_the_readme_names_are_there():
    named = set(re.findall(r"(?:src=\"|`)((?:results|docs)/[\w./-]+)", README)) - {"results/demo/"}
    assert named
    assert [name for name in named if not (ROOT / name).exists()] == []
