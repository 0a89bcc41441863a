"""`nearflat view`."""

import json
import webbrowser

from explorer.commands.main import main


def test_the_page_is_written_and_opened(tmp_path, capsys, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    where = tmp_path / "page.html"
    arguments = ["view", "--disk", "hoop", "--eta-hat", "-1e-12", "--face", "-1", "--out", str(where), "--open"]
    assert main(arguments) == 0
    assert '"eta_hat": -1e-12' in where.read_text("utf-8")
    assert opened == [where.as_uri()]
    assert str(where) in capsys.readouterr().out


def test_json_is_all_that_is_printed(tmp_path, capsys):
    where = tmp_path / "page.html"
    assert main(["view", "--out", str(where), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == {"page": str(where), "bytes": where.stat().st_size, "disk": "uniform"}


def test_arguments_that_cannot_be_used_are_named(capsys):
    assert main(["view", "--eta-hat", "0"]) == 2
    assert "eta_hat = 0" in capsys.readouterr().err
