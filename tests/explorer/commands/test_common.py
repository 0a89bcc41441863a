"""What several commands share."""

import argparse
import json
from types import SimpleNamespace

from explorer.commands.common import add_json, show
from explorer.commands.run import add_settings


def test_workers_and_json_have_the_same_flags_everywhere():
    words = ["--jobs", "3", "--backend", "dask", "--scheduler", "tcp://127.0.0.1:1", "--json"]
    expected = {"jobs": "3", "backend": "dask", "scheduler": "tcp://127.0.0.1:1", "json": True}
    for settings in (None, ("jobs", "backend", "scheduler")):  # those of a new run; of one that goes on
        command = argparse.ArgumentParser()
        add_settings(command, settings)
        add_json(command)
        assert vars(command.parse_args(words)).items() >= expected.items()
        assert set(vars(command.parse_args([])).values()) == {None, False}


def test_a_finished_run_is_shown_as_lines_or_as_one_object(capsys, tmp_path):
    run = SimpleNamespace(
        summary={"samples": 3},
        folder=tmp_path,
        scene=SimpleNamespace(headline=lambda summary: [str(summary["samples"])]),
    )
    assert show(run, as_json=False) == 0
    assert capsys.readouterr().out == f"3\nSamples and numbers are in {tmp_path}.\n"
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "one.png").touch()
    assert show(run, as_json=False) == 0
    assert capsys.readouterr().out == f"3\nSamples, numbers and pictures are in {tmp_path}.\n"
    assert show(run, as_json=True) == 0
    assert json.loads(capsys.readouterr().out) == {"samples": 3}
