"""The demo says of its computations what they were."""

import pytest

from explorer.commands.demo import _STEPS, title_of
from explorer.scenes.registry import build_scene

_TITLES = {name: title for name, _, title in _STEPS}


@pytest.mark.parametrize(
    ("method", "says"),
    [("auto", "by quadrature."), ("quadrature", "by quadrature."), ("dopri5", "integrated with dopri5.")],
)
def test_the_title_of_the_falling_set_names_the_method_that_was_used(method, says):
    title = title_of(build_scene("falling-set", method=method), _TITLES["falling-set"])
    assert title.endswith(says)
    assert ("integrated" in title) == (method == "dopri5")
