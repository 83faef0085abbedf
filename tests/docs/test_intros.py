"""Pages of measurements say in words what the tool says that makes them: who changes the one changes the other."""

import importlib
import sys

import pytest


@pytest.fixture
def tool(root, monkeypatch):
    """A tool as a module."""
    def tool(name):
        monkeypatch.syspath_prepend(root / "tools")
        monkeypatch.delitem(sys.modules, name, raising=False)
        return importlib.import_module(name)

    return tool


def test_stress(root, tool):
    made, page = tool("fp3bench.stress"), (root / "docs/stress.md").read_text(encoding="utf-8")
    assert f"\n\n{made.INTRODUCTION}\n\n" in page
    for heading, text in made.SECTIONS.values():
        assert f"## {heading}\n\n{text}\n" in page and f"| {heading} |" in page


def test_benchmarks(root, tool):
    made = tool("bench_report")
    assert f"\n\n{made.INTRODUCTION}\n\n" in (root / "docs/benchmarks.md").read_text(encoding="utf-8")
    assert "\n" + "\n".join(made.blocks(made.INTRODUCTION)) + "\n" in (root / "docs/benchmarks.html").read_text(encoding="utf-8")


def test_world(root, tool):
    made, page = tool("fp3world.report"), (root / "docs/world.md").read_text(encoding="utf-8")
    for text in (made.HEAD, made.SCENES, made.PHYSICS, made.HASHES, made.SPEED, made.CHIP):
        assert f"\n\n{text}\n\n" in page


def test_bodies(root, tool):
    made, page = tool("fp3bodies.report"), (root / "docs/bodies_results.md").read_text(encoding="utf-8")
    for text in (made.HEAD, made.TRUTHS, made.STANDING, made.SPEED):
        assert f"\n\n{text}\n\n" in page
    assert f"\n\n{made.ERROR}\n\n" in (root / "docs/bodies_error.md").read_text(encoding="utf-8")
