"""Shared settings of the suite."""

import gc
import json
import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from matplotlib.figure import Figure
from PIL import Image
from reference.motions import MOTIONS, PASSAGES
from wandering import resonant_and_paths

import explorer as ex
from explorer import compiled
from explorer.commands.calls import trade

# The same examples each time, so that a change that breaks nothing fails nowhere; `nox -s fuzz` tries others. How
# long it takes to make them says something of the machine only.
_COMMON = {"deadline": None, "max_examples": 40, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("suite", **_COMMON, derandomize=True)
settings.register_profile("fuzz", **_COMMON)
settings.load_profile("fuzz" if "NEARFLAT_EXAMPLES" in os.environ else "suite")

BODIES = {
    "uniform": ex.Disk.uniform(),
    "hoop": ex.Disk.hoop(),
    "matching": ex.Disk.matching(),
    "heavy-core": ex.Disk(I1=0.02, I3=0.04, name="heavy-core"),
    "thick": ex.Disk(I1=0.5, I3=0.3, name="thick"),
    "coin": ex.Disk.uniform(m=0.0057, r=0.0121, g=9.81),
}


# Objects after which Python looks for garbage. Modules and collected tests are half a million that stay: to look
# through them again and again is a tenth of the suite's time.
_COLLECTED = 50_000


def pytest_configure():
    gc.set_threshold(_COLLECTED)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Long tests begin first, all in one process: none is what the other waits for, or does a second time."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


def pytest_collection_finish():
    gc.freeze()


def pytest_sessionstart(session):
    """Compile the kernels before workers start, who would all compile the same ones."""
    workers = getattr(session.config.option, "numprocesses", None)
    if workers and not hasattr(session.config, "workerinput") and not session.config.option.collectonly:
        compiled.warmup(say=print)


@pytest.fixture(scope="session")
def made_once(tmp_path_factory, worker_id):
    """`made_once(name, make)`: what `make()` gives, from the process of the suite that asked for it first."""
    own = tmp_path_factory.getbasetemp()
    folder, mine = own if worker_id == "master" else own.parent, {}

    def once(name, make):
        kept = folder / f"{name}.pickle"
        if name not in mine:
            if kept.exists():
                mine[name] = pickle.loads(kept.read_bytes())
            else:
                mine[name] = make()
                written = own / kept.name
                written.write_bytes(pickle.dumps(mine[name]))
                written.replace(kept)
        return mine[name]

    return once


@pytest.fixture(scope="session")
def resonant(made_once):
    """Where a motion of the uniform disk walks away, and its start."""
    return made_once("wanders", lambda: resonant_and_paths(BODIES["uniform"]))[0]


@pytest.fixture(scope="session")
def wanders(made_once):
    """Paths of a generic motion of the uniform disk and of the resonant one."""
    return made_once("wanders", lambda: resonant_and_paths(BODIES["uniform"]))[1]


@pytest.fixture(scope="session")
def traded(made_once):
    """Every method measured on a few passages of the hoop."""
    few = {"samples": 300, "eta_hat": (1e-8, 1.0), "progress": False}
    return made_once("traded", lambda: trade(disk=BODIES["hoop"], **few))


SAVE, LAY_OUT = Figure.savefig, Figure.draw_without_rendering


@pytest.fixture(autouse=True, scope="session")
def quick_pictures():
    """Figures are made in full, not laid out, and saved as a dot: that takes a second for each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "draw_without_rendering", lambda _: None)
        patch.setattr(Figure, "savefig", lambda _, path, **options: save_dot(path))
        yield


def save_dot(path):
    """A picture of one pixel, or an empty file where it is no PNG."""
    if Path(path).suffix == ".png":
        Image.new("RGB", (1, 1)).save(path)
    else:
        Path(path).touch()


@pytest.fixture(autouse=True)
def rendered_pictures(request, monkeypatch):
    """Tests marked `rendered` get the PNG pictures that a user gets, or those of the kinds that the mark names."""
    mark = request.node.get_closest_marker("rendered")
    if mark:

        def saved(figure, path, **options):
            if Path(path).suffix.lstrip(".") in (mark.args or ("png",)):
                LAY_OUT(figure)
                SAVE(figure, path, **options)
            else:
                save_dot(path)

        monkeypatch.setattr(Figure, "savefig", saved)


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
    """Passages in 40 digits towards face +1, none of them slow or nearer to F than 1e-6."""
    motions = MOTIONS[PASSAGES & (MOTIONS["face"] == 1) & (abs(MOTIONS["eta_hat"]) > 1e-6)]
    usual = np.isin(motions["kind"], ("passage", "spin")) & (motions["I1"] > 0.01) & (motions["I3"] > 0.001)
    return motions[usual]


def computed(scene):
    """The counts of all chunks of a scene together, as they come out of a stored run."""
    states = (json.dumps(scene.chunk(index)[1].state(), allow_nan=False) for index in range(scene.chunks))
    return sum((scene.tally.of_state(json.loads(state)) for state in states), scene.tally())
