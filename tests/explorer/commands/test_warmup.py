"""`nearflat warmup`."""

from explorer.commands.main import main


def test_warmup_says_when_all_is_ready(capsys):
    assert main(["warmup", "--quiet"]) == 0
    capsys.readouterr()
    assert main(["warmup"]) == 0
    assert capsys.readouterr().out == "All kernels were ready.\n"
