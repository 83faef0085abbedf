"""Vectors of any length, ranges, sums over them and equations for an index: they are what is written out by hand."""

import math
import re
import subprocess

import pytest
from runs import fp3

pytestmark = pytest.mark.smoke


def written(m):
    """A model without its places in the text."""
    for kind in ("exprs", "states", "params", "definitions", "invariants", "events"):
        for entry in m[kind]:
            entry.pop("line")
            entry.pop("column", None)
    return m


def pairs(text):
    """What ranges say, and by hand, side by side: (before, after) of each line with ' ==> '."""
    lines = [line.split(" ==> ") for line in text.strip().split("\n")]
    return ["\n".join(line[0] for line in lines), "\n".join(line[-1].replace("; ", "\n") for line in lines)]


SAME = [
    # components, and vectors by whole
    """step 1
state q[4] = (1, 2, 3, 4)
state v[4] = (0, 0, 0, 0)
state r[2] = (5, 6)
param k[4] = (1, 2, 3, 4)
q' = v ==> q[1]' = v[1]; q[2]' = v[2]; q[3]' = v[3]; q[4]' = v[4]
v' = -k[2]*q ==> v' = (-k[2]*q[1], -k[2]*q[2], -k[2]*q[3], -k[2]*q[4])
r[1]' = r[2] + 1 ==> r.x' = r.y + 1
r.y' = dot(q, v) ==> r.y' = q[1]*v[1] + q[2]*v[2] + q[3]*v[3] + q[4]*v[4]
exact q[2] = q[2](0) + t
""",
    # equations for an index
    """step 1
state q[5] = (i in 1..5: i^2) ==> state q[5] = (1, 4, 9, 16, 25)
state v[5] = (i in 1..5: 0) ==> state v[5] = (0, 0, 0, 0, 0)
param k[5] = (i in 1..5: i < 3 ? 1/i : 7) ==> param k[5] = (1, 1/2, 7, 7, 7)
for i in 1..5: q[i]' = v[i] ==> q[1]' = v[1]; q[2]' = v[2]; q[3]' = v[3]; q[4]' = v[4]; q[5]' = v[5]
for i in 2..4: q[i]'' = k[i]*(q[i-1] - 2*q[i] + q[i+1]) ==> q[2]'' = k[2]*(q[1] - 2*q[2] + q[3]); q[3]'' = k[3]*(q[2] - 2*q[3] + q[4]); q[4]'' = k[4]*(q[3] - 2*q[4] + q[5])
for i in 1..5, i == 1 or i == 5: q[i]'' = -k[i]*q[i] ==> q[1]'' = -k[1]*q[1]; q[5]'' = -k[5]*q[5]
for i in 1..2: exact q[i] = q[i](0) ==> exact q[1] = q[1](0); exact q[2] = q[2](0)
for i in 2..3: when q[i] < 0 and v[i] < 0: v[i] = -v[i], q[i] = 0 ==> when q[2] < 0 and v[2] < 0: v[2] = -v[2], q[2] = 0; when q[3] < 0 and v[3] < 0: v[3] = -v[3], q[3] = 0
""",
    # sums, products, largest and smallest: from the left, and the first term alone
    """step 1
n = 4
c = (1, 2, 3, 4)
state q[n] = (1, 2, 3, 4) ==> state q[4] = (1, 2, 3, 4)
q' = (i in 1..n: -q[i]) ==> q' = (-q[1], -q[2], -q[3], -q[4])
a = sum(i in 1..3: (q[i+1] - q[i])^2) ==> a = (q[2] - q[1])^2 + (q[3] - q[2])^2 + (q[4] - q[3])^2
b = sum(i in 2..2: q[i]) ==> b = q[2]
d = prod(i in 1..3: q[i]) ==> d = q[1]*q[2]*q[3]
e = sum(q) + prod(q) ==> e = (q[1] + q[2] + q[3] + q[4]) + q[1]*q[2]*q[3]*q[4]
f = max(q) - min(i in 1..3: c[i]*q[i]) ==> f = max(max(max(q[1], q[2]), q[3]), q[4]) - min(min(c[1]*q[1], c[2]*q[2]), c[3]*q[3])
g = sum(i in 1..2: sum(j in 1..i: q[i]*q[j])) ==> g = q[1]*q[1] + (q[2]*q[1] + q[2]*q[2])
h1 = sum(i in 1..3: sum(j in 1..3, j != i: q[i] - q[j])) ==> h1 = (q[1] - q[2] + (q[1] - q[3])) + (q[2] - q[1] + (q[2] - q[3])) + (q[3] - q[1] + (q[3] - q[2]))
s = (i in 1..2: sum(j in 1..0: q[j]/0) + prod(j in 1..i-1: q[j])) ==> s = (0 + 1, 0 + q[1])
w = sum(i in 1..2: (q[i], -q[i])) ==> w = (q[1], -q[1]) + (q[2], -q[2])
x = sum(i in -1..1: i*q[i+2]) ==> x = -1*q[1] + 0*q[2] + 1*q[3]
y = sum(i in 1..3: c[i]*q[1]^(i - 1)) ==> y = c[1]*q[1]^0 + c[2]*q[1]^1 + c[3]*q[1]^2
invariant z = sum(i in 1..n-1: q[i]*q[i + 1]) ==> invariant z = q[1]*q[2] + q[2]*q[3] + q[3]*q[4]
""",
    # conditions on indices: the choice that is not taken does not count
    """step 1
state q[4] = (1, 2, 3, 4)
state u[4] = (i in 1..4: i == 2 ? 9 : 1/(i - 2)) ==> state u[4] = (1/(1-2), 9, 1/(3-2), 1/(4-2))
for i in 1..4: q[i]' = (i > 1 ? q[i-1] : 0) - (i < 4 ? q[i+1] : 0) ==> q[1]' = 0 - q[2]; q[2]' = q[1] - q[3]; q[3]' = q[2] - q[4]; q[4]' = q[3] - 0
for i in 1..4: u[i]' = sum(j in 1..4: i == j ? 0 : q[j]/(i - j)) ==> u[1]' = 0 + q[2]/(1-2) + q[3]/(1-3) + q[4]/(1-4); u[2]' = q[1]/(2-1) + 0 + q[3]/(2-3) + q[4]/(2-4); u[3]' = q[1]/(3-1) + q[2]/(3-2) + 0 + q[4]/(3-4); u[4]' = q[1]/(4-1) + q[2]/(4-2) + q[3]/(4-3) + 0
a = sum(i in 1..2: select(i < 2, q[i], q[i + 1]*q[i + 2])) ==> a = q[1] + q[3]*q[4]
c = sum(i in 1..2: i < 2 ? 1 : max(q) + dot(u, u) + select(i, u[i], u[7])) ==> c = 1 + (max(max(max(q[1], q[2]), q[3]), q[4]) + dot(u, u) + u[2])
b = sum(i in 1..2: i < 2 ? (q[i] > 1 ? q[i] : q[i + 1]) : q[i]) ==> b = (q[1] > 1 ? q[1] : q[2]) + q[2]
""",
    # two indices in one vector; names that are free again; ranges in brackets and over lines
    """step 1
m = 2
state u[m*3] = (j in 1..6: j) ==> state u[6] = (1, 2, 3, 4, 5, 6)
for i in 1..m: for j in 1..3: u[3*(i - 1) + j]' = i*10 + j ==> u[1]' = 1*10 + 1; u[2]' = 1*10 + 2; u[3]' = 1*10 + 3; u[4]' = 2*10 + 1; u[5]' = 2*10 + 2; u[6]' = 2*10 + 3
a = sum(i in 1..2: u[i]) + sum(i in 3..m + 2: u[i]) ==> a = (u[1] + u[2]) + (u[3] + u[4])
param i = 3
d = (u - (k in 1..6: k))[1] ==> d = 1
""".replace("d = (u - (k in 1..6: k))[1] ==> d = 1\n", "when sum(u) > 1: u = (k in 1..6: -u[k]) ==> when u[1] + u[2] + u[3] + u[4] + u[5] + u[6] > 1: u = (-u[1], -u[2], -u[3], -u[4], -u[5], -u[6])\n"),
]


