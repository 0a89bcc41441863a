"""A scene of a user, fast and without kernels: what runs promise is tested with it."""

import os
import time
from pathlib import Path

import numpy as np

from explorer.phase.columns import Column
from explorer.scenes.options import NUMBER, option
from explorer.scenes.scene import Counts, SampledScene

SMALL = {"samples": 2500, "seed": 5, "chunk_size": 512, "keep": "all"}  # five chunks


def wait():
    """What a chunk takes before its coins are looked at, so that a run can be stopped in its middle.

    COINS_SECONDS, and a ticket, one of the files in the folder COINS_TICKETS, as long as there is such a folder.
    """
    time.sleep(float(os.environ.get("COINS_SECONDS", "0")))
    tickets = os.environ.get("COINS_TICKETS")
    while tickets and Path(tickets).is_dir() and not any(map(taken, Path(tickets).glob("*"))):
        time.sleep(0.01)


def taken(ticket):
    """Whether it was this process that took it."""
    try:
        ticket.unlink()
    except OSError:
        return False
    return True


class CoinCounts(Counts):
    """Heads, and how high coins fly."""

    heads: int
    height: float


class Coins(SampledScene):
    """How often does a coin show heads?"""

    bias: float = option(NUMBER, "share of heads", default=0.5)
    tally = CoinCounts
    columns = {"height": Column("How high the coin flies.", "length"), "heads": Column("What it shows.")}  # noqa: RUF012

    def draw(self, random, count):
        return {"heads": random.random(count) < self.bias, "height": random.random(count)}

    def observe(self, drawn):
        wait()
        drawn["note"] = np.where(drawn["heads"], "head", "tail").astype(object)
        return {**drawn, "status": np.zeros(drawn["heads"].size, np.int8)}

    def near(self, table):
        return table["height"] > 0.9

    def count(self, tally, table):
        tally.heads += int(table["heads"].sum())
        tally.height += float(table["height"].sum())

    def summarise(self, tally):
        mean = tally.height / self.samples
        return {**super().summarise(tally), "share": tally.heads / self.samples, "mean": mean}

    def figures(self, summary, tally):
        def bars(ax=None, width=0.5):
            from explorer.pictures.style import axes_or_new

            ax = axes_or_new(ax)
            ax.bar(["heads", "tails"], [summary["share"], 1.0 - summary["share"]], width)
            return ax

        yield "bars", bars
