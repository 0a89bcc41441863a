"""Versions of packages, and what callers say of a package that is not installed."""

from importlib.metadata import version

import numpy as np
import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.version import installed_version


def test_it_is_the_version_that_the_package_itself_tells():
    assert installed_version("numpy") == np.__version__
    assert installed_version() == version("nearflat")


def test_a_package_that_is_not_there_has_none():
    assert installed_version("there-is-no-such-package") is None


def test_every_caller_names_the_version_or_says_that_there_is_none(monkeypatch, capsys):
    told = f"nearflat {ex.__version__}\n"
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == told
    assert f"version = {{{ex.__version__}}}" in ex.cite()
    for home in ("commands.main", "commands.cite"):
        monkeypatch.setattr(f"explorer.{home}.installed_version", lambda: None)
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == "nearflat (not installed)\n"
    assert "version = {not installed}" in ex.cite()