@pytest.mark.parametrize("text", SAME)
def test_ranges_are_what_is_written_out(model, text):
    short, long = (written(model(t)) for t in pairs(text))
    for kind in ("states", "params", "definitions", "invariants", "events"):
        names = [entry.get("name") for entry in short[kind]]
        assert names == [entry.get("name") for entry in long[kind]]
        for name in filter(None, names):
            a, b = short.named(kind, name), long.named(kind, name)
            for key in a:
                if key in ("derivative", "exact", "expr") and a[key] is not None:
                    assert folded(short, a[key]) == folded(long, b[key]), name
                else:
                    assert a[key] == b[key], name
    for a, b in zip(short["events"], long["events"], strict=True):
        assert folded(short, a["condition"]) == folded(long, b["condition"])
        assert [(n, folded(short, e)) for n, e in a["sets"]] == [(n, folded(long, e)) for n, e in b["sets"]]


def folded(m, i):
    """An expression in prefix form, with the values of what is made of numbers alone."""
    e = m["exprs"][i]
    inner = [folded(m, o) for o in e["operand"] if o is not None]
    if e["op"] == "NUMBER" or (inner and all(isinstance(x, float) for x in inner)):
        return float(e["value"])
    return [e["op"], *inner] if inner else m.text(i)


def test_the_page_of_the_language(model, root):
    page = (root / "docs" / "models.md").read_text().split("## Ranges\n")[1]
    m = model("".join(line[4:] + "\n" for line in page.split("\n\n")[0].split("\n")))
    assert (len(m["states"]), len(m["params"]), m.definition("n")) == (10, 6, "5")


