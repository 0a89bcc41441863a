"""A finished run that every test here may spoil: computed once, copied for each."""

import shutil

import pytest
from coins import SMALL, Coins

import explorer as ex


@pytest.fixture(scope="session")
def computed_once(tmp_path_factory):
    return ex.run(Coins, out=tmp_path_factory.mktemp("coins") / "run", **SMALL)


@pytest.fixture
def finished(computed_once, tmp_path):
    return ex.open(shutil.copytree(computed_once.folder, tmp_path / "run"))
