"""The notebooks and the page run as they stand: cells in order, each in the state that those before it have left."""

import contextlib
import json
import os
import pathlib
import re

import pytest

import fp3

NOTEBOOKS = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples/notebooks").glob("*.ipynb"))


@contextlib.contextmanager
def inside(directory):
    """As contextlib.chdir of Python 3.11."""
    before = os.getcwd()
    os.chdir(directory)
    try:
        yield
    finally:
        os.chdir(before)


def execute(pieces, directory):
    """Python texts in one namespace, in this directory."""
    names = {"__name__": "__main__"}
    with inside(directory):
        for piece in pieces:
            exec(compile(piece, "<cell>", "exec"), names)
    return names


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook(path, tmp_path, capsys):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4 and len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
    code = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(code) > 3 and all(not cell["outputs"] for cell in notebook["cells"] if cell["cell_type"] == "code"), "kept without outputs"
    execute(code, tmp_path)
    assert "assert" in "".join(code) and capsys.readouterr().out


def test_there_is_one_for_each_use():
    assert [path.stem for path in NOTEBOOKS] == ["choose", "ensemble", "game"]


def test_the_page(root, capsys):
    """Every indented block of docs/python.md in Python, in the order of the page."""
    page = (root / "docs/python.md").read_text(encoding="utf-8")
    blocks = [re.sub(r"^ {4}", "", block, flags=re.M) for block in re.findall(r"(?:^ {4}.*\n(?:\n(?= {4}))*)+", page, re.M)]
    pieces = [block for block in blocks if not block.startswith(("pip ", ".venv-bench"))]
    assert len(pieces) > 5
    names = execute(pieces, root)
    assert names["many"].success and names["drones"].time == pytest.approx(60 * names["drones"].model.step) and "True" in capsys.readouterr().out


def test_every_public_name_is_documented(root):
    page = (root / "docs/python.md").read_text(encoding="utf-8")
    for name in fp3.__all__:
        if not name.startswith("_") and name not in ("Column", "Failure", "Solution", "Table", "Tuning"):
            assert f"fp3.{name}" in page, name
        value = getattr(fp3, name)
        assert name == "__version__" or value.__doc__, name
        for member, of in vars(value).items() if isinstance(value, type) else ():
            assert member.startswith("_") or not callable(of) or of.__doc__, f"{name}.{member}"


def test_arguments_are_in_the_page(root):
    import inspect
    page = (root / "docs/python.md").read_text(encoding="utf-8")
    for name in inspect.signature(fp3.solve_ivp).parameters:
        assert name in ("model", "objects") or f"`{name}`" in page, name