@pytest.mark.parametrize("first", ["", "step 1 [s]\n", "c = 2\nstep 1 [s]\n"])
def test_numbers_that_are_defined_take_the_unit_of_a_value(model, first):
    m = model(first + "n = 5\nk = (n, sqrt(2*n))\nparam p = sin(n/2) [kg]\nstate q[2] = k [m]\nq' = (0, 0)\n" + ("" if first else "step 1 [s]\n"))
    assert [s["value"] for s in m["states"]] == [5, 10**0.5]


def test_names_of_components(model):
    m = model("step 1\nstate q[4] = (1, 2, 3, 4)\nstate r[3] = (1, 2, 3)\nparam k[12] = (i in 1..12: i)\nq' = (0, 0, 0, 0)\n"
              "r' = (0, 0, 0)\nc = q - q\ninvariant d = (k, 1)[1]\n".replace("(k, 1)[1]", "k[12]"))
    assert [s["name"] for s in m["states"]] == "q_1 q_2 q_3 q_4 r_x r_y r_z".split()
    assert [(p["name"], p["value"]) for p in m["params"]] == [(f"k_{i}", i) for i in range(1, 13)]
    assert [d["name"] for d in m["definitions"]] == "c_1 c_2 c_3 c_4".split()


def test_the_text_of_a_range_is_the_place_of_its_expressions(model):
    m = model("step 1\nstate q[3] = (1, 2, 3)\n\nfor i in 1..3:\n  q[i]' = 2*q[i]\n")
    places = {(e["line"], e["column"]) for e in m["exprs"] if e["op"] in ("MUL", "STATE")}
    assert places == {(5, 12), (5, 13)}
    assert m.derivative("q_y") == "(MUL 2 q_y)"


