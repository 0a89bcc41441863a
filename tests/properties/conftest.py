"""How many examples were answered and how many refused; where many are tried, results/faults/fuzz.json says it."""

import json
import os
from collections import Counter, defaultdict
from pathlib import Path

import pytest

OUT = Path(__file__).parents[2] / "results" / "faults" / "fuzz.json"


@pytest.fixture(scope="session")
def counts():
    counted = defaultdict(Counter)
    yield counted
    if "NEARFLAT_EXAMPLES" in os.environ:
        OUT.write_text(json.dumps(counted, indent=2, sort_keys=True) + "\n")
