"""`nearflat paper`: what it prints, what it leaves, and the status it exits with."""

import json

import pytest

from explorer.commands.main import main
from explorer.paper import pages
from explorer.paper.statement import STATEMENTS, Finding, Statement


@pytest.fixture
def toy_statements(monkeypatch):
    """Two quick statements in place of the paper's: one holds, the other does not."""
    good = Finding("a number", 1.0, 1.0, 0.0, 1e-9, "rounding")
    bad = Finding("another", 2.0, 1.0, 1.0, 1e-9, "rounding")
    rows = [Statement(40, "RIGHT", "It holds.", lambda: iter([good]))]
    rows.append(Statement(41, "WRONG", "It does not.", lambda: iter([good, bad])))
    assert pages.SECTIONS  # whose statements are registered, so that nothing adds them later
    for number in list(STATEMENTS):
        monkeypatch.delitem(STATEMENTS, number)
    for row in rows:
        monkeypatch.setitem(STATEMENTS, row.number, row)


@pytest.mark.parametrize(("only", "status"), [("RIGHT", 0), ("41", 1)])
@pytest.mark.usefixtures("toy_statements")
def test_the_status_says_whether_a_statement_holds(only, status, capsys):
    assert main(["paper", "--only", only, "--quiet"]) == status
    printed = capsys.readouterr()
    assert f"{1 - status} of 1 statements hold." in printed.out
    assert printed.err == ""


@pytest.mark.usefixtures("toy_statements")
def test_a_failing_statement_is_shown_with_its_numbers(capsys):
    main(["paper", "--only", "WRONG", "--quiet"])
    out = capsys.readouterr().out
    assert "41 WRONG: It does not." in out
    assert "41 WRONG FAILS: It does not." in out
    assert out.count("another: 2, expected 1 (compared 1.0e+00, at most 1.0e-09)") == 2


@pytest.mark.usefixtures("toy_statements")
def test_json_prints_one_object_with_every_finding(capsys):
    assert main(["paper", "--only", "WRONG", "--json", "--quiet"]) == 1
    printed = json.loads(capsys.readouterr().out)
    assert (printed["holding"], printed["failing"]) == (0, 1)
    assert [finding["verdict"] for finding in printed["rows"][0]["findings"]] == ["holds", "FAILS"]


def test_an_unknown_statement_is_refused_with_the_nearest_name(capsys):
    assert main(["paper", "--only", "LEMA-5"]) == 2
    assert "did you mean 'LEMMA-5'?" in capsys.readouterr().err


def test_one_statement_writes_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["paper", "--only", "LEMMA-5", "--quiet"]) == 0
    assert "LEMMA-5" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ([], {"figure-8.png", "figure-8.svg"}),
        (
            ["--disk", "annulus:0.4", "--eta-hat", "-3e-3"],
            {"figure-8-annulus-0.4-0.003.png", "figure-8-annulus-0.4-0.003.svg"},
        ),
    ],
)
def test_one_figure_is_written_for_any_body_and_distance(options, names, tmp_path, capsys):
    assert main(["paper", "--figure", "8", "--out", str(tmp_path), *options]) == 0
    assert {path.name for path in (tmp_path / "figures").iterdir()} == names
    printed = capsys.readouterr().out
    assert all(name in printed for name in names)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--figure", "10"], "figure = 10"),
        (["--figure", "8", "--only", "LEMMA-5"], "give one of them"),
        (["--disk", "hoop"], "only with a figure"),
    ],
)
def test_figures_that_cannot_be_drawn_are_refused_in_a_sentence(options, says, tmp_path, capsys):
    assert main(["paper", "--out", str(tmp_path), *options]) == 2
    assert says in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
