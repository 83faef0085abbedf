"""`kind`: what a model reads of objects of another group. What it becomes, what each error says and where, and who may not give its words."""

import subprocess

import pytest

pytestmark = pytest.mark.smoke

BEFORE = """\
step 0.1 [s]
kind balls(x[2] [m], R [m], q[4])
shared R0 = 0.1 [m]
param k = 2 [1/s]
state x[2] = (0, 0) [m]
state u = 0 [m]
x' = -k*x
"""
LINE = BEFORE.count("\n") + 1
WORDS = "expected a word of kind 'balls': x, R, q"
VALUE = "expected a value (a word of a kind is one of a neighbour, as in o.x)"
NEAR = "near touch(x, balls.x, R0)\n"

WRONG = [
    # kind
    ("kind", 5, "end of file", "expected a name, as in kind balls(x[2] [m], R [m])"),
    ("kind c", 7, "end of file", "expected '(' and what is read of such an object, as in kind c(x [m])"),
    ("kind c()", 8, "')'", "expected a word of such an object, as in kind balls(x[2] [m], R [m])"),
    ("kind c(q q)", 10, "'q'", "expected ',' or ')'"),
    ("kind c(q = 3)", 10, "'='", "expected ',' or ')' (a word of a kind has no value here)"),
    ("kind c(q.x)", 8, "'q.x'", "expected a name without a '.'"),
    ("kind c(q[1])", 10, "'1'", "expected a number from 2 to 64, the size of a vector"),
    ("kind c(q[65])", 10, "'65'", "expected a number from 2 to 64, the size of a vector"),
    ("kind c(q [m)", 12, "')'", "expected '*', '/' or ']'"),
    ("kind c(q, q)", 11, "'q'", "expected another word ('c' has this one)"),
    ("kind balls(q)", 6, "'balls'", "expected a new name (line 2 declares this one)"),
    ("kind x(q)", 6, "'x'", "expected a new name (line 5 declares this one)"),
    ("kind sin(q)", 6, "'sin'", "expected a name ('sin' has a meaning of its own)"),
    ("state kind = 1", 7, "'kind'", "expected a name ('kind' has a meaning of its own)"),
    ("knd c(q)", 1, "'knd'", "expected a statement (did you mean 'kind'?)"),
    ("kind c(" + "q" * 30 + ")", 8, "'" + "q" * 30 + "'", "expected a shorter name ('c_" + "q" * 30 + "' would have 32 characters, of 31)"),
    ("kind c(" + "q" * 28 + "[2])", 8, "'" + "q" * 28 + "'", "expected a shorter name ('c_" + "q" * 28 + "_x' would have 32 characters, of 31)"),
    ("param c_q = 1\nkind c(q)", 8, "'q'", f"expected another word ('c_q' of line {LINE} has the name 'c_q')"),
    ("param c_q_y = 1\nkind c(q[2])", 8, "'q'", f"expected another word ('c_q_y' of line {LINE} has the name 'c_q')"),
    ("kind c(q)\nparam c_q = 1", 7, "'c_q'", f"expected a new name (line {LINE} declares this one)"),
    ("kind c(q[2])\nstate c_q_y = 1", 7, "'c_q_y'", f"expected a new name (the components of 'c_q', line {LINE}, would share it)"),
    ("kind c(q[57])", 8, "'q'", "expected at most 64 params, shared ones and words of kinds included"),
    ("\n".join(f"kind c{i}(q)" for i in range(8)), 6, "'c7'", "expected at most 8 kinds"),
    # relations
    ("near touch(x, balls, R0)", 15, "'balls'", "expected their position, a word of the kind, as in balls.x"),
    ("near touch(x, bals.x, R0)", 15, "'bals.x'", "expected a kind (did you mean 'balls'?)"),
    ("near touch(x, cats.x, R0)", 15, "'cats.x'", "expected a kind that is declared above, as in kind cats(x [m])"),
    ("near touch(x, balls.y, R0)", 21, "'y'", WORDS),
    ("near touch(x, balls.R, R0)", 15, "'balls.R'", "expected a position as the own one is, a vector of 2 (this is a number)"),
    ("near touch(x, balls.x)", 22, "')'", "expected ',' and the reach"),
    ("state w = 1 [s]\nnear touch(w, balls.R, R0)", 15, "'balls.R'", "expected a position in the unit of 'w'"),
    ("near touch(x, balls.x, R0, R = 0)", 28, "'R'", "expected a new name (kind 'balls' has such a word)"),
    ("links ties(bals)", 12, "'bals'", "expected a kind (did you mean 'balls'?)"),
    ("links ties(k)", 12, "'k'", "expected a kind that is declared above, as in kind k(x [m])"),
    ("links ties(balls.x)", 12, "'balls.x'", "expected the kind alone"),
    ("links ties(balls, R = 1)", 19, "'R'", "expected a new name (kind 'balls' has such a word)"),
    ("links ties(balls, balls)", 19, "'balls'", "expected a new name (line 2 declares this one)"),
    ("all suns()", 10, "')'", "expected a kind, as in all suns(planets)"),
    ("all suns(bals)", 10, "'bals'", "expected a kind (did you mean 'balls'?)"),
    ("all suns(balls, e = 1)", 15, "','", "expected ')'"),
    # terms
    (NEAR + "p = sum(o in touch: o.v)", 23, "'v'", WORDS),
    (NEAR + "p = sum(o in touch: o.R0)", 23, "'R0'", WORDS + " (did you mean 'R'?)"),
    (NEAR + "p = sum(o in touch: o.k)", 23, "'k'", WORDS),
    (NEAR + "p = sum(o in touch: o.x.z)", 23, "'x.z'", "expected a component .x or .y of it"),
    (NEAR + "p = sum(o in touch: o.q[5])", 25, "'5'", "expected an index from 1 to 4 for 'q' (this is 5)"),
    (NEAR + "p = sum(o in touch: o.R.x)", 23, "'R.x'", "expected 'R' without a component (it is not a vector)"),
    (NEAR + "p = sum(o in touch: o.R + o.x)", 25, "'+'", "expected two numbers, or two vectors of the same size (these are a number and a vector of 2)"),
    (NEAR + "p = sum(o in touch: balls_R)", 21, "'balls_R'", VALUE),
    (NEAR + "p = balls", 5, "'balls'", VALUE),
    (NEAR + "p = touch", 5, "'touch'", "expected a value (this is a relation)"),
    ("links ties(balls, e = 1)\np = sum(o in ties: o.f)", 22, "'f'", WORDS),
]


