"""What is to be cited."""

import json
import re
from importlib import metadata
from pathlib import Path

import explorer as ex
from explorer.commands.main import main

CFF = (Path(__file__).parents[3] / "CITATION.cff").read_text("utf-8")


def test_bibtex_and_the_citation_file_name_the_same_paper():
    (number,) = re.findall(r"^\s+volume: (\d+)", CFF, flags=re.MULTILINE)
    (title,) = re.findall(r"^\s+title: (.+)", CFF, flags=re.MULTILINE)
    (year,) = re.findall(r"^\s+year: (\d+)", CFF, flags=re.MULTILINE)
    assert all(f"{{{value}}}" in ex.cite() for value in (number, title, year))
    assert f"version = {{{metadata.version('nearflat')}}}" in ex.cite()


def test_the_command_prints_what_the_function_returns(capsys):
    assert main(["cite"]) == 0
    assert capsys.readouterr().out == ex.cite() + "\n"


def test_as_json_both_entries_have_their_keys(capsys):
    assert main(["cite", "--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)) == {"nearflat", "CushmanDuistermaat2006"}
