"""The command as a user calls it."""

from explorer.commands.main import main


def said(capsys, *words):
    """Exit status of `nearflat`, and what it wrote to stdout and stderr."""
    try:
        status = main([str(word) for word in words])
    except SystemExit as stop:
        status = stop.code
    captured = capsys.readouterr()
    return status, captured.out, captured.err