@pytest.mark.parametrize("text, value", [
    ("sum(i in 1..4: 1/i)", 1 + 1 / 2 + 1 / 3 + 1 / 4), ("prod(i in 1..5: i)", 120), ("max(i in 1..3: -i)", -1),
    ("sum((1, 2, 3, 4))", 10), ("norm((i in 1..4: 1))", 2), ("min((3, 2, 4))", 2), ("sum(i in 1..0: 1)", 0),
    ("sum(i in 1..3: i == 2 ? 0/0 : 1) > 0 ? 1 : 2", 2), ("1 ? 3 : 0/0", 3),
    ("sum(i in 1..100: sum(j in 1..10, i < j: i*j))", sum(i * j for i in range(101) for j in range(11) if i < j)),
])
def test_constants_of_ranges(constant, text, value):
    got = constant(text)
    assert (got.returncode, got.stderr) == (0, "")
    assert float(got.stdout) == pytest.approx(value, rel=1e-15) or (text.startswith("sum(i in 1..3: i == 2") and got.stdout)


# ---- errors -------------------------------------------------------------------------------------

BEFORE = """\
step 0.1 [s]
state q[5] = (1, 2, 3, 4, 5) [m]
state u = 0 [m/s]
state r[2] = (1, 0)
param k[4] = (1, 2, 3, 4) [1/s]
param c = 5
q' = (i in 1..5: u)
u' = u/t
r' = r/t
n = 4
"""
LINE = BEFORE.count("\n") + 1
KNOWN = "expected numbers and indices, which are known while the text is read"

