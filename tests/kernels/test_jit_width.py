"""What numba compiles for, where nobody names a processor."""

import pytest

from kernels import _jit


@pytest.mark.parametrize(
    ("features", "named", "wide"),
    [("+avx2,+avx512f", None, True), ("+avx2,-avx512f", None, False), ("+avx2,+avx512f", "haswell", False)],
)
def test_vectors_are_as_wide_as_registers_unless_a_processor_is_named(monkeypatch, features, named, wide):
    monkeypatch.setattr(_jit.config, "CPU_NAME", named)
    monkeypatch.setattr(_jit.config, "CPU_FEATURES", None)
    monkeypatch.setattr(_jit, "get_host_cpu_features", lambda: features)
    _jit._use_whole_registers()
    assert (f"{features},-prefer-256-bit" if wide else None) == _jit.config.CPU_FEATURES
