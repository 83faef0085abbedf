"""The Makefile: what help promises, the order of `make setup test`, and the closing line."""

import os
import re
import shutil
import subprocess
import sys

import pytest

TARGETS = "setup setup-fpga setup-soc setup-packages soc packages sim test quick smoke waves lint prove synth report testfloat install uninstall clean help".split()


def make(root, *arguments, **options):
    return subprocess.run(["make", *arguments], cwd=root, capture_output=True, text=True, timeout=120, **options)


@pytest.mark.smoke
def test_help_lists_every_target(root):
    done = make(root, "help")
    listed = re.findall(r"^  ([a-z-]+) ", done.stdout, re.MULTILINE)
    assert done.returncode == 0 and set(TARGETS) <= set(listed)


def test_every_listed_target_exists(root):
    rules = make(root, "--print-data-base", "--question", "help").stdout
    for target in re.findall(r"^  ([a-z-]+) ", make(root, "help").stdout, re.MULTILINE):
        assert re.search(rf"^{target}:", rules, re.MULTILINE), target


def test_a_variable_that_help_offers_is_no_name_of_ours(root):
    """What make gets on its command line would replace ours everywhere: MEASURE=1 made an archive with the name 1."""
    offered = set(re.findall(r"\b([A-Z]+)=", make(root, "help").stdout))
    texts = [path.read_text() for path in (root / "Makefile", *sorted(root.glob("tools/*.mk")))]
    ours = {name for text in texts for name in re.findall(r"^([A-Z]+) *:?=", text, re.M)}
    assert {"CONFIG", "MEASURE", "QUICK"} <= offered and {"LIB", "CFLAGS"} <= ours
    assert not offered & ours


@pytest.mark.parametrize("target", ["sim", "waves", "synth"])
def test_an_unknown_configuration_is_named_before_anything_is_built(root, target):
    done = make(root, target, "CONFIG=nonesuch")
    assert done.returncode != 0 and done.stdout == ""
    assert "no configuration 'nonesuch': there are " in done.stderr and "single" in done.stderr


def test_what_is_compiled_waits_for_the_check_of_generated_files_but_does_not_depend_on_it(root):
    """So a new integrator or a row in isa/ compiles what includes the generated files, and not all the hardware."""
    rules = make(root, "--print-data-base", "--question", "help").stdout
    found = dict(re.findall(r"^(build/(?:obj|verilated)/[^:%\s]+): (.*build/ready.*)$", rules, re.M))
    assert "build/verilated/single/hardware.a" in found and any(name.startswith("build/obj/sw/") for name in found), found.keys()
    for name, needs in found.items():
        assert "build/ready" in needs.partition("|")[2].split() and "build/flags" in needs.partition("|")[0].split(), f"{name}: {needs}"


def test_a_path_with_a_space_is_refused_at_once(root, tmp_path):
    folder = tmp_path / "my work"
    folder.mkdir()
    shutil.copy(root / "Makefile", folder)
    done = make(folder, "all")
    assert done.returncode != 0 and done.stdout == "" and f"the path '{folder}' has a space" in done.stderr, done.stderr


@pytest.mark.parametrize("goals", [["setup", "sim", "test"], ["sim", "test", "setup"]])
def test_setup_ends_before_anything_else_starts(root, tmp_path, goals):
    # The same rules, with recipes that only note their order.
    text = (root / "Makefile").read_text()
    head = text[:text.index("# ---- what there is")].replace("PYTHON=$(PYTHON) tools/setup.sh", "sleep 0.3; echo")
    (tmp_path / "Makefile").write_text(head.replace("@sleep 0.3; echo", "@sleep 0.3; echo did setup")
                                       + "sim:\n\t@echo did sim\ntest: sim\n\t@echo did test\nendif\n")
    done = make(tmp_path, "-j4", *goals)
    did = [line for line in done.stdout.splitlines() if line.startswith("did ")]
    assert did == ["did setup", "did sim", "did test"], done.stdout + done.stderr
    assert done.returncode == 0


@pytest.mark.parametrize("goals", [["clean", "sim"], ["sim", "clean"], ["sim", "synth"], ["sim", "report"]])
def test_goals_that_need_each_other_run_in_the_order_given(root, tmp_path, goals):
    text = (root / "Makefile").read_text()
    rules = "".join(f"{goal}:\n\t@sleep {0.3 if goal == goals[0] else 0}; echo did {goal}\n" for goal in goals)
    (tmp_path / "Makefile").write_text(text[:text.index("# ---- what there is")] + rules + "endif\n")
    assert make(tmp_path, "-j4", *goals).stdout.split() == ["did", goals[0], "did", goals[1]]


