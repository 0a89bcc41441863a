"""Versions of packages."""

from importlib.metadata import version

import numpy as np

import explorer as ex
from explorer.version import installed_version


def test_it_is_the_version_that_the_package_itself_tells():
    assert installed_version("numpy") == np.__version__
    assert installed_version() == version("nearflat") == ex.__version__


def test_a_package_that_is_not_there_has_none():
    assert installed_version("there-is-no-such-package") is None
