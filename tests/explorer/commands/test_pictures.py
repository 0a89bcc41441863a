"""Pictures that explain: each is one command."""

import pytest

import explorer as ex
from explorer.commands import pictures
from explorer.plot.captions import caption_of

HOOP = ex.Disk.hoop()


@pytest.mark.parametrize("name", ["hero", "definitions", "limit", "surface"])
def test_each_group_draws_pictures_with_captions(name):
    for stem, figure in getattr(pictures, name)(HOOP, {}):
        assert stem
        assert caption_of(figure) is not None
