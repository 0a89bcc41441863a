"""Progress: plain lines where stderr is no terminal, and nothing when quiet."""

from explorer.runs import progress


def test_lines_say_how_far_how_fast_and_what_failed(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_SECONDS_BETWEEN_LINES", -1.0)
    shown = progress.Progress(4, "race-angles", quiet=False)
    shown.already(1)
    shown.advance({"ok": 90, "unresolved_side": 10})
    shown.close()
    line = capsys.readouterr().err
    assert line.startswith("race-angles: 2 of 4 chunks, ")
    assert line.rstrip().endswith(" s left; 10 unresolved_side")


def test_lines_are_seconds_apart(capsys):
    shown = progress.Progress(100, "race-angles", quiet=False)
    for _ in range(50):
        shown.advance({"ok": 1})
    assert capsys.readouterr().err == ""


def test_quiet_says_nothing(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_SECONDS_BETWEEN_LINES", -1.0)
    shown = progress.Progress(2, "race-angles", quiet=True)
    shown.advance({"ok": 1})
    shown.close()
    assert capsys.readouterr().err == ""


def test_lines_are_left_where_the_environment_spoils_the_bar(monkeypatch):
    """As TQDM_NCOLS=x does."""
    monkeypatch.setattr("tqdm.auto.tqdm", lambda **named: int("x"))
    monkeypatch.setattr(progress, "in_notebook", lambda: True)
    shown = progress.Progress(3, "races", quiet=False)
    shown.already(1)
    shown.drawn()
    assert shown._bar is None
