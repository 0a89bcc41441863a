"""A finished run that every test here may spoil: computed once, copied for each."""

import shutil

import pytest
from small_runs import SMALL_RACES

import explorer as ex


@pytest.fixture(scope="session")
def computed_once(tmp_path_factory):
    return ex.run("race-angles", out=tmp_path_factory.mktemp("races") / "run", jobs=2, **SMALL_RACES)


@pytest.fixture
def finished(computed_once, tmp_path):
    return ex.open(shutil.copytree(computed_once.folder, tmp_path / "run"))
