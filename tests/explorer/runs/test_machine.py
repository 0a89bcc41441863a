"""What decides the last digits of a run is known, and stands in run.json."""

import json
import os
import subprocess
import sys

from numba.core import config

from explorer.runs import store
from explorer.runs.machine import arithmetic, machine

ASK = "from explorer.runs.machine import machine; import json; print(json.dumps(machine()))"


def asked(**environment):
    done = subprocess.run(
        [sys.executable, "-c", ASK], env={**os.environ, **environment}, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_the_arithmetic_is_that_of_the_kind_that_is_compiled_for(monkeypatch):
    here = machine()
    if here["processor"] != "x86_64":
        return
    nothing_found = "X86_V3 X86_V4 AVX512_ICL AVX512_SPR"
    old = asked(NUMBA_CPU_NAME="x86-64", NUMBA_CPU_FEATURES="", NPY_DISABLE_CPU_FEATURES=nothing_found)
    assert (old["compiled_for"], "products not fused" in old["arithmetic"]) == ("x86-64", True)
    fused = here["arithmetic"].replace("not fused", "fused")
    for name, features, told in (
        ("x86-64", "", fused.replace("fused", "not fused")),
        ("x86-64", None, here["arithmetic"]),  # numba adds what the machine has
        ("haswell", "+avx2,+fma", fused),
    ):
        monkeypatch.setattr(config, "CPU_NAME", name)
        monkeypatch.setattr(config, "CPU_FEATURES", features)
        assert (machine()["compiled_for"], machine()["arithmetic"]) == (name, told)


def test_run_json_names_every_kind_that_computed_a_part_and_going_on_says_so(finished, capsys):
    record = json.loads((finished.folder / "run.json").read_text())
    assert record["arithmetic"] == [arithmetic()] == [record["machine"]["arithmetic"]]
    store.write_json(finished.folder / "run.json", {**record, "arithmetic": ["abacus"]})
    before = finished.summary["digest"]
    finished.chunks[0].content.unlink()
    assert finished.resume(progress=True).summary["digest"] == before
    assert f"of this run: abacus; {arithmetic()}" in capsys.readouterr().err
    assert json.loads((finished.folder / "run.json").read_text())["arithmetic"] == ["abacus", arithmetic()]


def test_a_run_names_the_arithmetic_of_whoever_made_a_chunk(finished, monkeypatch, capsys):
    """Also of a run that was stopped, and of a worker that is no longer there."""
    for number, kind in ((1, "abacus"), (3, "slide rule")):
        finished.chunks[number].content.unlink()
        monkeypatch.setattr(store, "arithmetic", lambda kind=kind: kind)
        finished.resume(progress=False)
    record = json.loads((finished.folder / "run.json").read_text())
    assert record["arithmetic"] == ["abacus", "slide rule", arithmetic()]
    store.write_json(finished.folder / "run.json", {**record, "arithmetic": []})
    finished.resume()
    assert f"of this run: abacus; slide rule; {arithmetic()}" in capsys.readouterr().err
    assert json.loads((finished.folder / "run.json").read_text())["arithmetic"] == record["arithmetic"]
    assert finished.verify() == []
