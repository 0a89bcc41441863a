"""What decides the last digits of a run is known, and stands in run.json."""

import json
import os
import subprocess
import sys

from explorer.runs import store
from explorer.runs.machine import arithmetic, machine

ASK = "from explorer.runs.machine import machine; import json; print(json.dumps(machine()))"


def asked(**environment):
    done = subprocess.run(
        [sys.executable, "-c", ASK], env={**os.environ, **environment}, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_the_arithmetic_is_that_of_the_kind_that_is_compiled_for():
    here = machine()
    if here["processor"] != "x86_64":
        return
    old = asked(NUMBA_CPU_NAME="x86-64", NUMBA_CPU_FEATURES="", NPY_DISABLE_CPU_FEATURES="")
    assert (old["compiled_for"], "products not fused" in old["arithmetic"]) == ("x86-64", True)
    assert old["arithmetic"].replace("not fused", "fused") == here["arithmetic"].replace("not fused", "fused")
    named = asked(NUMBA_CPU_NAME="x86-64", NPY_DISABLE_CPU_FEATURES="")
    assert (named["compiled_for"], named["arithmetic"]) == ("x86-64", here["arithmetic"])
    assert "products" in asked(NPY_DISABLE_CPU_FEATURES="X86_V3 X86_V4 AVX512_ICL AVX512_SPR")["arithmetic"]
    assert "products fused" in asked(NUMBA_CPU_NAME="haswell", NUMBA_CPU_FEATURES="+avx2,+fma")["arithmetic"]


def test_run_json_names_every_kind_that_computed_a_part_and_going_on_says_so(finished, capsys):
    record = store.read_json(finished.folder / "run.json")
    assert record["arithmetic"] == [arithmetic()] == [record["machine"]["arithmetic"]]
    store.write_json(finished.folder / "run.json", {**record, "arithmetic": ["abacus"]})
    before = finished.summary["digest"]
    finished.chunks[0].content.unlink()
    assert finished.resume(progress=True).summary["digest"] == before
    assert f"of this run: abacus; {arithmetic()}" in capsys.readouterr().err
    assert store.read_json(finished.folder / "run.json")["arithmetic"] == ["abacus", arithmetic()]
