"""The strict reader of Kanata logs takes good ones, and refuses each of these bad ones in the line that is wrong."""

import subprocess
import sys

import check
import pytest

pytestmark = pytest.mark.smoke

GOOD = """Kanata	0004
C=	7
I	0	0	1
L	0	0	3: mul a, b, c
L	0	1	object 0\\n
S	0	0	Is
C	1
E	0	0	Is
S	0	0	Mu
I	1	9	0
L	1	0	4: add d, a, b
S	1	0	Is
W	1	0	0
S	1	1	St
C	2
E	0	0	Mu
R	0	0	0
L	1	1	late
E	1	0	Is
E	1	1	St
R	1	1	1
"""


def test_a_good_log_is_understood():
    one, two = check.read(GOOD, schedulers=1, contexts=2)
    assert (one.thread, one.issued, one.ended, one.flushed) == (1, 7, 10, False)
    assert one.stages == [(0, "Is", 7, 8), (0, "Mu", 8, 10)]
    assert (one.label, one.detail) == ("3: mul a, b, c", "object 0\n")
    assert (two.thread, two.issued, two.ended, two.flushed, two.detail) == (0, 8, 10, True, "late")
    assert two.stages == [(0, "Is", 8, 10), (1, "St", 8, 10)]
    assert check.read("Kanata\t0004\nC=\t0\n") == []