WRONG = [
    # an index
    ("a = q[6]", 7, "'6'", "expected an index from 1 to 5 for 'q' (this is 6)"),
    ("a = q[0]", 7, "'0'", "expected an index from 1 to 5 for 'q' (this is 0)"),
    ("a = r[3]", 7, "'3'", "expected an index from 1 to 2 for 'r' (this is 3)"),
    ("a = q[n + 2]", 7, "'n'", "expected an index from 1 to 5 for 'q' (this is 6)"),
    ("a = q[1.5]", 7, "'1.5'", "expected a whole number of at most 1000000 (this is 1.5)"),
    ("a = q[0/0]", 7, "'0'", "expected a whole number of at most 1000000 (this is -nan)"),
    ("a = q[1e9]", 7, "'1e9'", "expected a whole number of at most 1000000 (this is 1e+09)"),
    ("a = q[c]", 7, "'c'", KNOWN),
    ("a = q[u]", 7, "'u'", KNOWN),
    ("a = q[t]", 7, "'t'", "expected a value that is known before the start (t is the time since then)"),
    ("a = q[(1, 2)]", 7, "'('", "expected a number (this is a vector of 2)"),
    ("a = q[1", 8, "end of file", "expected an operator or ']'"),
    ("a = q[]", 7, "']'", "expected a number, a name or '('"),
    ("a = q[i]", 7, "'i'", "expected a name that is defined above"),
    ("a = q.x", 5, "'q.x'", "expected a component from q[1] to q[5]"),
    ("a = u[1]", 6, "'['", "expected an operator ('u' is not a vector)"),
    ("a = r.x[1]", 8, "'['", "expected an operator ('r.x' is not a vector)"),
    ("a = q [1]", 7, "'['", "expected an operator or the end of the line"),
    ("q[1] = 3", 6, "'='", "expected ' or '' after 'q[..]'"),
    ("exact q[6] = 3", 9, "'6'", "expected an index from 1 to 5 for 'q' (this is 6)"),
    ("when u > 1: q[0] = 1", 15, "'0'", "expected an index from 1 to 5 for 'q' (this is 0)"),
    # ranges
    ("a = sum(i in 1..6: q[i])", 22, "'i'", "expected an index from 1 to 5 for 'q' (this is 6) (where i = 6)"),
    ("a = sum(i in 1..3: sum(j in i..3: k[i + j]))", 37, "'i'",
     "expected an index from 1 to 4 for 'k' (this is 5) (where i = 2, j = 3)"),
    ("for i in 1..3: exact q[i + 3] = q[i](0)", 24, "'i'", "expected an index from 1 to 5 for 'q' (this is 6) (where i = 3)"),
    ("a = sum(i in 1..n)", 18, "')'", "expected an operator, ':' or ',', as in `1..4: ` or `1..4, i != j: ` (where i = 1)"),
    ("a = sum(i in 1: q[i])", 15, "':'", "expected an operator or '..', as in i in 1..4"),
    ("a = sum(i in 1..c: q[i])", 17, "'c'", KNOWN),
    ("a = sum(i in 4..1: q[i])", 17, "'1'", "expected a last number of at least 3 (4..3 has none)"),
    ("a = sum(i in 1..2.5: q[i])", 17, "'2.5'", "expected a whole number of at most 1000000 (this is 2.5)"),
    ("a = sum(u in 1..2: q[u])", 9, "'u'", "expected a new name (line 3 declares this one)"),
    ("a = sum(t in 1..2: q[t])", 9, "'t'", "expected another name ('t' is the time)"),
    ("a = sum(i in 1..2: sum(i in 1..2: q[i]))", 24, "'i'", f"expected a new name (line {LINE} declares this one) (where i = 1)"),
    ("a = sum(i in 1..3, q[i] > 0: q[i])", 20, "'q'", KNOWN + " (where i = 1)"),
    ("a = sum(i in 1..3: q[i]) + i", 28, "'i'", "expected a name that is defined above"),
    ("a = sum(i in 1..3: x)", 20, "'x'", "expected a name that is defined above (where i = 1)"),
    ("a = sum(i in 1..3: i > 1 ? x : 1)", 28, "'x'", "expected a name that is defined above (where i = 1)"),
    ("a = sum(u)", 5, "'sum'", "expected a vector for 'sum' (this is a number)"),
    ("a = sum(r, r)", 10, "','", "expected an operator or ')' ('sum' has 1 argument)"),
    ("a = max(i in 1..0: u)", 5, "'max'", "expected a term for 'max' (there is none)"),
    ("a = (i in 1..0: u)", 5, "'('", "expected a vector of 2 to 64 (this has 0 components)"),
    ("a = (i in 1..65: u)", 5, "'('", "expected a vector of 2 to 64 (this has 65 components)"),
    ("a = (i in 1..2: r)", 5, "'('", "expected a vector of numbers (there is a vector of 2 in it) (where i = 1)"),
    ("a = cross(k, k)", 5, "'cross'", "expected two vectors of 2 or 3 for 'cross' (these are vectors of 4)"),
    ("a = dot(q, k)", 5, "'dot'", "expected two vectors of the same size for 'dot' (these are a vector of 5 and a vector of 4)"),
    ("for i in 1..3: a = i", 16, "'a'", "expected an equation q[i]' = ..., exact, when, at, project or for (where i = 1)"),
    ("for q[1]' = 3", 5, "'q'", "expected an index and its range, as in `for i in 1..4: q[i]' = ...`"),
    ("for i in 1..2: exact q[i] = 1 2", 31, "'2'", "expected an operator or the end of the line"),
    ("for i in 1..2: exact q[1] = 1", 22, "'q'", f"expected only one equation like this (line {LINE} has another) (where i = 2)"),
    # units
    ("a = sum(i in 1..3: q[i]*(i > 2 ? k[i] : 1))", 5, "'sum'",
     "expected two values with the same unit (these are in [m] and [m/s]) (where i = 3)"),
    ("a = sum(i in 1..3: u + q[i])", 22, "'+'", "expected two values with the same unit (these are in [m/s] and [m]) (where i = 1)"),
    ("a = sum(i in 1..3: u + q[1]^i*k[1])", 22, "'+'",
     "expected two values with the same unit (these are in [m/s] and [m^2/s]) (where i = 2)"),
    ("for i in 2..3: exact q[i] = q[i](0)*t^(i - 2)", 22, "'q'",
     "expected a closed form in [m] (its right side is in [s*m]) (where i = 3)"),
    ("for i in 1..2: when u < 0: q[i] = i > 1 ? u : q[1]", 28, "'q'",
     "expected a value in [m] (its right side is in [m/s]) (where i = 2)"),
    # names
    ("state q_3 = 1", 7, "'q_3'", "expected a new name (the components of 'q', line 2, would share it)"),
    ("state v_2 = 1\nstate v[4] = (1, 2, 3, 4)", 7, "'v'", "expected a new name (the components of 'v', line 11, would share it)"),
    ("param " + "a" * 30 + "[4] = 1", 7, "'" + "a" * 30 + "'", "expected a name of at most 29 characters"),
    ("param " + "a" * 29 + "[10] = 1", 7, "'" + "a" * 29 + "'", "expected a name of at most 28 characters"),
    ("param in = 1", 7, "'in'", "expected a name ('in' has a meaning of its own)"),
    ("param sum = 1", 7, "'sum'", "expected a name ('sum' has a meaning of its own)"),
    ("param p[4.5] = (1, 2, 3, 4)", 9, "'4.5'", "expected a whole number of at most 1000000 (this is 4.5)"),
    ("param p[4] = (1, 2, 3)", 14, "'('", "expected a vector of 4 (this is a vector of 3)"),
]