@pytest.mark.parametrize("lines, column, found, expected", WRONG, ids=[row[0].replace("\n", ";")[-60:] for row in WRONG])
def test_errors(errors, lines, column, found, expected):
    report = errors(BEFORE + lines)
    first = report.split("\n")[0]
    line = LINE + lines.count("\n")
    assert f"in.ode:{line}:{column}: error: found {found}, {expected}" in report, report
    assert first.startswith("in.ode:"), report


USED = BEFORE + """\
near  touch(x, balls.x, R0, s = 0)
near  close(x.x, balls.x.y, R0)
links ties(balls, k2 = 3 [1/s])
links plain(balls)
all   suns(balls)
all   others
u' = sum(o in touch: o.s*o.R + o.x.y + o.x[1])*k + sum(o in ties: o.k2*norm(o.x)) + sum(o in others: o.u)*k + count(o in plain) * R0*k + count(o in close)*R0*k
remember o in touch: o.s = o.s + o.q[4] + count0
"""


def test_words_become_params(model):
    m = model(BEFORE + "near touch(x, balls.x, R0)\nu' = sum(o in touch: o.R*o.q[3] + o.x.y)*k")
    params = m["params"]
    assert [p["name"] for p in params] == ["balls_x_x", "balls_x_y", "balls_R", "balls_q_1", "balls_q_2", "balls_q_3", "balls_q_4", "R0", "k"]
    words = params[:7]
    assert [p["dimension"] for p in words] == ["m"] * 3 + [""] * 4
    assert [p["doc"] for p in words] == ["x_x of balls", "x_y of balls", "R of balls", *(f"q_{i} of balls" for i in range(1, 5))]
    assert all(p["value"] == 0 and not p["shared"] for p in words)
    read = {params[e["index"]]["name"] for e in m["exprs"] if e["op"] == "OTHER_PARAM"}
    assert read == {"balls_x_x", "balls_x_y", "balls_R", "balls_q_3"}


def test_every_relation_may_have_a_kind(model):
    text = USED.replace(" + count0", "")
    assert "OTHER_STATE" in {e["op"] for e in model(text)["exprs"]}


def test_a_kind_may_be_unused(model):
    assert len(model(BEFORE + "u' = 0")["params"]) == 9


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "in.ode"
    path.write_text(USED.replace(" + count0", ""))
    return path


def fp3(build, *arguments):
    return subprocess.run([build / "bin" / "fp3", *arguments], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("integrator", ["euler", "rk4", "heun"])
def test_a_model_compiles_alone(build, file, integrator):
    got = fp3(build, "compile", file, "-i", integrator)
    assert got.returncode == 0 and "other.R" in got.stdout and "other.balls" not in got.stdout, got.stderr


@pytest.mark.parametrize("name", ["balls_R", "balls_x_x", "balls"])
def test_nobody_gives_a_word(build, file, name):
    got = fp3(build, "run", file, "--steps", "1", "--set", f"{name}=1")
    assert got.returncode == 2 and f"the program has no '{name}'" in got.stderr


def test_a_run_alone_is_refused(build, file):
    got = fp3(build, "run", file, "--steps", "1")
    assert got.returncode == 2 and "'touch' (line 8 of the model) sees objects of another group, 'balls', and there is none" in got.stderr


@pytest.mark.parametrize("command", ["stress", "compare"])
def test_commands_for_objects_alone_refuse_it(build, file, command):
    got = fp3(build, command, file)
    assert got.returncode == 2 and "this command computes each object alone" in got.stderr
