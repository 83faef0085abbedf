"""`make mutate-c`: a change that a test sees is killed, one from which the compiler makes the same is equivalent, and what nobody sees is open."""

import json
import subprocess
import sys
import tomllib

import pytest

SUM = """#include <stdint.h>
#include <stdlib.h>
static int within(int a, int from, int to) { return a >= from && a < to; }
int main(int argc, char **argv) {
    int sum = 0;
    const unsigned one = argc > 1;
    for (int i = 0; i < 10; i++) {
        if (within(i, 2, 5))
            sum += i * 3;
        sum += one & 0;
    }
    return sum != (argc > 1 ? atoi(argv[1]) : 27);
}
"""


@pytest.fixture(scope="module")
def mutated(root, tmp_path_factory):
    """A small program with all its mutants, and what they are."""
    sys.path.insert(0, str(root / "tools"))
    folder = tmp_path_factory.mktemp("mutants")
    found = subprocess.run([root / ".venv/bin/python", "-c", "import dataclasses, json, pathlib, sys; sys.path.insert(0, 'tools'); from fp3cmutants import sites\n"
                            "changed = sites.Changed('sum.c', sys.stdin.buffer.read(), 0)\nfolder = pathlib.Path(sys.argv[1])\n"
                            "(folder / 'sum.c').write_bytes(sites.BEFORE.encode() + changed.out)\n"
                            "(folder / 'beside.c').write_text(sites.BESIDE.replace('COUNT', str(len(changed.mutants))))\n"
                            "print(json.dumps([mutant.text for mutant in changed.mutants]))", folder], cwd=root, input=SUM.encode(), capture_output=True, check=True)
    subprocess.run(["gcc", "-std=c11", "-D_GNU_SOURCE", "-Wall", "-Werror", "-O1", "-o", folder / "sum", folder / "sum.c", folder / "beside.c"], check=True)
    return folder / "sum", json.loads(found.stdout)


def seen(mutated, *arguments):
    """The changes that the program, which tests itself, sees."""
    program, texts = mutated
    return {text for number, text in enumerate(texts) if subprocess.run([program, *arguments], env={"FP3_MUTANT": str(number)}).returncode}


def test_every_kind_of_change_is_seen(mutated):
    assert subprocess.run([mutated[0]]).returncode == 0
    assert {">= -> > in a >= from", "< -> <= in a < to", "a >= from && a < to -> a >= from", "a >= from && a < to -> a < to", "* -> + in i * 3",
            "2 -> 2 + 1", "3 -> 3 + 1", "sum += i * 3; -> ;", "+= -> -= in sum += i * 3", "!= -> == in sum != (argc > 1 ? atoi(argv[1]) : 27)"} <= seen(mutated)


def test_what_changes_nothing_is_not_seen(mutated):
    assert {"sum += one & 0; -> ;", "< -> <= in i < 10"} <= set(mutated[1]) - seen(mutated)


def test_a_test_that_looks_at_nothing_sees_nothing(mutated, tmp_path):
    """Programs tell which changes they reached."""
    subprocess.run([mutated[0]], env={"FP3_MUTANTS_SEEN": str(tmp_path)}, check=True)
    reached = next(tmp_path.iterdir()).read_bytes()
    assert [text for text, is_reached in zip(mutated[1], reached, strict=True) if not is_reached] == ["1 -> 1 + 1"]        # of argv[1]
    assert not seen(("/bin/true", mutated[1]))


PART = """[[part]]
name = "records"
files = ["sw/machine/narrow.c"]
rungs = ["{rung}"]
"""


def measured(root, tmp_path, rung):
    (tmp_path / "list.toml").write_text(PART.format(rung=rung))
    done = subprocess.run([root / ".venv/bin/python", "tools/mutate_c.py", "--list", tmp_path / "list.toml", "--count", "8", "--output", tmp_path / "m.json"],
                          cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    row, = json.loads((tmp_path / "m.json").read_text())["modules"]
    assert row["killed"] + row["equivalent"] + row["open"] == row["mutants"] == 8 and len(row["holes"]) == row["open"]
    return row, done.stderr + done.stdout


def test_some_changes_of_the_project(root, build, tmp_path):
    """A few by chance. A test of other things sees none."""
    row, said = measured(root, tmp_path, "tests/narrow 7 1 1 3000")
    assert row["killed"] >= 3, said
    row, said = measured(root, tmp_path, "tests/visit")
    assert row["killed"] == 0 and all(hole["why"] == "not reached" for hole in row["holes"]), said


@pytest.mark.parametrize("words, said", [(("--parts", "engine"), "no part 'engine'"), (("--count", "-1"), "expected --count 0 or more")])
def test_refused(root, words, said):
    done = subprocess.run([root / ".venv/bin/python", "tools/mutate_c.py", *words], cwd=root, capture_output=True, text=True)
    assert done.returncode == 2 and said in done.stderr


def test_what_is_listed_is_there(root):
    for part in tomllib.loads((root / "tests/mutants.toml").read_text())["part"]:
        for path in [*part["files"], *(word.split()[1] for word in part["rungs"] if word.startswith("pytest"))]:
            assert (root / path).exists(), path