# A test file, and the closing lines and success that must follow.
RUNS = {
    "pass": ("def test_a(): pass\ndef test_b(): pass\n", "2 passed, 0 failed", True),
    "fail": ("def test_a(): pass\ndef test_b(): assert 1 == 2\n", "1 passed, 1 failed", False),
    "error": ("import pytest\n@pytest.fixture\ndef x(): 1 / 0\ndef test_a(x): pass\n", "0 passed, 1 failed", False),
    "broken": ("import no_such_module\n", "0 passed, 1 failed", False),
    "none": ("", "0 passed, 0 failed", False),
    "skip": ("import pytest\n@pytest.mark.parametrize('why', ['no mouse: make setup-view all', 'nothing here', 'make setup-view setup-docs'])\n"
             "def test_a(why): pytest.skip(why)\ndef test_b(): pass\n",
             "3 skipped, with their reasons above: make setup-docs (1), make setup-view (2), other reasons (1)\n1 passed, 0 failed", True),
}


@pytest.mark.parametrize("run, workers", [*((run, "2") for run in RUNS), (next(iter(RUNS)), "0")])
def test_the_closing_line_counts_errors_as_failures(root, tmp_path, run, workers):
    text, line, success = RUNS[run]
    tests = tmp_path / "tests"
    tests.mkdir()
    for name in ("conftest.py", "pytest.ini"):
        shutil.copy(root / "tests" / name, tests)
    (tests / "test_it.py").write_text(text)
    # A directory of its own: without it this run would first remove those of earlier runs, which may take minutes.
    done = subprocess.run([sys.executable, "-m", "pytest", "-n", workers, f"--basetemp={tmp_path / 'base'}", "tests"], cwd=tmp_path,
                          capture_output=True, text=True, timeout=120)
    assert done.stdout.endswith(f"\n{line}\n"), done.stdout
    assert (done.returncode == 0) == success


@pytest.mark.parametrize("goals, alone", [(["setup-view", "setup-bench"], True), (["setup-view"], False), (["setup-view", "test"], False)])
def test_two_setups_do_not_run_at_once(root, goals, alone):
    """There is one lock for installing packages."""
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = subprocess.run(["make", "-pn", *goals], cwd=root, env=env, capture_output=True, text=True, timeout=60)
    database = done.stdout[done.stdout.rindex("# Make data base"):]
    assert (re.search(r"^\.NOTPARALLEL:", database, re.M) is not None) == alone


@pytest.mark.parametrize("goal, wanted, count", [(["sim"], "crowd", 13), (["waves", "CONFIG=cell"], "cell", 13), (["install"], "fabric", 12), (["models"], "sixteen", 35)],
                         ids=["sim", "waves of another", "install", "models"])
def test_a_goal_builds_the_hardware_that_it_runs(root, goal, wanted, count):
    """Those to take, and what is asked for; what measures and compares may want any."""
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = subprocess.run(["make", "-n", "-B", *goal], cwd=root, env=env, capture_output=True, text=True, timeout=120)
    built = set(re.findall(r"RTL +fp3_(\w+)", done.stdout)) - {"board_top"}
    assert done.returncode == 0 and wanted in built and len(built) == count, (built, done.stderr[-2000:])


ELSEWHERE = r"fp3_(sweep_|solver\d_v\d|library_is_there)"          # of other rules of tools/wasm.mk, or called on other processors alone


def test_what_webassembly_leaves_out_is_not_needed(root, build, tmp_path):
    """Every function of ours that a file of the command for WebAssembly calls is in one of these files: by the symbols of the objects built here."""
    (tmp_path / "show.mk").write_text("include Makefile\nshow: ; @echo $(WASM_C)\n")
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    files = subprocess.run(["make", "-s", "-f", tmp_path / "show.mk", "show"], cwd=root, env=env, capture_output=True, text=True, check=True, timeout=60).stdout.split()
    own = [file for file in files if file.startswith("sw/cli/wasm/")]
    subprocess.run(["gcc", "-std=c11", "-D_GNU_SOURCE", "-w", *(f"-I{root / folder}" for folder in ("sw", "sw/include")), "-c", *(root / file for file in own)],
                   cwd=tmp_path, check=True, timeout=60)
    objects = [*tmp_path.glob("*.o"), *((build / "obj" / file).with_suffix(".o") for file in files if file not in own)]
    said = subprocess.run(["nm", "-A", *objects], capture_output=True, text=True, check=True, timeout=60).stdout
    symbols = re.findall(r"^(\S+?):\S* +(\w) (fp3_\w+)$", said, re.M)
    there = {name for _, kind, name in symbols if kind in "TDRBV"}
    lacking = {(os.path.basename(path), name) for path, kind, name in symbols if kind == "U" and name not in there and not re.match(ELSEWHERE, name)}
    assert len(there) > 500 and lacking == set()
