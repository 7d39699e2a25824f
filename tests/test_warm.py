"""Compiled kernels are renewed when a source changes."""

from pathlib import Path

import pytest

from fuzzynav import warm


def test_a_changed_kernel_forgets_every_compiled_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warm, "PACKAGE", tmp_path)
    inner, cache = tmp_path / "inner.py", tmp_path / "sub" / "__pycache__"
    inner.write_text("from numba import njit\nstep = 1\n")
    (tmp_path / "plain.py").write_text("speed = 1\n")
    assert not warm.forget_stale()
    cache.mkdir(parents=True)
    compiled = cache / "outer.run-1.py311.nbi"
    compiled.write_bytes(b"old")
    assert not warm.forget_stale()
    (tmp_path / "plain.py").write_text("speed = 2\n")
    assert not warm.forget_stale()
    assert compiled.exists()
    inner.write_text("from numba import njit\nstep = 2\n")
    assert warm.forget_stale()
    assert not compiled.exists()