@pytest.mark.parametrize("line, column, found, expected", WRONG)
def test_each_error_says_where_and_for_which_index(errors, line, column, found, expected):
    report = errors(BEFORE + line)
    assert f"in.ode:{LINE + line.count(chr(10))}:{column}: error: found {found}, {expected}" in report.split("\n")
    places = [entry for entry in report.split("\n") if entry.startswith("in.ode:")]
    assert len(places) == 1 or "1]" in line or "t in" in line or "state" in line or "param" in line, report


def test_reading_goes_on_behind_a_range(errors):
    report = errors("step 1\nstate q[4] = (1, 2, 3, 4)\na = sum(i in 1..5: q[i]\nq[2]' = b\n"
                    "for i in 1..4, i != 2: q[i]' = d\nfor i in 1..4: q[i]' = 1\nfor i in 5..5: q[i]' = (1\nspan x\n")
    assert [line.split(": error")[0] for line in report.split("\n") if line.startswith("in.ode:")] == [
        "in.ode:3:22", "in.ode:4:1", "in.ode:4:9", "in.ode:5:32", "in.ode:6:16", "in.ode:7:18", "in.ode:8:1", "in.ode:8:6"]


SMALL = "step 1\nstate x = 0\nx' = 1\n"


@pytest.mark.parametrize("text, limit, message", [
    (lambda n: f"step 1\nstate q[{n}] = (i in 1..{n}: 0)\nfor i in 1..{n}: q[i]' = 1\n", 64, "expected a number from 2 to 64"),
    (lambda n: f"step 1\nstate q[4] = (i in 1..4: 0)\nq' = q\nstate u[{n}] = (i in 1..{n}: 0)\nu' = u", 60, "expected at most 64 states"),
    (lambda n: SMALL + "a = " + "".join(f"sum(i{k} in 1..1: " for k in range(n)) + "x" + ")" * n, 8,
     "expected at most 8 indices, one within the other"),
    (lambda n: SMALL + f"a = sum(i in 1..{n // 2}: x)\n", 4096, "expected a model of at most 4096 numbers, names and operations"),
    (lambda n: SMALL + f"for i in 1..{n}: when x > 1: x = 0\n", 64, "expected at most 64 events"),
    (lambda n: SMALL + f"for i in 1..1: when x > 1: x = 0{' ' * n}\n", 10 ** 6, None),
    (lambda n: SMALL + f"for i in 1..{n + 1}, i < 0:{' ' * 986}exact x = 1", 4194304 // 1005,
     "expected sums and equations that repeat at most 4194304 bytes of text"),
])
def test_limits(model, errors, text, limit, message):
    model(text(limit))
    if message:
        assert message in errors(text(limit + (2 if limit == 4096 else 1))).split("\n")[0]


