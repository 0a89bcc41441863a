"""The report of a trade: its tables hold every row, in words that say what was measured."""

from explorer.commands import trade_report
from explorer.motion.trade import ASKED, GRADES, SETTINGS


def test_every_setting_has_its_row_and_every_accuracy_its_column(traded):
    passages, motions = traded.parts
    lines = trade_report.by_setting(passages)
    assert len(lines) == 2 + len(GRADES) + sum(map(len, SETTINGS.values()))
    assert "ns per passage" in lines[0]
    asked = trade_report.by_accuracy(motions.asked)
    assert asked[0].count("|") == 2 + len(ASKED)
    assert [line.split("|")[1].strip() for line in asked[2:]] == list(SETTINGS)


def test_an_accuracy_that_a_method_cannot_hold_has_no_number(traded):
    rows = [row for row in traded.parts[0].asked if (row.method, row.setting) != ("rk4", ASKED[-1])]
    assert "| - |" in next(line for line in trade_report.by_accuracy(rows) if line.startswith("| rk4"))


def test_the_page_says_what_was_measured_and_by_which_command(traded, tmp_path):
    trade_report.write(traded.scene, traded.parts, tmp_path, "nearflat trade race-angles", None)
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "Made by `nearflat trade race-angles`" in page
    assert page.count("\n## ") == 2
    assert "Stored for this machine" not in page
    assert (tmp_path / "trade.png").exists()
    assert str(traded) in page
    assert repr(traded) == "Trade of race-angles, hoop: 300 passages, 64 motions; print it for its tables"
