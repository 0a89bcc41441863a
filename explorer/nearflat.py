"""`import nearflat`: the package `explorer`, by the name under which it is installed."""

import sys

import explorer

sys.modules[__name__] = explorer