@pytest.mark.parametrize("body", ["sum(i in 1..1000000: " * 7, "(i in 1..1000000, i < 0: (j in 1..1000000: ", "sum(i in 1..1000000, i < 0: 1) + ",
                                  "(sum(i in 1..9: " * 300, "sum(i in 1..1000000: q)" + "+1" * 1000])
def test_what_never_ends_is_refused(errors, body):
    assert errors(SMALL + "a = " + body)
    assert errors(SMALL + "for i in 1..1000000: x' = " + body)


# ---- what reads models --------------------------------------------------------------------------

CHAIN = """\
model chain
state q[5] = (i in 1..5: i == 1 ? 0.5 : 0)
state v[5] = (i in 1..5: 0)
param k[6] = (i in 1..6: 1)
step 0.0625
span 1
q' = v
for i in 1..5: q[i]'' = k[i]*((i > 1 ? q[i-1] : 0) - q[i]) + k[i+1]*((i < 5 ? q[i+1] : 0) - q[i])
invariant energy = dot(v, v)/2 + sum(i in 1..6: k[i]*((i < 6 ? q[i] : 0) - (i > 1 ? q[i-1] : 0))^2)/2
when q[3] > 0.09: q[3] = 0.5, v = (i in 1..5: i*0)
"""


def test_what_reads_models_takes_their_scalars(tmp_path):
    chain = tmp_path / "chain.ode"
    chain.write_text(CHAIN)
    lone = tmp_path / "lone.ode"
    lone.write_text(CHAIN.split("when")[0])
    run = ("run", lone, "-c", "many_full", "-n", 16)
    csv = tmp_path / "out.csv"
    assert "q_3" in fp3(*run, "--set", "q_3=0.25", "--set", "k_6=2", "--spread", "q_2=0:1", "-N", 3, "--observe", "energy,q_3,q_5",
                        "--output", csv).stdout
    assert {"energy", "q_3", "q_5"} < set(csv.read_text().replace("\n", ",").split(","))
    assert fp3("compile", lone, "--observe", "q_3").stdout.count("q_3") > 0
    assert "chain" in fp3("compare", lone, "-i", "rk4").stdout
    scene = tmp_path / "a.scene"
    scene.write_text('config = "many_full"; steps = 4;\ngroups = ( { program = "chain.ode"; objects = 2; '
                     'set = { q_3 = "2*sum(i in 1..2: k_2*i)"; k_2 = 2.0; }; spread = { q_4 = [0.0, 1.0]; }; } );\n')
    out = fp3("run", "--scene", scene).stdout
    assert "q_3" in out and "q_4" in out


# ---- models of vectors --------------------------------------------------------------------------


def by_hand(cells):
    """The ladder of programs/rc_ladder.ode, without vectors: scalars that have the names of its components."""
    states = "".join(f"state u_{i} = 0 [V]\n" for i in range(1, cells + 1))
    inner = "".join(f"u_{i}' = r*(u_{i - 1} - 2*u_{i} + u_{i + 1})\n" for i in range(2, cells))
    return states + f"r = 1/(R*C)\nu_1' = r*(U - 2*u_1 + u_2)\n{inner}u_{cells}' = r*(u_{cells - 1} - u_{cells})\n"


@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_a_program_of_vectors_is_that_of_their_scalars_word_for_word(root, tmp_path, config):
    vectors = (root / "programs/rc_ladder.ode").read_text()
    head = vectors.split("state u[8]")[0] + "step 0.000244140625 [s]\nspan 0.125 [s]\n"
    paths = [tmp_path / name / "rc_ladder.ode" for name in ("vectors", "scalars")]
    for path, text in zip(paths, (vectors, head + by_hand(8))):
        path.parent.mkdir()
        path.write_text(text)
    programs = [fp3("compile", path, "-c", config).stdout for path in paths]
    assert programs[0] == programs[1] and "u_8" in programs[0]


