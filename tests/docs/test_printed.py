"""Every command that README and docs print runs as it is printed; every example in C compiles.

A line of an indented block is a command if its first word is one of PROGRAMS, or a file of the project. A block that begins with
a comment with the name of a file is that file. Both lie in a folder beside what the project has, one for each page. Blocks with
`$ ` before their commands, and the outputs after them, are those of test_tutorials.py.
"""

import os
import pathlib
import re
import shlex
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("tests/**/README.md")])
PROGRAMS = "apt|apt-get|cc|dd|gcc|grep|gtkwave|iverilog|make|man|mpirun|pip|python3|tclsh|verilator|vvp|yosys"

# Printed, but not run here: the command, and why.
EXCEPTIONS = [
    (r"make setup|apt|pip |man ", "installs packages, or needs what they install; tests/install installs ours"),
    (r"mpirun", "needs make setup-cluster; tests/cluster has such runs"),
    (r"make (?!setup)", "builds where the tests are running; tests/lint/test_make.py asks make, tests/README.md says which targets are tests"),
    (r"cc (ship|game_loop)\.c", "needs an installation; tests/install builds and runs a program so"),
    (r"gtkwave", "opens a window"),
    (r"\.venv/bin/(pip|peakrdl)", "needs a package from the network; tests/packages reads the same file with its compiler"),
    (r"\.venv/bin/fusesoc", "tests/packages runs these targets in a copy of the project"),
    (r"dd ", "writes 763 MB"),
    (r"build/fp3 compare (programs/(kepler|arenstorf)|tests/ode/adaptive/\w+)\.ode", "takes minutes; tests/ode compares every model in a shorter form"),
    (r"build/fp3 tune programs/kepler\.ode .* --arithmetic flush", "takes long; tests/tune chooses among arithmetics"),
    (r"build/fp3 run tests/ode/adaptive/van_der_pol_10\.ode .* -e rtl", "takes seconds for a row of a table; tests/ode compares the engines, and a shorter run is printed, too"),
    (r"build/tests/double_functions", "tests/ode runs it on fewer numbers"),
    (r"build/fp3 board |.*--port /dev/", "needs the port that the first command names; tests/board runs the two together"),
    (r"python3 examples/pictures\.py /dev/", "needs a board; tests/video has a line that answers as one"),
    (r"tools/chip\.py --run", "builds a simulator of 38 lanes, which takes minutes"),
    (r"python3 tests/formal/prove\.py", "takes minutes; tests/formal proves what fits into `make test`"),
]

# Of these, the commands that ran once in a bare Debian, as printed, in this order (`make fresh ROOT=... RUN=...`). What is no exception runs there in
# `make fresh`. The others were not tried there: they open a window, write 763 MB, or take long.
RAN_IN_A_BARE_DEBIAN = [
    "apt-get update && apt-get install -y git make", "make setup all", "make setup-cluster all", "make waves", "make waves CONFIG=many PROGRAM=ship_madd STEPS=4",
    ".venv/bin/pip install peakrdl", ".venv/bin/peakrdl c-header rtl/gen/fp3.rdl --top fp3_single -o fp3_single.h",
    ".venv/bin/peakrdl html rtl/gen/fp3.rdl --top fp3_many -o pages/", ".venv/bin/fusesoc --cores-root . run --target=lint fp3:fp3:fp3",
    ".venv/bin/fusesoc --cores-root . run --target=replay fp3:fp3:fp3", "make setup-playground playground",
]


def blocks(page):
    """The indented blocks of a page, without what they are indented by."""
    for block in re.findall(r"(?:^ {4}.*\n(?:\n(?= {4}))*)+", page, re.M):
        lines = block.splitlines()
        indent = min(len(line) - len(line.lstrip()) for line in lines if line)
        yield "".join(line[indent:] + "\n" for line in lines)


def is_command(line):
    words = [word for word in line.split() if not re.match(r"[A-Z0-9_]+=", word)]
    return bool(words) and (re.fullmatch(PROGRAMS, words[0]) or re.match(r"(build|tools|tests|examples|\.venv)/\S+$", words[0])) is not None


def is_session(block):
    return block.startswith("$ ")


def commands(block):
    """A command may go over several lines: it ends where its quotes do, and with no backslash."""
    command = ""
    for line in [] if is_session(block) else block.splitlines():
        if not command and not is_command(line):
            continue
        command += line + "\n"
        try:
            shlex.split(command.rstrip("\n"), comments=True)
        except ValueError:
            continue
        yield command.strip()
        command = ""
    assert not command, command


