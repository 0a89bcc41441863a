"""Shared settings of the suite."""

import json
import os
from pathlib import Path

import pytest
from hypothesis import settings

import explorer as ex

settings.register_profile("nearflat", deadline=None, max_examples=40, derandomize=bool(os.environ.get("CI")))
settings.load_profile("nearflat")

BODIES = {
    "uniform": ex.Disk.uniform(),
    "hoop": ex.Disk.hoop(),
    "matching": ex.Disk.matching(),
    "heavy-core": ex.Disk(I1=0.02, I3=0.04, name="heavy-core"),
    "thick": ex.Disk(I1=0.5, I3=0.3, name="thick"),
    "coin": ex.Disk.uniform(m=0.0057, r=0.0121, g=9.81),
}


@pytest.fixture(params=BODIES, scope="session")
def body(request):
    """Flat and thick bodies, small and large kappa, natural and SI units."""
    return BODIES[request.param]


@pytest.fixture(params=["uniform", "hoop", "matching"], scope="session")
def paper_body(request):
    """The bodies of the paper's statements."""
    return BODIES[request.param]


@pytest.fixture(scope="session")
def reference_passages():
    """Passages in 25 digits; a copy of the file the mathematics was checked with."""
    text = (Path(__file__).parent / "reference" / "passages.json").read_text(encoding="utf-8")
    rows = json.loads(text)
    return [{k: float(v) if k != "disk" else v for k, v in row.items()} for row in rows]


def computed(scene):
    """All chunks of a scene, as a stored run would give them."""
    from explorer.scenes.base import Chunks

    tables = [scene.compute(index) for index in range(scene.chunks())]
    return Chunks(
        tallies=lambda: (json.loads(json.dumps(scene.tally(table))) for table in tables),
        tables=lambda: (scene.kept(table) for table in tables),
    )