# What is replaced, by what, the line that must be named, and what is said of it.
BAD = {
    "no header": ("Kanata\t0004\n", "", 1, "header"),
    "other version": ("0004", "0003", 1, "header"),
    "header with spaces": ("Kanata\t0004", "Kanata 0004", 1, "header"),
    "no last newline": ("1\t1\t1\n", "1\t1\t1", 21, "does not end"),
    "carriage return": ("C\t1\n", "C\t1\r\n", 7, "character"),
    "not ASCII": ("mul a", "mul \u00e4", 4, "character"),
    "empty line": ("C\t1\n", "C\t1\n\n", 8, "no command ''"),
    "unknown command": ("C\t1", "X\t1", 7, "no command 'X'"),
    "spaces for tabs": ("C\t1", "C 1", 7, "no command 'C 1'"),
    "too few fields": ("S\t0\t0\tMu", "S\t0\tMu", 9, "S has 2 fields, not 3"),
    "too many fields": ("C\t1", "C\t1\t1", 7, "C has 2 fields, not 1"),
    "tab in a label": ("mul a, b", "mul\ta, b", 4, "L has 4 fields, not 3"),
    "empty label": ("3: mul a, b, c", "", 4, "field 3 is empty"),
    "no number": ("I\t0\t0\t1", "I\t0\tx\t1", 3, "field 2, 'x', is no number"),
    "number with a zero in front": ("C\t1", "C\t01", 7, "'01', is no number"),
    "negative cycles": ("C\t2", "C\t-2", 15, "'-2', is no number"),
    "no cycles": ("C\t1", "C\t0", 7, "no cycle elapses"),
    "no first cycle": ("C=\t7\n", "", 2, "C= stands in the second line"),
    "second first cycle": ("C\t1", "C=\t8", 7, "C= stands in the second line"),
    "id left out": ("I\t1\t9\t0", "I\t2\t9\t0", 10, "instruction 2, expected 1"),
    "id twice": ("I\t1\t9\t0", "I\t0\t9\t0", 10, "instruction 0, expected 1"),
    "thread out of range": ("I\t0\t0\t1", "I\t0\t0\t2", 3, "thread 2 of 2"),
    "two in one cycle": ("W\t1\t0\t0\n", "I\t2\t2\t1\n", 13, "scheduler 0 starts a second instruction"),
    "label before I": ("I\t0\t0\t1\nL\t0\t0", "L\t0\t0\tx\nI\t0\t0", 3, "instruction 0 has no I"),
    "label of a stage": ("L\t0\t1", "L\t0\t2", 5, "label of type 2"),
    "two labels": ("L\t0\t1", "L\t0\t0", 5, "has a label already"),
    "no label": ("L\t0\t0\t3: mul a, b, c\n", "", 5, "instruction 0 has no label"),
    "label after R": ("L\t1\t1\tlate", "L\t0\t1\tlate", 18, "instruction 0 has ended"),
    "stage before I": ("S\t0\t0\tMu", "S\t1\t0\tMu", 9, "instruction 1 has no I"),
    "stage without E": ("E\t0\t0\tIs\n", "", 8, "stage Is of instruction 0 has no E"),
    "stage after R": ("L\t1\t1\tlate", "S\t0\t0\tWb", 18, "instruction 0 has ended"),
    "stage after a gap": ("S\t0\t0\tMu\n", "C\t1\nS\t0\t0\tMu\n", 10, "stage Mu of instruction 0 leaves a gap"),
    "late first stage": ("S\t1\t0\tIs\n", "C\t1\nS\t1\t0\tIs\n", 13, "stage Is of instruction 1 leaves a gap"),
    "long name of a stage": ("Mu", "Multiply", 9, "stage 'Multiply'"),
    "E of another stage": ("E\t0\t0\tMu", "E\t0\t0\tAd", 16, "instruction 0 is not in stage Ad"),
    "E in another lane": ("E\t0\t0\tMu", "E\t0\t1\tMu", 16, "instruction 0 is not in stage Mu"),
    "E without S": ("S\t0\t0\tMu\n", "", 15, "instruction 0 is not in stage Mu"),
    "E after R": ("L\t1\t1\tlate", "E\t0\t0\tMu", 18, "instruction 0 has ended"),
    "stage of no cycle": ("S\t0\t0\tMu\n", "S\t0\t0\tX\nE\t0\t0\tX\nS\t0\t0\tMu\n", 10, "takes no cycle"),
    "end of type 2": ("R\t0\t0\t0", "R\t0\t0\t2", 17, "end of type 2"),
    "R in a stage": ("E\t0\t0\tMu\n", "", 16, "stage Mu of instruction 0 has no E"),
    "R without a stage": ("S\t1\t0\tIs\nW\t1\t0\t0\nS\t1\t1\tSt", "R\t1\t0\t0", 12, "instruction 1 has no stage"),
    "late R": ("R\t0\t0\t0\n", "C\t1\nR\t0\t0\t0\n", 18, "ends 1 cycles after its last stage"),
    "R twice": ("R\t1\t1\t1\n", "R\t1\t1\t1\nR\t1\t1\t1\n", 22, "instruction 1 has ended"),
    "R of nothing": ("R\t1\t1\t1", "R\t2\t1\t1", 21, "instruction 2 has no I"),
    "retirements out of order": ("R\t0\t0\t0", "R\t0\t1\t0", 17, "retirement 1, expected 0"),
    "flushed ones do not count": ("R\t1\t1\t1", "R\t1\t2\t1", 21, "retirement 2, expected 1"),
    "no R": ("R\t1\t1\t1\n", "", 21, "instruction 1 has no R"),
    "dependency of another type": ("W\t1\t0\t0", "W\t1\t0\t1", 13, "dependency of type 1"),
    "dependency of nothing": ("W\t1\t0\t0", "W\t2\t0\t0", 13, "instruction 2 has no I"),
    "dependency on nothing": ("W\t1\t0\t0", "W\t1\t2\t0", 13, "instruction 2 has no I"),
    "dependency on itself": ("W\t1\t0\t0", "W\t1\t1\t0", 13, "depends on itself"),
    "dependency after R": ("L\t1\t1\tlate", "W\t0\t1\t0", 18, "instruction 0 has ended"),
    "empty": (GOOD, "", 1, "header"),
    "header alone": (GOOD, "Kanata\t0004\n", 2, "there is no C="),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_log_is_refused_in_its_line(name):
    old, new, line, said = BAD[name]
    assert old in GOOD
    with pytest.raises(check.Refused) as refused:
        check.read(GOOD.replace(old, new, 1), schedulers=1, contexts=2)
    assert refused.value.line == line and said in refused.value.why, refused.value


@pytest.mark.parametrize("text, code, said", [(GOOD, 0, "PASS"), (GOOD.replace("C\t2", "C\t-2"), 1, ":15: field 1")])
def test_the_command_says_what_it_found(root, tmp_path, text, code, said):
    (tmp_path / "x.kanata").write_text(text)
    done = subprocess.run([sys.executable, root / "tests/kanata/check.py", tmp_path / "x.kanata", "--schedulers", "1",
                           "--contexts", "2"], capture_output=True, text=True)
    assert done.returncode == code and said in done.stdout + done.stderr
