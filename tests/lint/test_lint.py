"""`make lint` is silent here, and each of its tools sees what it is there for."""

import shutil
import subprocess

import pytest

import simulate


def lint(root, *arguments):
    return subprocess.run(["tools/lint.sh", *arguments], cwd=root, capture_output=True, text=True, timeout=120)


def test_this_tree_is_clean(root, long):
    """Debian's Verilator, with -Wall, and Icarus have read every configuration when it was built: here a few, and what 20 commits changed in C, or with
    --long all."""
    few = [] if long else ["CONFIGS=single shared_full", "RECENT=20"]
    done = subprocess.run(["make", "lint", *few], cwd=root, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and done.stdout + done.stderr == "", done.stdout + done.stderr


def test_slang_reads_every_configuration(root):
    """And what families have without a primitive."""
    files = [*sorted(simulate.top("").parent.glob("fp3_*.v")),
             *(root / f"rtl/fpga/{name}.v" for name in ("wide/fp3_fp_mul_product", "ice40/fp3_counters", "ice40/fp3_ram_forward"))]
    done = subprocess.run([root / ".venv/bin/python", "tools/slang.py", *files], cwd=root,
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and done.stdout + done.stderr == "", done.stdout + done.stderr


LEAK = """#include <stdlib.h>
int fp3_leak(void);
int fp3_leak(void) {
    char *p = malloc(3);
    if (!p)
        return 1;
    return 0;
}
"""
# A file, its text, how to lint it, and what must be said.
SPOILED = {
    "cppcheck": ("sw/base/spoiled.c", LEAK, ["c"], "Memory leak: p"),
    "clang-format": ("sw/base/spoiled.h", "int   g(void);\n", ["c"], "clang-format-violations"),
    "verilator": ("rtl/spoiled.v", "module spoiled (input wire a_i, output wire [3:0] z_o);\n"
                  "    assign z_o = a_i + 5'd3;\nendmodule\n", ["rtl", "spoiled"], "Warning-WIDTH"),
    "slang": ("rtl/spoiled.v", "`default_nettype none\nmodule spoiled (input wire a_i, output wire z_o);\n    assign z_o = b;\n    wire b = a_i;\n"
              "endmodule\n`default_nettype wire\n", ["rtl", "spoiled"], "'b' used before its declaration"),
    "verible": ("rtl/spoiled.v", "`default_nettype none\nmodule spoiled (input wire a_i, output wire z_o);\n    wire inf = a_i;\n    assign z_o = inf;\n"
                "endmodule\n`default_nettype wire\n", ["rtl", "spoiled"], 'syntax error at token "inf"'),
    "a new verilator": ("rtl/spoiled.v", "`default_nettype none\nmodule spoiled (input wire clk_i, output wire z_o);\n    reg z_q = 1'b1;\n"
                        "    always @(posedge clk_i) z_q <= !z_q;\n    assign z_o = z_q;\nendmodule\n`default_nettype wire\n", ["rtl", "spoiled"], "Warning-PROCASSINIT"),
    "icarus": ("rtl/spoiled.v", "`default_nettype none\nmodule spoiled (input wire a_i, output logic z_o);\n"
               "    assign z_o = a_i;\nendmodule\n`default_nettype wire\n", ["rtl", "spoiled"], "cannot be driven by"),
    "no such module": ("rtl/other.v", "", ["rtl", "spoiled"], "there is no module spoiled"),
}


def copy(root, tmp_path):
    """What tools/lint.sh needs, without a source."""
    for name in ("tools/lint.sh", "tools/slang.py", "rtl/fp3.f", ".clang-format"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / name, tmp_path / name)
    for name in ("sw/base", "sim", "tests", "rtl/board", "rtl/bus", "rtl/lib", "rtl/lns", "rtl/config", "rtl/fp", "rtl/front", "rtl/gen", "rtl/host", "rtl/lane", "rtl/sequence", "rtl/solo", "rtl/unit", "rtl/video"):
        (tmp_path / name).mkdir(parents=True, exist_ok=True)
    (tmp_path / "rtl/gen/files.f").write_text("")
    (tmp_path / ".venv").symlink_to(root / ".venv")


@pytest.mark.parametrize("tool", SPOILED)
def test_each_tool_sees_what_it_is_for(root, tmp_path, tool):
    file, text, arguments, said = SPOILED[tool]
    copy(root, tmp_path)
    (tmp_path / file).write_text(text)
    done = lint(tmp_path, *arguments)
    assert done.returncode != 0 and said in done.stdout + done.stderr, done.stdout + done.stderr


def test_what_commits_changed_is_read(root, tmp_path):
    """A mistake is seen in the last commit and before any commit; one that is older than that is not looked for, except where there are no so many."""
    copy(root, tmp_path)

    def git(*arguments):
        subprocess.run(["git", "-c", "user.name=x", "-c", "user.email=x", *arguments], cwd=tmp_path, check=True, capture_output=True)

    def found(commits):
        said = lint(tmp_path, "c", commits)
        assert (said.returncode != 0) == ("Memory leak: p" in said.stderr), said.stderr
        return sorted(name for name in ("old", "new") if f"sw/base/{name}.c" in said.stderr)
    (tmp_path / "sw/base/old.c").write_text(LEAK)
    git("init", "-q")
    git("add", "sw")
    git("commit", "-q", "-m", "old")
    assert found("1") == ["old"]
    (tmp_path / "sw/base/new.c").write_text(LEAK)
    git("commit", "-q", "--allow-empty", "-m", "nothing")
    assert found("1") == ["new"]
    git("add", "sw")
    git("commit", "-q", "-m", "new")
    assert found("1") == ["new"] and found("3") == ["new", "old"]
    (tmp_path / "sw/base/new.c").unlink()
    assert found("1") == []


# Parameters of fp3, and the rule that must be named.
BROKEN = [(["STORE_WORDS=8"], "STORE_WORDS_must_be_at_least_16_and_REGISTERS"),
          (["STORE_WORDS=64", "CONTEXTS=0"], "CONTEXTS_must_be_1_to_64"),
          (["STORE_WORDS=131072", "LANES=16"], "LANES_times_STORE_WORDS_must_be_at_most_1048576")]


@pytest.mark.parametrize("keys, rule", BROKEN, ids=[rule for _, rule in BROKEN])
def test_a_configuration_that_cannot_be_built_names_its_rule(root, keys, rule):
    done = subprocess.run(["verilator", "--lint-only", "-Wno-lint", "-f", "rtl/fp3.f", "--top-module", "fp3", *[f"-G{key}" for key in keys], "rtl/fp3.v"],
                          cwd=root, capture_output=True, text=True, timeout=120)
    assert done.returncode != 0 and f"'{rule}'" in done.stderr and "Internal Error" not in done.stderr, done.stderr
