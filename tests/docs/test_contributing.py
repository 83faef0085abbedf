"""CONTRIBUTING.md names files and targets that are there. In a name of a file capitals stand for a name that one chooses."""

import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
CHOSEN = re.compile(r"(?<![A-Za-z])(?:NAME|FORMAT|FAMILY)(?![A-Za-z])")
PATH = re.compile(r"(?:[\w.*-]+/)+[\w.*-]*|[\w*-]+\.(?:md|toml|py|[chv]|vh|core|txt|json|svg|html)")


def code(text):
    """What stands between backquotes, and the lines of indented blocks."""
    return re.findall(r"`([^`\n]+)`", text) + re.findall(r"^ {4}(.*)$", text, re.M)


def paths(text):
    """The files and folders that are named; what is built is not there yet."""
    words = [word for line in code(text) for word in line.split()]
    found = [word for word in words if PATH.fullmatch(word)] + re.findall(r"\]\(([^)#]+)", text)
    return sorted({name for name in found if not name.startswith("build/")})


def targets(text):
    """Words after make, up to a comment; those with = are variables, those with / files."""
    found = {word for line in code(text) for command in re.findall(r"^make ([^#]*)", line) for word in command.split()}
    return sorted(word for word in found if re.fullmatch(r"[a-z-]+", word))


def missing(text):
    """Of a name that stands for others there is one of them."""
    return [name for name in paths(text) if not any(ROOT.glob(CHOSEN.sub("*", name)))]


def unknown(text):
    rules = subprocess.run(["make", "--print-data-base", "--question", "help"], cwd=ROOT, capture_output=True, text=True, timeout=60).stdout
    return [name for name in targets(text) if not re.search(rf"^{name}:", rules, re.M)]


def test_every_file_that_is_named_is_there():
    assert len(paths(PAGE)) > 80 and {"isa/isa.toml", "rtl/unit/fp3_NAME_arith.v", "docs/stress_*.svg", "tests/README.md", "README.md"} <= set(paths(PAGE))
    assert missing(PAGE) == []


def test_every_target_that_is_named_exists():
    assert len(targets(PAGE)) > 30 and {"generate", "lint", "quick", "test", "setup", "setup-bench"} <= set(targets(PAGE))
    assert unknown(PAGE) == []


@pytest.mark.parametrize("text, wrong", [
    ("`isa/isas.toml`", "isa/isas.toml"), ("see [it](docs/nonesuch.md#a)", "docs/nonesuch.md"), ("`rtl/nonesuch/NAME.v`", "rtl/nonesuch/NAME.v"),
    ("`rtl/gen/*.none`", "rtl/gen/*.none"), ("    tools/nonesuch.sh rtl\n", "tools/nonesuch.sh"), ("`NONE.md`", "NONE.md")])
def test_a_file_that_is_not_there_is_seen(text, wrong):
    assert missing(text) == [wrong]


def test_a_target_that_does_not_exist_is_seen():
    assert unknown("`make nonesuch BOARD=x`, `make lint`\n\n    make setup nonesuch-too build/x   # why\n") == ["nonesuch", "nonesuch-too"]
