"""States that a user gives in a file."""

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

import explorer as ex
from explorer.runs import folder as folders


def test_given_states_are_taken_and_bad_ones_flagged(tmp_path):
    rng = np.random.default_rng(3)
    columns = {name: rng.uniform(-1, 1, 500) for name in ("phi", "phidot", "sigma3", "sigma4")}
    clean, spoilt = tmp_path / "clean.parquet", tmp_path / "spoilt.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), clean)
    bad = rng.choice(500, 5, replace=False)
    for row, value in zip(bad, (np.nan, np.inf, -np.inf, 1e300, 7.0), strict=True):
        columns["phi" if value == 7.0 else "sigma3"][row] = value
    pyarrow.parquet.write_table(pyarrow.table(columns), spoilt)
    options = {"grid": 5, "keep": "all", "chunk_size": 128}
    good = ex.run("falling-set", states=clean, out=tmp_path / "good", **options)
    run = ex.run("falling-set", states=spoilt, out=tmp_path / "run", **options)
    one, other = (
        {name: np.concatenate([table[name] for table in done.tables()]) for name in ("status", "theta_min")}
        for done in (good, run)
    )
    assert set(np.flatnonzero(other["status"] == ex.Status.BAD_INPUT)) == set(bad)
    kept = np.setdiff1d(np.arange(500), bad)
    np.testing.assert_array_equal(one["theta_min"][kept], other["theta_min"][kept])
    assert folders.scene_of(run.folder).options() == run.scene.options()
    pyarrow.parquet.write_table(pyarrow.table(columns).slice(1), spoilt)
    with pytest.raises(ex.InputError, match="is not the file of states that the run began with"):
        folders.scene_of(run.folder)
    for wrong, message in ((tmp_path / "none.parquet", "cannot be read"), (spoilt, "leave it out")):
        with pytest.raises(ex.InputError, match=message):
            ex.run("falling-set", states=wrong, box="phi=0", out=tmp_path / "no")
