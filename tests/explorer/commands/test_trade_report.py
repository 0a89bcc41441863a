"""The report of a trade: its tables hold every row, in words that say what was measured."""

from explorer.commands import trade_report


def test_the_page_says_what_was_measured_and_by_which_command(traded, tmp_path):
    trade_report.write(traded.scene, traded.parts, tmp_path, "nearflat trade race-angles", None)
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "Made by `nearflat trade race-angles`" in page
    assert page.count("\n## ") == 2
    assert "Stored for this machine" not in page
    assert (tmp_path / "trade.png").exists()
    assert str(traded) in page
    assert repr(traded) == "Trade of race-angles, hoop: 300 passages, 64 motions; print it for its tables"
