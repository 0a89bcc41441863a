"""The way of a sample from option to picture, as ARCHITECTURE.md tells it."""

import inspect
import re
import sys
import threading
from pathlib import Path

import explorer
from explorer.commands.main import main
from explorer.compiled import warmup
from explorer.phase.disk import Disk
from explorer.phase.gauss import table_rules
from explorer.plot import race_histogram  # noqa: F401 - loaded here, so that loading is no part of the way
from explorer.scenes.registry import build_scene

ROOT = Path(explorer.__file__).parents[1]
LONGEST = 40  # files of `explorer`: a newcomer reads no more to follow one sample


def told():
    """The files of the section, in order: a name without a folder stands in that of the name before it."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    section = text.partition("## The way of a sample\n")[2].partition("\n## ")[0]
    files, folder = [], ""
    for name in re.findall(r"`([\w/]+\.py)`", section.partition("|---|---|")[2]):
        folder = name.rpartition("/")[0] or folder
        files.append(f"{folder}/{name.rpartition('/')[2]}")
    return files


def entered(call):
    """The files of `explorer` in which a function is called, not counting those that loading calls."""
    files, house = set(), str(ROOT / "explorer")

    def note(frame, event, argument):
        code = frame.f_code
        name = code.co_filename
        if (
            event == "call"
            and name not in files
            and name.startswith(house)
            and code.co_flags & inspect.CO_OPTIMIZED
        ):
            above = frame.f_back
            while above is not None and above.f_code.co_name != "<module>":
                above = above.f_back
            if above is None or not above.f_code.co_filename.startswith(house):
                files.add(name)

    before = sys.getprofile()
    threading.setprofile(note)
    sys.setprofile(note)
    try:
        call()
    finally:
        sys.setprofile(before)
        threading.setprofile(None)
    return {Path(name).relative_to(ROOT).as_posix() for name in files}


def test_a_sample_goes_the_way_that_the_map_of_the_house_tells(tmp_path):
    command = ["run", "race-angles", "--samples", "200", "--out", str(tmp_path / "races"), "--format", "png"]
    warmup(build_scene("race-angles").kernels)  # to note all that compiling calls would take minutes
    body = Disk.uniform().body
    table_rules(body.I1, body.I3)  # kept for a process: no part of the way of a sample
    seen = entered(lambda: main([*command, "--quiet"]))
    files = told()
    assert all((ROOT / name).is_file() for name in files)
    assert len(set(files)) > 30
    assert {name for name in files if name.startswith("explorer/")} <= seen
    words = {"explorer/commands/common.py", "explorer/version.py"}
    # Checks of files that are read make nothing of a sample.
    checks = {"explorer/runs/schema.py", "explorer/phase/strangers.py", "explorer/scenes/tallies.py"}
    assert len(seen - words - checks) <= LONGEST, sorted(seen)