def files(block):
    """The file that a block is, if its first line says so."""
    found = re.match(r"(?:#|//|/\*) ([\w.]+\.(?:ode|s|c|cfg|scene|py|v))\b", block)
    return [(found[1], block)] if found else []


def exception(command):
    return next((reason for pattern, reason in EXCEPTIONS if re.match(pattern, command)), None)


def parts(page, take):
    text = (ROOT / page).read_text(encoding="utf-8")
    return [one for block in blocks(text) for one in take(block)]


@pytest.mark.parametrize("page", [page for page in PAGES if any(not exception(command) for command in parts(page, commands))])
def test_commands_run_as_printed(folder, page, how):
    for name, text in parts(page, files):
        (folder / name).write_text(text)
    env = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"} | how
    for command in parts(page, commands):
        if not exception(command):
            done = subprocess.run(["bash", "-ec", command], cwd=folder, env=env, capture_output=True, text=True, timeout=120)
            assert done.returncode == 0, f"{page}: {command}\n{done.stdout[-2000:]}{done.stderr}"


def test_each_exception_is_printed():
    printed = [command for page in PAGES for command in parts(page, commands)]
    assert len(printed) > 50
    for pattern, _ in EXCEPTIONS:
        assert any(re.match(pattern, command) for command in printed), pattern
    assert set(RAN_IN_A_BARE_DEBIAN) <= {command.partition("#")[0].strip() for command in printed if exception(command)}


def test_a_command_that_fails_is_found():
    """What counts as a command, how far it goes, and that its failure is seen."""
    page = "text\n\n    # a.ode\n    step 1\n\n    build/fp3 run a.ode   # why\n    X=1 make a \\\n        b\n    done\n\n- x\n\n        yosys -p \"a\n          b\"\n"
    found = [[*map(str.split, commands(block))] for block in blocks(page)]
    assert found == [[["build/fp3", "run", "a.ode", "#", "why"], ["X=1", "make", "a", "\\", "b"]], [["yosys", "-p", '"a', 'b"']]]
    assert [name for block in blocks(page) for name, _ in files(block)] == ["a.ode"]


@pytest.mark.parametrize("page", PAGES)
def test_rows_have_the_columns_of_their_head(page):
    for table in re.findall(r"(?:^\|.*\n)+", (ROOT / page).read_text(encoding="utf-8"), re.M):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()}) == 1, table[:300]


# ---- examples in C ----------------------------------------------------------------------------------

HEADERS = sorted((ROOT / "sw/include/fp3").glob("*.h"))
# What an example may use without a declaration, by type. A name that it declares itself is another one.
GIVEN = {"fp3_error": "error", "fp3_status": "status", "fp3_stats": "stats", "fp3_engine_def": "engine_def", "fp3_model *": "model", "fp3_params *": "params",
         "fp3_integrator *": "integrator", "fp3_compiled *": "compiled", "fp3_program *": "program", "fp3_engine *": "engine", "fp3_image *": "image",
         "const char *": "text", "size_t": "size"}


def examples(header):
    """What stands indented in a header's comments that begin at the margin: one example each."""
    found = [re.findall(r"^ \* {5}(.*)$", comment, re.M) for comment in re.findall(r"^/\*.*?\*/", header.read_text(encoding="utf-8"), re.S | re.M)]
    found = ["\n".join(line for line in lines if not re.match(r"cc |\d+  |then |words |and last |say: ", line)) for lines in found]
    return [text for text in found if ";" in text]


EXAMPLES = [(header, number) for header in HEADERS for number in range(len(examples(header)))]


def compile_c(source):
    done = subprocess.run(["gcc", "-std=c11", "-Wall", "-Wno-unused", "-Wno-maybe-uninitialized", "-Werror", "-fsyntax-only", "-Isw/include", "-xc", "-"],
                          cwd=ROOT, input=source, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"{source}\n{done.stderr}"


def test_headers_have_examples():
    assert len(EXAMPLES) >= 14


@pytest.mark.parametrize("header, number", EXAMPLES, ids=lambda value: getattr(value, "name", value))
def test_the_example_of_a_header_compiles(header, number):
    includes = "".join(f"#include <fp3/{other.name}>\n" for other in HEADERS) + "#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n"
    given = ", ".join(f"{kind} {name}" for kind, name in GIVEN.items())
    compile_c(f"{includes}fp3_status example({given});\nfp3_status example({given}) {{\n{{\n{examples(header)[number]}\n}}\nreturn FP3_OK;\n}}\n")


def test_programs_in_pages_compile():
    """Those that need a header which a command of their page makes are compiled by such a command."""
    programs = [block for page in PAGES for block in parts(page, lambda block: [block]) if "#include <fp3/" in block]
    assert programs
    for program in programs:
        compile_c(program)