MODELS = ["five_bodies", "hires", "rod", "toda"]
HIRES = [0.7371312573325668e-3, 0.1442485726316185e-3, 0.5888729740967575e-4, 0.1175651343283149e-2, 0.2386356198831331e-2,
         0.6238968252742796e-2, 0.2849998395185769e-2, 0.2850001604814231e-2]


@pytest.fixture
def truth(build, root):
    def at(name, time):
        path = root / "tests/ode/vectors" / f"{name}.ode"
        lines = subprocess.run([build / "tests/models", "truth", path, repr(time)], capture_output=True, text=True, check=True,
                               timeout=60).stdout.splitlines()
        return {line.split()[0]: float(line.split()[1]) for line in lines}

    return at


@pytest.mark.parametrize("name", MODELS)
def test_invariants_are_constant(truth, name):
    start = truth(name, 0.0)
    invariants = [k for k in start if "_" not in k or k.startswith("momentum_")]
    assert invariants
    for time in (1.0, 4.0):
        now = truth(name, time)
        for k in invariants:
            assert now[k] == pytest.approx(start[k], rel=1e-10, abs=1e-12), k


def test_reactions_end_where_they_should(truth):
    """The reference solution of F. Mazzia and C. Magherini, Test Set for Initial Value Problem Solvers, 2.4 (2008): HIRES."""
    got = truth("hires", 321.8122)
    assert [got[f"y_{i}"] for i in range(1, 9)] == pytest.approx(HIRES, rel=1e-8)


def test_a_rod_cools_by_its_modes(truth):
    got = truth("rod", 2.0)
    for i in range(1, 17):
        modes = [a * math.cos(math.pi * m * (i - 0.5) / 16) * math.exp(-32 * math.sin(math.pi * m / 32) ** 2 * 2)
                 for m, a in enumerate((20, 5, 0, 2))]
        assert got[f"u_{i}"] == pytest.approx(sum(modes), rel=1e-13)


def ring(_, z):
    p, q = z[:8], z[8:]
    f = [math.exp(q[i] - q[(i + 1) % 8]) for i in range(8)]
    return [f[i - 1] - f[i] for i in range(8)] + list(p)


def planets(_, z):
    vx, vy, x, y = z[:5], z[5:10], z[10:15], z[15:]
    m, a = (1, 1e-3, 2e-3, 1e-3, 5e-4), [0.0] * 10
    for i in range(5):
        for j in range(5):
            if i != j:
                d = ((x[j] - x[i]) ** 2 + (y[j] - y[i]) ** 2) ** 1.5
                a[i] += m[j] * (x[j] - x[i]) / d
                a[i + 5] += m[j] * (y[j] - y[i]) / d
    return [*a, *vx, *vy]


@pytest.mark.parametrize("name, equations, invariants", [("toda", ring, 3), ("five_bodies", planets, 4)])
def test_a_solver_of_others_agrees(truth, name, equations, invariants):
    integrate = pytest.importorskip("scipy.integrate")
    start, end = (list(truth(name, t).values())[:-invariants] for t in (0.0, 4.0))
    done = integrate.solve_ivp(equations, (0, 4), start, method="DOP853", rtol=1e-12, atol=1e-12)
    assert list(done.y[:, -1]) == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize("name, integrator, steps, off", [("five_bodies", "verlet", 128, 0.02), ("toda", "rk4", 256, 1e-5),
                                                          ("rod", "rkc6_damped", 64, 0.01), ("hires", "rk4", 1024, 1e-5)])
def test_the_machine_is_near(truth, root, name, integrator, steps, off):
    got = fp3("run", root / "tests/ode/vectors" / f"{name}.ode", "-c", "many_full", "-e", "isa", "-N", 1, "-i", integrator, "--set",
              f"h={4 / steps}", "--steps", steps).stdout
    found = {name: float(value) for name, value in re.findall(r"^(\w+) +(\S+) +0x[0-9a-f]{8} +object 0$", got, re.M)}
    expected = truth(name, 4.0)
    assert len(found) >= 8 and found == pytest.approx({state: expected[state] for state in found}, abs=off)
