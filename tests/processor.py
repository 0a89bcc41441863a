"""The name of the processor that figures were made on."""

import platform
from pathlib import Path


def processor():
    """Its model, and the widest vectors it has."""
    names = [line.partition(":")[2].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")]
    flags = next((line for line in _lines("/proc/cpuinfo") if line.startswith("flags")), "")
    vectors = "AVX-512" if "avx512f" in flags else "256-bit vectors" if "avx2" in flags else platform.machine()
    name = names[0] if names else platform.processor() or platform.machine()
    return f"{name} with {vectors}"


def _lines(path):
    return Path(path).read_text().splitlines() if Path(path).exists() else []
