"""Rigid bodies on arm64, riscv64 and WebAssembly: the hashes of this machine. `make bodies PARTS=hashes` has more scenes."""

import importlib
import sys

import pytest


@pytest.fixture
def hashes(root, build, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "tools"))
    monkeypatch.setenv("FP3_HOME", str(build))
    pytest.importorskip("numpy")
    yield importlib.import_module("fp3bodies.hashes")
    for name in [name for name in sys.modules if name.startswith("fp3bodies")]:
        del sys.modules[name]


@pytest.mark.parametrize("platform", ["arm64", "riscv64", "wasm"])
def test_bodies_have_the_same_bits_on_other_machines(hashes, tmp_path, platform):
    by = dict(hashes.elsewhere())[platform]
    if not by:
        pytest.skip("make setup-everywhere setup-playground everywhere")
    for name in ("30 dominoes, 0.35 apart", "joints in space"):
        path = hashes.write(tmp_path, hashes.SCENES[name]())
        here = [hashes.stepped(path, steps) for steps in (20, 19)]
        assert hashes.stepped(path, 20, by=by) == here[0] != here[1]
        assert hashes.stepped(path, 20, "fast", fast="interpreter", by=by) == here[0]
