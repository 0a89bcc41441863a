"""Names that are loaded on first use, of a package of one's own."""

import importlib
import pickle
import sys

import pytest

PACKAGE = """
from typing import TYPE_CHECKING
from explorer.lazy import make_lazy
if TYPE_CHECKING:
    from {name} import room as room
    from {name}.same import same as same
    from {name}.same import other as _hidden
__all__ = make_lazy(__name__, made=lambda: [3])
"""


@pytest.fixture
def package(tmp_path, monkeypatch):
    name = "of_a_test"
    (tmp_path / name / "room").mkdir(parents=True)
    (tmp_path / name / "__init__.py").write_text(PACKAGE.format(name=name))
    (tmp_path / name / "room" / "__init__.py").write_text("")
    (tmp_path / name / "same.py").write_text("def same(): return 1\ndef other(): return 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module(name)
    for loaded in [module for module in sys.modules if module.partition(".")[0] == name]:
        del sys.modules[loaded]


def test_a_name_is_loaded_when_it_is_asked_for_and_kept(package):
    assert package.__all__ == ["made", "room", "same"]
    assert dir(package) == package.__all__
    assert "of_a_test.same" not in sys.modules
    assert package.same() == 1
    assert package.made is package.made
    assert package.room is sys.modules["of_a_test.room"]
    with pytest.raises(AttributeError, match="'of_a_test' has no attribute 'other'"):
        _ = package.other


def test_a_file_does_not_take_the_place_of_the_function_of_its_name(package):
    importlib.import_module("of_a_test.same")
    assert package.same() == 1
    assert importlib.reload(package).same() == 1


def test_such_a_package_is_packed_by_its_name(package):
    assert pickle.loads(pickle.dumps(package)) is package
