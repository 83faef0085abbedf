"""The model language: what each statement becomes, what each error says, and what expressions are worth."""

import json
import math
import random
import subprocess

import pytest

pytestmark = pytest.mark.smoke


@pytest.fixture
def language(build, tmp_path):
    """Runs the driver on a text (or bytes): `language(text, "x=1")`."""

    def run(text, *point, name="in.ode"):
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / name).write_bytes(data)
        return subprocess.run([build / "tests" / "language", "model", name, *point], cwd=tmp_path,
                              capture_output=True, timeout=60)

    return run


@pytest.fixture
def model(language):
    """The model that a text describes."""

    def read(text, *point, **options):
        got = language(text, *point, **options)
        assert (got.returncode, got.stderr.decode(errors="replace")) == (0, "")
        return Model(json.loads(got.stdout))

    return read


@pytest.fixture
def errors(language):
    """The report on a text; there must be one."""

    def read(text, **options):
        got = language(text, **options)
        assert got.returncode == 2 and not got.stdout
        return got.stderr.decode(errors="strict")

    return read


@pytest.fixture
def constant(build):
    def run(text):
        return subprocess.run([build / "tests" / "language", "constant", text], capture_output=True,
                              text=True, timeout=60)

    return run


LEAF = {"NUMBER", "STATE", "PARAM", "TIME", "INITIAL"}


class Model(dict):
    """A dump, with ways to look into it."""

    def named(self, kind, name):
        return next(entry for entry in self[kind] if entry["name"] == name)

    def text(self, i):
        """An expression in prefix form: (ADD v 1)."""
        e = self["exprs"][i]
        match e["op"]:
            case "NUMBER":
                return f"{e['number']:g}"
            case "STATE":
                return self["states"][e["index"]]["name"]
            case "PARAM":
                return self["params"][e["index"]]["name"]
            case "TIME":
                return "t"
            case "INITIAL":
                return self["states"][e["index"]]["name"] + "(0)"
        parts = [self.text(operand) for operand in e["operand"] if operand is not None]
        return f"({' '.join([e['op'], *parts])})"

    def derivative(self, state):
        return self.text(self.named("states", state)["derivative"])

    def exact(self, state):
        return self.text(self.named("states", state)["exact"])

    def definition(self, name, kind="definitions"):
        return self.text(self.named(kind, name)["expr"])

    def value(self, name, kind="definitions"):
        return float(self["exprs"][self.named(kind, name)["expr"]]["value"])


SHIP = """\
model ship "A ship under thrust and linear drag"
param  m = 8.7e5 [kg]   "mass"
param  T = 1.2e6 [N]    "thrust"
param  C = 5e4 [N*s/m]
shared g = 9.81 [m / s^2] "gravity"   # not used
state  v = 0 [m/s]      "speed"
state  s = -1/4 [m]     "Ort, größer"
step   0.0078125 [s]
span   60 [s]

F  = T - C*v            # force
v' = F/m
s' = v

exact v = T/C + (v(0) - T/C)*exp(-C*t/m)
invariant rest = T - C*v
"""


def test_a_whole_model(model):
    m = model(SHIP)
    assert (m["name"], m["doc"]) == ("ship", "A ship under thrust and linear drag")
    assert (m["step"], m["span"]) == (0.0078125, 60)
    assert [p["name"] for p in m["params"]] == ["m", "T", "C", "g"]
    assert [p["value"] for p in m["params"]] == [8.7e5, 1.2e6, 5e4, 9.81]
    assert [p["dimension"] for p in m["params"]] == ["kg", "N", "N*s/m", "m/s^2"]
    assert [p["doc"] for p in m["params"]] == ["mass", "thrust", "", "gravity"]
    assert [p["shared"] for p in m["params"]] == [False, False, False, True]
    v, s = m["states"]
    assert (v["name"], v["value"], v["dimension"], v["doc"], v["line"]) == ("v", 0, "m/s", "speed", 6)
    assert (s["name"], s["value"], s["doc"]) == ("s", -0.25, "Ort, größer")
    assert m.derivative("v") == "(DIV (SUB T (MUL C v)) m)"
    assert m.derivative("s") == "v"
    assert (v["velocity"], s["velocity"]) == (None, 0)
    assert m.definition("F") == "(SUB T (MUL C v))"
    assert m.exact("v") == "(ADD (DIV T C) (MUL (SUB v(0) (DIV T C)) (EXP (DIV (MUL (NEGATE C) t) m))))"
    assert s["exact"] is None
    assert m.definition("rest", "invariants") == "(SUB T (MUL C v))"


def test_a_definition_is_shared_not_copied(model):
    m = model(SHIP)
    force = m.named("definitions", "F")["expr"]
    assert m["exprs"][m["states"][0]["derivative"]]["operand"][0] == force


def test_expressions_know_their_place_and_what_is_known(model):
    m = model(SHIP)
    quotient = m["exprs"][m["states"][0]["derivative"]]
    assert (quotient["line"], quotient["column"], quotient["known"]) == (12, 7, False)
    for e in m["exprs"]:
        operands = [m["exprs"][o]["known"] for o in e["operand"] if o is not None]
        leaf = e["op"] in ("NUMBER", "PARAM")
        assert e["known"] == (leaf if e["op"] in LEAF else all(operands))


@pytest.mark.parametrize("name, expected", [
    ("ship.ode", "ship"), ("two words.ode", "two_words"), ("a.b.ode", "a"), ("3d.ode", "_3d"),
    ("step.ode", "_step"), ("ö.ode", "__"), ("x" * 60, "x" * 30),
])
def test_without_a_name_it_is_called_like_its_file(model, name, expected):
    assert model("step 1\nstate x = 0\nx' = 1\n", name=name)["name"] == expected


def test_the_span_is_a_thousand_steps_where_there_is_none(model):
    assert model("step 0.5\nstate x = 0\nx' = 1\n")["span"] == 500


def test_lines_may_be_long_where_they_cannot_end(model):
    m = model("step 1\r\nstate x = 0\r\n\r\na = (1 # one\n\n + x)\nb = a +\n\n 2\nc = min(a,\n b\n)"
              "\nd = a and # both\n b or\n not\nx\nx' =\n 1")
    assert [m.definition(n) for n in "abcd"] == [
        "(ADD 1 x)", "(ADD (ADD 1 x) 2)", "(MIN (ADD 1 x) (ADD (ADD 1 x) 2))",
        "(OR (AND (ADD 1 x) (ADD (ADD 1 x) 2)) (NOT x))"]


def test_a_byte_order_mark_is_no_part_of_it(model, errors):
    assert model(b"\xef\xbb\xbfstep 1\nstate x = 0\nx' = 1")["step"] == 1
    assert errors(b"\xef\xbb\xbfstap 1\nstep 1\nstate x = 0\nx' = 1").startswith("in.ode:1:1: ")


# ---- expressions --------------------------------------------------------------------------------

HEAD = "step 0.1\nstate x = 0\nstate y = 1\nparam k = 2\nparam n = 3\nx' = y\ny' = -x\n"


@pytest.mark.parametrize("text, expected", [
    ("1 + 2*x", "(ADD 1 (MUL 2 x))"),
    ("x - y - k", "(SUB (SUB x y) k)"),
    ("x/y/k", "(DIV (DIV x y) k)"),
    ("x/y*k", "(MUL (DIV x y) k)"),
    ("-x^2", "(NEGATE (POWER x 2))"),
    ("x^-2", "(POWER x -2)"),
    ("x^(-2)", "(POWER x -2)"),
    ("k^n^2", "(POWER k (POWER n 2))"),
    ("2^-k^2", "(POWER 2 (NEGATE (POWER k 2)))"),
    ("-2^2", "(NEGATE (POWER 2 2))"),
    ("--x", "(NEGATE (NEGATE x))"),
    ("x*-y", "(MUL x (NEGATE y))"),
    ("-1.5e1", "-15"),
    ("-k*x", "(MUL (NEGATE k) x)"),
    ("x < y", "(LESS x y)"),
    ("x > y", "(LESS y x)"),
    ("x <= y", "(LESS_EQUAL x y)"),
    ("x >= y", "(LESS_EQUAL y x)"),
    ("x == y", "(EQUAL x y)"),
    ("x != y", "(NOT (EQUAL x y))"),
    ("not x < y and y or k", "(OR (AND (NOT (LESS x y)) y) k)"),
    ("x or y and k", "(OR x (AND y k))"),
    ("not not x", "(NOT (NOT x))"),
    ("x ? 1 : y ? 2 : 3", "(SELECT x 1 (SELECT y 2 3))"),
    ("x ? y ? 1 : 2 : 3", "(SELECT x (SELECT y 1 2) 3)"),
    ("select(x < 0, 1, y)", "(SELECT (LESS x 0) 1 y)"),
    ("x + 1 < y*2", "(LESS (ADD x 1) (MUL y 2))"),
    ("min(x, max(y, abs(k)))", "(MIN x (MAX y (ABS k)))"),
    ("sqrt(x)*sin(y)/cos(k)", "(DIV (MUL (SQRT x) (SIN y)) (COS k))"),
    ("exp(k) + log(n) + tan(k) + asin(k)", "(ADD (ADD (ADD (EXP k) (LOG n)) (TAN k)) (ASIN k))"),
    ("acos(k)*atan2(k, n)", "(MUL (ACOS k) (ATAN2 k n))"),
    ("acos(x)*atan2(x, y) - tan(x)*atan(y)*asin(x)",
     "(SUB (MUL (ACOS x) (ATAN2 x y)) (MUL (MUL (TAN x) (ATAN y)) (ASIN x)))"),
    ("sinh(k)*cosh(k)*tanh(k)", "(MUL (MUL (SINH k) (COSH k)) (TANH k))"),
    ("pi*x", "(MUL 3.14159 x)"),
    ("((((x))))", "x"),
    (".5 + 5. + 1E+3 + 0e0", "(ADD (ADD (ADD 0.5 5) 1000) 0)"),
    ("x^8 + x^-8 + x^0", "(ADD (ADD (POWER x 8) (POWER x -8)) (POWER x 0))"),
    ("k^0.5 + 2^k", "(ADD (POWER k 0.5) (POWER 2 k))"),
    ("x^9 + x^-0.5", "(ADD (POWER x 9) (POWER x -0.5))"),
    ("x^k + y^(1/3)", "(ADD (POWER x k) (POWER y (DIV 1 3)))"),
    ("exp(x)*log(y)", "(MUL (EXP x) (LOG y))"),
    ("sinh(x) + cosh(x) + tanh(y)", "(ADD (ADD (SINH x) (COSH x)) (TANH y))"),
])
def test_expressions(model, text, expected):
    assert model(HEAD + "e = " + text).definition("e") == expected


def test_a_sign_makes_no_other_use_of_a_number_negative(model):
    m = model(HEAD + "a = 2\nb = -a\nc = -2")
    assert [m.definition(n) for n in "abc"] == ["2", "(NEGATE 2)", "-2"]


def test_what_only_the_host_can_stands_in_invariants_and_closed_forms(model):
    m = model(HEAD + "invariant a = tan(x)*asin(y)\nexact x = x(0)*cosh(t)^1.5")
    assert m.definition("a", "invariants") == "(MUL (TAN x) (ASIN y))"
    assert m.exact("x") == "(MUL x(0) (POWER (COSH t) 1.5))"


def test_states_start_at_what_params_make_of_it(model):
    m = model("step 1/8\nparam k = 2^0.5\nparam w[2] = (1, 2)\nstate x = -k*w.y + sin(0)\nx' = 1\n"
              "span 3*pi")
    assert m["states"][0]["value"] == -(2 ** 0.5) * 2
    assert (m["step"], m["span"]) == (0.125, 3 * math.pi)


# ---- second order, vectors ----------------------------------------------------------------------


@pytest.mark.parametrize("lines", [("s'' = -k*s", "s' = u"), ("s' = u", "s'' = -k*s"),
                                   ("w = u", "s' = w", "s'' = -k*s")])
def test_a_second_derivative_is_that_of_the_velocity(model, lines):
    m = model("\n".join(["step 1", "param k = 1", "state s = 0", "state u = 0", *lines]))
    assert (m.derivative("s"), m.derivative("u")) == ("u", "(MUL (NEGATE k) s)")
    assert [s["velocity"] for s in m["states"]] == [1, None]


def test_what_is_its_own_derivative_is_not_its_velocity(model):
    assert model("step 1\nstate x = 1\nx' = x")["states"][0]["velocity"] is None


VECTORS = """\
step 0.1 [s]
param w[3] = (5, 0, -1) [1/s]  "rate"
param mu = 2 [m^3/s^2]
shared b[2] = (0, 1) [m]
state r[2] = (1, 0) [m]
state v[2] = (0, 1) [m/s]
state a[3] = (1, 2, 3)
r' = v
r'' = -mu*r/norm(r)^3
"""


def test_vectors_become_scalars(model):
    m = model(VECTORS + "a' = cross(w, a)\nlong = r.x*b.y\nd = r - b\nm = (long > 0) ? d : (1, 2)*r.x\n"
              "c = cross(r, v)\ne = dot(w, w)\ninvariant L = (c, c)\nexact r = r(0) + v(0)*t\n")
    assert [s["name"] for s in m["states"]] == "r_x r_y v_x v_y a_x a_y a_z".split()
    assert [s["value"] for s in m["states"]] == [1, 0, 0, 1, 1, 2, 3]
    assert [s["velocity"] for s in m["states"]] == [2, 3] + [None] * 5
    assert [p["name"] for p in m["params"]] == "w_x w_y w_z mu b_x b_y".split()
    assert [p["value"] for p in m["params"]] == [5, 0, -1, 2, 0, 1]
    assert {p["dimension"] for p in m["params"][:3]} == {"1/s"} and m["params"][2]["doc"] == "rate"
    norm = "(SQRT (ADD (MUL r_x r_x) (MUL r_y r_y)))"
    for x in "xy":
        assert m.derivative(f"r_{x}") == f"v_{x}"
        assert m.derivative(f"v_{x}") == f"(DIV (MUL (NEGATE mu) r_{x}) (POWER {norm} 3))"
        assert m.definition(f"d_{x}") == f"(SUB r_{x} b_{x})"
        assert m.exact(f"r_{x}") == f"(ADD r_{x}(0) (MUL v_{x}(0) t))"
    for x, y, z in ("xyz", "yzx", "zxy"):
        assert m.derivative(f"a_{x}") == f"(SUB (MUL w_{y} a_{z}) (MUL w_{z} a_{y}))"
    assert m.definition("long") == "(MUL r_x b_y)"
    assert m.definition("m_y") == "(SELECT (LESS 0 (MUL r_x b_y)) (SUB r_y b_y) (MUL 2 r_x))"
    assert m.definition("c") == "(SUB (MUL r_x v_y) (MUL r_y v_x))"
    assert m.definition("e") == "(ADD (ADD (MUL w_x w_x) (MUL w_y w_y)) (MUL w_z w_z))"
    assert [d["name"] for d in m["invariants"]] == ["L_x", "L_y"]


def test_components_may_have_equations_of_their_own(model):
    m = model("step 1\nstate r[2] = (0, 0)\nr.y' = 1\nr.x' = r.y\nexact r.y = t")
    assert (m.derivative("r_x"), m.derivative("r_y")) == ("r_y", "1")
    assert m["states"][0]["velocity"] == 1
    assert (m["states"][0]["exact"], m.exact("r_y")) == (None, "t")


# ---- errors -------------------------------------------------------------------------------------

BEFORE = """\
step 0.1 [s]
state x = 1 [m]
state u = 0 [m/s]
state r[2] = (1, 0) [m]
param k = 2 [1/s]
param c = 5
param w[3] = (1, 2, 3)
x' = u
u' = -k^2*x
r' = r*k
F = 2*x
"""
LINE = BEFORE.count("\n") + 1

NAME_OF_ITS_OWN = "expected a name ('{}' has a meaning of its own)"
STATEMENT = ("expected a statement: model, param, shared, state, step, span, exact, invariant, when, or an "
             "equation")
END = "expected an operator or the end of the line"
OPERAND = "expected a number, a name or '('"
UNIT = "expected a unit as m, 1/s or kg*m/s^2"
WHEN = "expected an operator or ':', and then what happens, as in `x = 0`"
ACT = "expected the name of a state, as in `when x < 0: x = -x, v = -v`"
POWER = "expected an exponent of numbers and params alone (any other x^y is exp(y*log(x)))"

WRONG = [
    # statements
    ("3 = x", 1, "'3'", STATEMENT),
    ("= x", 1, "'='", STATEMENT),
    ("\x01", 1, "'\\x01'", STATEMENT),
    ("é = 3", 1, "'\\xc3\\xa9'", STATEMENT),
    ("parm q = 3", 1, "'parm'", "expected a statement (did you mean 'param'?)"),
    ("zzz q = 3", 5, "'q'", "expected =, ' or '' after 'zzz'"),
    ("q", 2, "end of file", "expected =, ' or '' after 'q'"),
    ("x''' = 3", 2, "'''''", "expected =, ' or '' after 'x'"),
    ("q = 3 4", 7, "'4'", END),
    ("q = 3 [m]", 7, "'['", END),
    ("q = 3 \"doc\"", 7, "'\"doc\"'", END),
    ("q == 3", 3, "'=='", "expected =, ' or '' after 'q'"),
    # model
    ("model", 6, "end of file", "expected the name of the model"),
    ("model 3d", 7, "'3d'", "expected the name of the model"),
    ("model step", 7, "'step'", "expected a name of at most 31 letters, digits and _"),
    ("model " + "m" * 32, 7, "'" + "m" * 32 + "'", "expected a name of at most 31 letters, digits and _"),
    ("model a.b", 7, "'a.b'", "expected a name of at most 31 letters, digits and _"),
    # param, shared, state
    ("param", 6, "end of file", "expected a name"),
    ("param 3 = 2", 7, "'3'", "expected a name"),
    ("param q", 8, "end of file", "expected '=' and its value"),
    ("state q", 8, "end of file", "expected '=' and where the state starts"),
    ("param q 3", 9, "'3'", "expected '=' and its value"),
    ("param q = ", 11, "end of file", OPERAND),
    ("param q = 1 kg", 13, "'kg'", END),
    ("param q = 1 [kg", 16, "end of file", "expected '*', '/' or ']'"),
    ("param q = 1 []", 14, "']'", UNIT),
    ("param q = 1 [2]", 14, "'2'", UNIT),
    ("param q = 1 [m.s]", 14, "'m.s'", UNIT),
    ("param q = 1 [m s]", 16, "'s'", "expected '*', '/' or ']'"),
    ("param q = 1 [m*]", 16, "']'", UNIT),
    ("param q = 1 [m^k]", 16, "'k'", "expected an integer from -99 to 99 as power of a unit"),
    ("param q = 1 [m^1.5]", 16, "'1.5'", "expected an integer from -99 to 99 as power of a unit"),
    ("param q = 1 [m^100]", 16, "'100'", "expected an integer from -99 to 99 as power of a unit"),
    ("param q = 1 [" + "*".join(["m^99"] * 11) + "]", 64, "'m'", "expected a unit with smaller powers"),
    ("param q = 1 [" + "*".join(f"a{i}" for i in range(15)) + "]", 60, "'a14'",
     "expected at most 16 different units in a model"),
    ("param q = 1 [kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg]", 13, "'['",
     "expected a unit of fewer than 63 characters"),
    ("param q = 1 \"no end", 13, "'\"no end'", "expected a text that ends with '\"' on its line"),
    ("param q = 1 \"\\\"\"", 16, "'\"'", END),
    ("param q = 1 \"a\tb\"", 13, "'\"a\\x09b\"'", "expected a text in UTF-8 without control characters"),
    ("param q[4] = 1", 9, "'4'", "expected 2 or 3, the size of a vector (a unit stands behind the value)"),
    ("param q [m] = 1", 10, "'m'", "expected 2 or 3, the size of a vector (a unit stands behind the value)"),
    ("param q[2 = (1, 2)", 11, "'='", "expected ']'"),
    ("param q[2] = 1", 14, "'1'", "expected a vector, as (1, 0) (this is a number)"),
    ("param q[3] = (1, 2)", 14, "'('", "expected a vector, as (1, 0, 0) (this is a vector of 2)"),
    ("param q = (1, 2)", 11, "'('", "expected a number (this is a vector of 2)"),
    ("param q = k", 11, "'k'", "expected a number (only states may start at what is made of params)"),
    ("param q = kk", 11, "'kk'", "expected a number or a function"),
    ("state q = x", 11, "'x'", "expected numbers and params, which are known before the start"),
    ("state q = F", 11, "'F'", "expected numbers and params, which are known before the start"),
    ("state q = kk", 11, "'kk'", "expected a name that is defined (did you mean 'k'?)"),
    ("param q = 1/0", 11, "'1'", "expected a finite value (this is infinite)"),
    ("param q = log(-1)", 11, "'log'", "expected a finite value (this is not a number)"),
    ("state q = k [m]", 11, "'k'", "expected a value in [m] (this is in [1/s])"),
    # names
    ("param x = 1", 7, "'x'", "expected a new name (line 2 declares this one)"),
    ("x = 1", 1, "'x'", "expected a new name (line 2 declares this one)"),
    ("F = 1", 1, "'F'", "expected a new name (line 11 declares this one)"),
    ("invariant F = 1", 11, "'F'", "expected a new name (line 11 declares this one)"),
    ("r_x = 1", 1, "'r_x'", "expected a new name (the components of 'r', line 4, would share it)"),
    ("q.x = 1", 1, "'q.x'", "expected a name without a '.'"),
    ("param step = 1", 7, "'step'", NAME_OF_ITS_OWN.format("step")),
    *[(f"param {word} = 1", 7, f"'{word}'", NAME_OF_ITS_OWN.format(word))
      for word in "pi sin select norm and not model exact first last inf nan".split()],
    ("t = 1", 1, "'t'", "expected another name ('t' is the time)"),
    ("param h = 1", 7, "'h'", "expected another name ('h' is the time step, which `step` and --set h= give)"),
    ("state h = 1", 7, "'h'", "expected another name ('h' is the time step, which `step` and --set h= give)"),
    ("h = x", 1, "'h'", "expected another name ('h' is the time step, which `step` and --set h= give)"),
    ("invariant h = x", 11, "'h'", "expected another name ('h' is the time step, which `step` and --set h= give)"),
    ("shared steps = 1", 8, "'steps'", "expected another name ('steps' is the number of steps made)"),
    ("n" * 32 + " = 1", 1, "'" + "n" * 32 + "'", "expected a name of at most 31 characters"),
    ("param " + "n" * 30 + "[2] = (1, 2)", 7, "'" + "n" * 30 + "'", "expected a name of at most 29 characters"),
    ("n" * 30 + " = r", 1, "'" + "n" * 30 + "'", "expected a name of at most 29 characters"),
    # step, span
    ("step 1", 1, "'step'", "expected no second 'step' (line 1 has one)"),
    ("span 0 [s]", 6, "'0'", "expected a span above 0"),
    ("span -1 [s]", 6, "'-'", "expected a span above 0"),
    ("span 1 [m]", 1, "'span'", "expected the unit of the step (line 1)"),
    ("span", 5, "end of file", OPERAND),
    ("span (1, 2)", 6, "'('", "expected a number (this is a vector of 2)"),
    # equations
    ("q' = 3", 1, "'q'", "expected a name that is defined above"),
    ("k' = 3", 1, "'k'", "expected a state (line 5 declares something else)"),
    ("x' = 3", 1, "'x'", "expected one such equation of it (line 8 has another)"),
    ("r.y' = 3", 1, "'r.y'", "expected one such equation of it (line 10 has another)"),
    ("x'' = 3", 1, "'x'", "expected no second equation for 'u' (line 9 has one)"),
    ("r'' = -k^2*r", 1, "'r'", "expected an equation r_x' = v as well, where v is a state: r_x'' is then v'"),
    ("x' 3", 4, "'3'", "expected '='"),
    ("exact r = 3", 9, "'='", "expected a vector of 2 on both sides (on the right is a number)"),
    ("exact x = w", 9, "'='", "expected a number on both sides (on the right is a vector of 3)"),
    ("exact 3", 7, "'3'", "expected the name of a state"),
    ("exact k = 3", 7, "'k'", "expected a state (line 5 declares something else)"),
    ("exact x' = 3", 8, "'''", "expected '='"),
    ("exact x = u*t", 11, "'u'", "expected t, params, or where a state starts, as u(0)"),
    ("exact x = F", 11, "'F'", "expected a definition without states (this is a closed form)"),
    ("exact x = x(1)", 13, "'1'", "expected 0, as in v(0)"),
    ("exact x = x(0", 14, "end of file", "expected ')'"),
    ("exact x = k(0)", 12, "'('", "expected an operator ('k' is no function)"),
    ("invariant 3", 11, "'3'", "expected a name for the invariant"),
    ("invariant q 3", 13, "'3'", "expected '='"),
    # events
    ("when", 5, "end of file", OPERAND),
    ("when x", 7, "end of file", WHEN),
    ("when x < 0", 11, "end of file", WHEN),
    ("when x < 0 x = 1", 12, "'x'", WHEN),
    ("when x < 0, x = 1", 11, "','", WHEN),
    ("when x < 0 then x = 1", 12, "'then'", WHEN),
    ("when (x < 0: x = 1", 12, "':'", "expected an operator or ')'"),
    ("when x ? 1 : x = 1", 16, "'='", "expected an operator or ':', and then what happens, as in `x = 0`"),
    ("when r: x = 1", 6, "'r'", "expected a number as the condition (this is a vector of 2)"),
    ("when x = 0: x = 1", 8, "'='", WHEN),
    ("when x == c: x = x + 1 [m]", 24, "'['", END),
    ("when x < 0:", 12, "end of file", ACT),
    ("when x < 0: 3", 13, "'3'", ACT),
    ("when x < 0: -x = 3", 13, "'-'", ACT),
    ("when x < 0: x", 14, "end of file", "expected '='"),
    ("when x < 0: x: 1", 14, "':'", "expected '='"),
    ("when x < 0: x == 1", 15, "'=='", "expected '='"),
    ("when x < 0: x = ", 17, "end of file", OPERAND),
    ("when x < 0: x = 1,", 19, "end of file", ACT),
    ("when x < 0: x = 1, , u = 1", 20, "','", ACT),
    ("when x < 0: x = 1; u = 1", 18, "';'", END),
    ("when x < 0: x = 1: u = 1", 18, "':'", END),
    ("when x < 0: x' = 1", 14, "'''", "expected '=' (an event gives a state its value, not its derivative)"),
    ("when x < 0: k = 1", 13, "'k'", "expected a state (line 5 declares something else)"),
    ("when x < 0: F = 1", 13, "'F'", "expected a state (line 11 declares something else)"),
    ("when x < 0: t = 1", 13, "'t'", "expected a name that is defined above"),
    ("when x < 0: q = 1", 13, "'q'", "expected a name that is defined above"),
    ("when x < 0: r.z = 1", 13, "'r.z'", "expected a component .x or .y of it"),
    ("when x < 0: r = x", 15, "'='", "expected a vector of 2 on both sides (on the right is a number)"),
    ("when x < 0: x = r", 15, "'='", "expected a number on both sides (on the right is a vector of 2)"),
    ("when x < 0: x = u", 13, "'x'", "expected a value in [m] (its right side is in [m/s])"),
    ("when x < u: x = 0", 8, "'<'", "expected two values of one unit (these are in [m] and [m/s])"),
    ("when x < 0: x = -x, x = 0", 21, "'x'", "expected another state (this `when` gives it a value already)"),
    ("when x < 0: r.y = 0, r = r", 22, "'r'", "expected another state (this `when` gives it a value already)"),
    ("when x < 0: x = x(0)", 18, "'('", "expected an operator (the start of a state may stand in 'exact' alone)"),
    ("when 2^x > 1: x = 0", 7, "'^'", POWER),
    ("when = 1", 6, "'='", OPERAND),
    ("state when = 1", 7, "'when'", NAME_OF_ITS_OWN.format("when")),
    ("wen x < 0: x = 0", 1, "'wen'", "expected a statement (did you mean 'when'?)"),
    ("param q = t", 11, "'t'", "expected a value that is known before the start (t is the time since then)"),
    ("state q = 2*t", 13, "'t'", "expected a value that is known before the start (t is the time since then)"),
    ("invariant q = x(0)", 16, "'('", "expected an operator (the start of a state may stand in 'exact' alone)"),
    # expressions
    ("q = ", 5, "end of file", OPERAND),
    ("q = +x", 5, "'+'", OPERAND),
    ("q = x ** 2", 8, "'*'", OPERAND),
    ("q = ()", 6, "')'", OPERAND),
    ("q = 2 and and", 11, "'and'", OPERAND),
    ("q = 1 + not x", 9, "'not'", OPERAND),
    ("q = state", 5, "'state'", OPERAND),
    ("q = 2x", 5, "'2x'", "expected a number as 2, 0.5 or 1.5e-3"),
    ("q = 0x10", 5, "'0x10'", "expected a number as 2, 0.5 or 1.5e-3"),
    ("q = 1.2.3", 5, "'1.2.3'", "expected a number as 2, 0.5 or 1.5e-3"),
    ("q = 1e", 5, "'1e'", "expected a number as 2, 0.5 or 1.5e-3"),
    ("q = 1e+", 5, "'1e+'", "expected a number as 2, 0.5 or 1.5e-3"),
    ("q = 1e999", 5, "'1e999'", "expected a number below 1.8e308, the end of double"),
    ("q = 1e-999", 5, "'1e-999'", "expected 0 or a number above 4.9e-324, the start of double"),
    ("q = " + "1" * 256, 5, "'" + "1" * 52 + "...'", "expected a number of fewer than 256 characters"),
    ("q = .", 5, "'.'", OPERAND),
    ("q = (x", 7, "end of file", "expected an operator or ')'"),
    ("q = x)", 6, "')'", END),
    ("q = (x]", 7, "']'", "expected an operator or ')'"),
    ("q = x & k", 7, "'&'", END),
    ("q = x ! k", 7, "'!'", END),
    ("q = x < c*x < x", 13, "'<'", "expected 'and' between two comparisons"),
    ("q = x ? 1", 10, "end of file", "expected an operator or ':'"),
    ("q = x : 1", 7, "':'", END),
    ("q = sin x", 9, "'x'", "expected '(' after 'sin'"),
    ("q = sin(c, u)", 10, "','", "expected an operator or ')' ('sin' has 1 argument)"),
    ("q = min(x)", 10, "')'", "expected ',' ('min' has 2 arguments)"),
    ("q = min(x, x, x)", 13, "','", "expected an operator or ')' ('min' has 2 arguments)"),
    ("q = select(x, x)", 16, "')'", "expected ',' ('select' has 3 arguments)"),
    ("q = sni(x)", 5, "'sni'", "expected a function (did you mean 'sin'?)"),
    ("q = integrate(x)", 5, "'integrate'", "expected a function"),
    ("q = k(x)", 6, "'('", "expected an operator ('k' is no function)"),
    ("q = FF + x", 5, "'FF'", "expected a name that is defined (did you mean 'F'?)"),
    ("q = q", 5, "'q'", "expected a name that is defined above"),
    ("q = 2^t", 6, "'^'", POWER),
    ("q = x(0)", 6, "'('", "expected an operator (the start of a state may stand in 'exact' alone)"),
    # what the hardware cannot
    ("q = 2^x", 6, "'^'", POWER),
    ("q = F^x", 6, "'^'", POWER),
    ("q = x^(1 + x)", 6, "'^'", POWER),
    # vectors
    ("q = r + x", 7, "'+'", "expected two numbers, or two vectors of one size (these are a vector of 2 and a number)"),
    ("q = w - r", 7, "'-'", "expected two numbers, or two vectors of one size (these are a vector of 3 and a vector of 2)"),
    ("q = r*r", 6, "'*'", "expected a number on one side (dot and cross multiply vectors)"),
    ("q = x/r", 6, "'/'", "expected a number to divide by (this is a vector of 2)"),
    ("q = r^2", 6, "'^'", "expected numbers for '^' (these are a vector of 2 and a number)"),
    ("q = r < r", 7, "'<'", "expected numbers for '<' (these are a vector of 2 and a vector of 2)"),
    ("q = not r", 5, "'not'", "expected a number for 'not' (this is a vector of 2)"),
    ("q = sqrt(r)", 5, "'sqrt'", "expected a number for 'sqrt' (this is a vector of 2)"),
    ("q = r ? 1 : 2", 7, "'?'", "expected a number and two choices of one size (these are a vector of 2, a number and a number)"),
    ("q = x ? r : 2", 7, "'?'", "expected a number and two choices of one size (these are a number, a vector of 2 and a number)"),
    ("q = dot(r, w)", 5, "'dot'", "expected two vectors of one size for 'dot' (these are a vector of 2 and a vector of 3)"),
    ("q = cross(x, x)", 5, "'cross'", "expected two vectors of one size for 'cross' (these are a number and a number)"),
    ("q = norm(x)", 5, "'norm'", "expected two vectors of one size for 'norm' (these are a number and a number)"),
    ("q = (1, 2, 3, 4)", 5, "'('", "expected a vector of 2 or 3 (this is one of 4)"),
    ("q = (r, 1)", 5, "'('", "expected a vector of numbers (there is a vector of 2 in it)"),
    ("q = r.z", 5, "'r.z'", "expected a component .x or .y of it"),
    ("q = w.xy", 5, "'w.xy'", "expected a component .x, .y or .z of it"),
    ("q = x.x", 5, "'x.x'", "expected 'x' alone (it is no vector)"),
    ("q = nn.x", 5, "'nn'", "expected a name that is defined above"),
    # units
    ("q = x + u", 7, "'+'", "expected two values of one unit (these are in [m] and [m/s])"),
    ("q = x - k", 7, "'-'", "expected two values of one unit (these are in [m] and [1/s])"),
    ("q = x < u", 7, "'<'", "expected two values of one unit (these are in [m] and [m/s])"),
    ("q = x != u", 7, "'!='", "expected two values of one unit (these are in [m] and [m/s])"),
    ("q = atan2(k, k^2)", 5, "'atan2'", "expected two values of one unit (these are in [1/s] and [1/s^2])"),
    ("q = min(x, u)", 5, "'min'", "expected two values of one unit (these are in [m] and [m/s])"),
    ("q = x ? x : u", 7, "'?'", "expected two values of one unit (these are in [m] and [m/s])"),
    ("q = r*k + r", 9, "'+'", "expected two values of one unit (these are in [m/s] and [m])"),
    ("q = sin(x)", 5, "'sin'", "expected a value without a unit for it (this is in [m])"),
    ("q = exp(k)", 5, "'exp'", "expected a value without a unit for it (this is in [1/s])"),
    ("q = sqrt(k)^8*sqrt(sqrt(sqrt(sqrt(k))))", 15, "'sqrt'",
     "expected a value with a square root of its unit (this is in [1/s^0.125])"),
    ("q = k^c", 6, "'^'", "expected a number as 2 or 0.5 for the power of what is in [1/s]"),
    ("q = c^k", 6, "'^'", "expected a value without a unit for it (this is in [1/s])"),
    ("q = k^0.3", 6, "'^'", "expected a number as 2 or 0.5 for the power of what is in [1/s]"),
    ("exact x = k*t", 7, "'x'", "expected a closed form in [m] (its right side is in [1])"),
    ("exact x = exp(-t)", 11, "'exp'", "expected a value without a unit for it (this is in [s])"),
]


@pytest.mark.parametrize("line, column, found, expected", WRONG)
def test_each_error_says_where_and_what(errors, line, column, found, expected):
    report = errors(BEFORE + line)
    head = f"in.ode:{LINE}:{column}: error: found {found}, {expected}"
    shown = report.split("\n")
    assert head in shown
    if len(line) < 40 and line.isascii() and line.isprintable():
        at = shown.index(head)
        assert shown[at + 1 : at + 3] == ["    " + line, "    " + " " * (column - 1) + "^"]
    second = [e for e in places(report) if e != f"in.ode:{LINE}:{column}"]
    assert not second or line.startswith("state") or line == "exact x = exp(-t)", "one mistake, one error"


def places(report):
    return [line.split(": error")[0] for line in report.split("\n") if line.startswith("in.ode:")]


@pytest.mark.parametrize("text, expected", [
    ("", "in.ode:1:1: error: found end of file, expected a state, as in: state v = 0"),
    ("state x = 0\nx' = 1", "in.ode:2:7: error: found end of file, expected a time step, as in: step 0.01"),
    ("step 0\nstate x = 0\nx' = 1", "in.ode:1:6: error: found '0', expected a step above 0"),
    ("step 1\nstate x = 0", "in.ode:2:7: error: found 'x', expected an equation for this state, x' = ..."),
    ("step 1\nstate r[2] = (0, 0)\nr.x' = 1",
     "in.ode:2:7: error: found 'r', expected an equation for this state, r_y' = ..."),
    ("step 1 [s]\nstate x = 0 [m]\nparam m = 1 [kg]\nx' = m",
     "in.ode:4:1: error: found 'x', expected a derivative in [m/s] (its right side is in [kg])"),
    ("step 1 [s]\nstate x = 0 [m]\nstate v = 0 [m/s]\nx' = v\nx'' = -x",
     "in.ode:5:1: error: found 'x', expected a second derivative in [m/s^2] (its right side is in [m])"),
    ("step 1\nstate x = 0\nx'' = -x",
     "in.ode:2:7: error: found 'x', expected an equation for this state, x' = ..."),
    ("step 1\nstate x = 0\nx' = 1\nparam q = 1\nxx' = 1",
     "in.ode:5:1: error: found 'xx', expected a name that is defined (did you mean 'x'?)"),
    ("model a\nmodel b\nstep 1\nstate x = 0\nx' = 1",
     "in.ode:2:1: error: found 'model', expected no second name of the model (line 1 has one)"),
    ("step 1\nstate x = 0\nx' = 1\nx_y = 2\nx_x = 2\nparam x_w[2] = (1, 2)\ninvariant i = x\nj = i",
     "in.ode:8:5: error: found 'i', expected a name that is defined (this is an invariant)"),
    ("step 1\nstate x = 0\nx' = 1\nq_y = 2\nq = (1, 2)",
     "in.ode:5:1: error: found 'q', expected a new name (the components of 'q', line 4, would share it)"),
])
def test_errors_of_a_whole_model(errors, text, expected):
    assert errors(text).split("\n")[0] == expected


def test_reading_goes_on_after_an_error(errors):
    text = "stat x = 1\nstep 1 1\nstate y = (\nstate z = 2 +\nparam k = 3\ny' = (k\nz' = q\nk = 2\n"
    assert places(errors(text)) == ["in.ode:1:1", "in.ode:2:8", "in.ode:4:1", "in.ode:5:1",
                                    "in.ode:7:1", "in.ode:7:6", "in.ode:8:1"]


def test_events_are_read_in_their_order(model):
    m = model("step 1\nstate x = 1\nstate r[2] = (1, 2)\nx' = 1\nr' = (1, 1)\nlow = x < 0\n"
              "when low and\n  t > 1 or r.y:  x = -x,\n  r = (r.y, r.x)\nwhen x ? 1 : 0 : r.y = 3  # last\n")
    assert [(e["line"], [name for name, _ in e["sets"]]) for e in m["events"]] == [(7, ["x", "r_x", "r_y"]), (10, ["r_y"])]
    assert [m["exprs"][e["condition"]]["op"] for e in m["events"]] == ["OR", "SELECT"]
    assert [m["exprs"][expr]["op"] for _, expr in m["events"][0]["sets"]] == ["NEGATE", "STATE", "STATE"]


def test_the_end_of_a_line_is_an_end(errors):
    report = errors("step\nspan 1 +\nstate\nx' \n")
    assert places(report) == ["in.ode:1:5", "in.ode:3:1", "in.ode:3:6", "in.ode:4:1", "in.ode:4:4",
                              "in.ode:5:1"]
    assert report.startswith("in.ode:1:5: error: found end of line, expected a number")


def test_what_is_wrong_is_reported_where_it_is_not_where_it_is_used(errors):
    report = errors("step 1\nstate x = a\nF = x + G\nH = F + G + sin(F, F)\nx' = F*H*G\n")
    assert places(report) == ["in.ode:2:11", "in.ode:3:9", "in.ode:4:18"]


def test_twenty_errors_are_enough(errors):
    report = errors("step 1\n" + "".join(f"a{i} = b{i}\n" for i in range(30)))
    assert len(places(report)) == 20 and report.endswith("20 errors; there may be more\n")


def test_a_report_shows_nothing_that_drives_the_terminal(errors):
    report = errors(b"a = \"\x1b[31m\xff\xfe\x00 \x9b\r\n\x7f = 1\n")
    assert report.replace("\n", "").isascii() and report.replace("\n", "").isprintable()


@pytest.mark.parametrize("doc", [b"\xff", b"\xc0\xaf", b"\xed\xa0\x80", b"\xf5\x80\x80\x80", b"\xc2\x85",
                                 b"\xe2\x82", b"\0", b"\x7f", b"\x1b[1m", b"\xe0\x80\x80", b"\xf4\x90\x80\x80"])
def test_texts_are_utf8(errors, doc):
    assert "expected a text in UTF-8" in errors(b'model m "' + doc + b'"\nstep 1\nstate x = 0\nx\' = 1')


# ---- limits -------------------------------------------------------------------------------------

SMALL = "step 1\nstate x = 0\nx' = 1\n"


@pytest.mark.parametrize("text, limit, message", [
    (lambda n: SMALL + "a = " + "(" * (n - 1) + "x" + ")" * (n - 1), 200,
     "expected an expression nested at most 200 deep"),
    (lambda n: SMALL + "a = " + "-" * (n - 1) + "x", 200, "expected an expression nested at most 200 deep"),
    (lambda n: SMALL + "a = " + "not " * (n - 1) + "x", 200, "expected an expression nested at most 200 deep"),
    (lambda n: SMALL + "a = " + "2^" * (n - 1) + "1", 200, "expected an expression nested at most 200 deep"),
    (lambda n: SMALL + "a = " + "x ? 1 : " * (n - 1) + "2", 200,
     "expected an expression nested at most 200 deep"),
    (lambda n: "step 1\n" + "".join(f"state x{i} = 0\nx{i}' = 1\n" for i in range(n)), 64,
     "expected at most 64 states"),
    (lambda n: SMALL + "".join(f"param k{i} = 0\n" for i in range(n)), 64,
     "expected at most 64 params, shared ones included"),
    (lambda n: SMALL + "a = x" + "+x" * ((n - 2) // 2), 4096,
     "expected a model of at most 4096 numbers, names and operations"),
    (lambda n: SMALL + "a0 = x\n" + "".join(f"a{i} = a0\n" for i in range(1, n)), 1022,
     "expected fewer than 1024 definitions"),
    (lambda n: SMALL + "".join(f"invariant a{i} = 1\n" for i in range(n)), 1022,
     "expected fewer than 1024 invariants"),
    (lambda n: SMALL + "when x > 1: x = 0\n" * n, 64, "expected at most 64 events"),
    (lambda n: "step 1\n" + "".join(f"state x{i} = 0\nx{i}' = 1\n" for i in range(16))
     + ("when x0 > 1: " + ", ".join(f"x{i} = 0" for i in range(16)) + "\n") * (n // 16) + "when x0: x0 = 0" * (n % 16), 256,
     "expected at most 256 values given by events"),
    (lambda n: SMALL + "#" * (n - len(SMALL)), 1 << 20, "expected at most 1048576"),
])
def test_limits(model, errors, text, limit, message):
    model(text(limit))
    step = 2 if limit == 4096 else 1
    report = errors(text(limit + step))
    assert message in report.split("\n")[0] and len(places(report)) == 1


def test_constants_do_not_count_as_expressions(model):
    assert len(model(SMALL + "".join(f"param k{i} = 0{'+1' * 1000}\n" for i in range(60)))["exprs"]) == 1


def test_what_never_ends_is_refused(errors):
    for text in ("(" * 100000, "-" * 100000, "a = " + "2^" * 100000, "[" * 100000, "\n" * 100000,
                 "a = sin" + "(sin" * 100000, "x " * 100000, "'" * 100000, "a=b\n" * 100000):
        assert errors(text)


def test_a_file_that_is_not_there(build, tmp_path):
    got = subprocess.run([build / "tests" / "language", "model", "none.ode"], cwd=tmp_path, text=True,
                         capture_output=True)
    assert got.returncode == 2 and "none.ode" in got.stderr


# ---- values -------------------------------------------------------------------------------------

BINARY = {"+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
          "/": lambda a, b: a / b, "<": lambda a, b: float(a < b), "<=": lambda a, b: float(a <= b),
          ">": lambda a, b: float(a > b), ">=": lambda a, b: float(a >= b),
          "==": lambda a, b: float(a == b), "!=": lambda a, b: float(a != b),
          "and": lambda a, b: float(a != 0 and b != 0), "or": lambda a, b: float(a != 0 or b != 0)}
FUNCTION = {"sin": math.sin, "cos": math.cos, "exp": math.exp, "tan": math.tan, "sinh": math.sinh,
            "cosh": math.cosh, "tanh": math.tanh, "abs": abs, "atan": math.atan}
NAMES = {"x": 0.7, "y": -1.3, "k": 2.5, "n": -0.4}


def random_expression(choose, depth):
    """A text in full parentheses, and its value."""
    if depth == 0 or choose.random() < 0.1:
        if choose.random() < 0.5:
            name = choose.choice(list(NAMES))
            return name, NAMES[name]
        text = f"{choose.uniform(0, 10):.3g}"
        return text, float(text)
    a, a_value = random_expression(choose, depth - 1)
    b, b_value = random_expression(choose, depth - 1)
    match choose.randrange(8):
        case 0:
            return f"(-{a})", -a_value
        case 1:
            f = choose.choice(list(FUNCTION))
            try:
                return f"{f}({a})", FUNCTION[f](a_value)
            except OverflowError:
                return a, a_value
        case 2:
            c, c_value = random_expression(choose, depth - 1)
            text = choose.choice(["({} ? {} : {})", "select({}, {}, {})"])
            return text.format(a, b, c), b_value if a_value != 0 else c_value
        case 3:
            f, g = choose.choice([("min", lambda: a_value if a_value < b_value else b_value),
                                  ("max", lambda: a_value if b_value < a_value else b_value),
                                  ("atan2", lambda: math.atan2(a_value, b_value))])
            return f"{f}({a}, {b})", g()
        case 4:
            return f"(not {a})", float(a_value == 0)
        case 5 if abs(a_value) > 1e-3 and abs(a_value) < 1e3:
            power = choose.randint(-8, 8)
            return f"({a})^{power}", a_value ** power
        case 6 if a_value >= 0:
            return f"sqrt({a})", math.sqrt(a_value)
        case _:
            op = choose.choice(list(BINARY))
            if op == "/" and b_value == 0:
                return a, a_value
            return f"({a} {op} {b})", BINARY[op](a_value, b_value)


def close(got, expected):
    return got == expected or math.isclose(got, expected, rel_tol=1e-12, abs_tol=0) or (
        not math.isfinite(expected) and not math.isfinite(got))


@pytest.mark.parametrize("seed", range(4))
def test_values_are_those_of_python(model, seed):
    choose = random.Random(seed)
    cases, expressions = [], 0
    while expressions < 3500:
        cases.append(random_expression(choose, choose.randint(1, 6)))
        expressions += cases[-1][0].count(" ") + 2 * cases[-1][0].count("(") + 2
    text = HEAD + "".join(f"invariant i{i} = {case[0]}\n" for i, case in enumerate(cases[:900]))
    m = model(text, *(f"{name}={value}" for name, value in NAMES.items()))
    for i, (source, expected) in enumerate(cases[:900]):
        assert close(m.value(f"i{i}", "invariants"), expected), (seed, source)


@pytest.mark.parametrize("text, expected", [
    ("2 + 3*4", 14), ("2^3^2", 512), ("-2^2", -4), ("2^-1", 0.5), ("7/2/2", 1.75), ("1 - 2 - 3", -4),
    ("1 < 2 and 2 < 1 or 1", 1), ("not 1 == 2", 1), ("1 ? 2 : 3", 2), ("0 ? 2 : 0 ? 3 : 4", 4),
    ("log(2)", math.log(2)), ("asin(0.5)", math.asin(0.5)), ("acos(0.5)", math.acos(0.5)),
    ("atan2(-1, -2)", math.atan2(-1, -2)), ("pi", math.pi), ("norm((3, 4))", 5),
    ("dot((1, 2, 3), (4, 5, 6))", 32), ("cross((1, 2), (3, 4))", -2), ("min(2, 1)", 1), ("max(2, 1)", 2),
    ("1/6", 1 / 6), ("1/(2 - 2^(1/3))", 1 / (2 - 2 ** (1 / 3))), (" 1 ", 1), ("-0.0", -0.0),
])
def test_constants(constant, text, expected):
    got = constant(text)
    assert (got.returncode, got.stderr) == (0, "")
    assert close(float(got.stdout), expected)


@pytest.mark.parametrize("text, message", [
    ("", "column 1: found end of file, expected a number, a name or '('"),
    ("1 +", "column 4: found end of file, expected a number, a name or '('"),
    ("1 2", "column 3: found '2', expected an operator or the end"),
    ("1\n", "column 2: found end of line, expected an operator or the end"),
    ("1 [m]", "column 3: found '[', expected an operator or the end"),
    ("x", "column 1: found 'x', expected a number or a function"),
    ("t", "column 1: found 't', expected a value that is known before the start (t is the time since then)"),
    ("1/0", "column 1: found '1', expected a finite value (this is infinite)"),
    ("sqrt(-1)", "column 1: found 'sqrt', expected a finite value (this is not a number)"),
    ("(1, 2)", "column 1: found '(', expected a number (this is a vector of 2)"),
    ("1e400", "column 1: found '1e400', expected a number below 1.8e308, the end of double"),
])
def test_constants_that_are_none(constant, text, message):
    got = constant(text)
    assert (got.returncode, got.stdout, got.stderr) == (2, "", message + "\n")


def test_time_and_start_are_what_closed_forms_are_made_of(model):
    m = model("step 1\nstate x = 5\nx' = -x\nexact x = x(0)*exp(-t)\n", "t=0.5", "x(0)=3", "x=9")
    at = m["exprs"][m["states"][0]["exact"]]
    assert close(float(at["value"]), 3 * math.exp(-0.5))


# ---- units --------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit, base", [
    ("N", "kg*m/s^2"), ("J", "N*m"), ("W", "J/s"), ("Pa", "N/m^2"), ("Hz", "1/s"), ("V", "W/A"),
    ("C", "A*s"), ("F", "C/V"), ("ohm", "V/A"), ("S", "A/V"), ("Wb", "V*s"), ("T", "Wb/m^2"),
    ("H", "Wb/A"), ("rad", "1"), ("sr", "m^2/m^2"), ("kg*m^2/s^3/A", "V"), ("m^-1", "1/m"),
])
def test_derived_units_are_what_they_are_made_of(model, errors, unit, base):
    text = f"step 1\nstate x = 0\nx' = 0\nparam a = 1 [{unit}]\nparam b = 1 [{base}]\nc = a + b\n"
    model(text)
    assert "expected two values of one unit" in errors(text.replace(f"[{base}]", f"[{base}*K]"))


@pytest.mark.parametrize("line", [
    "q = 0.5*m*v^2 + m*g*s",         # numbers are factors without a unit,
    "q = v + 1",                     # and fit every sum
    "q = v + free",                  # what has no unit fits everything,
    "q = v*free + s",                # and makes everything so
    "q = sqrt(v^2 + 2*g*s) - v",
    "q = sqrt(sqrt(s))*sqrt(sqrt(s))*sqrt(s) + s",
    "q = g^0.5*g^0.5 + g",
    "q = sin(v/sqrt(g*s)) + 1",
    "q = (v < 0)*v + v",
    "q = (v ? s : 2) + s",
    "q = atan2(free, free) + 1",
    "q = atan2(g, 2*g) + 1",
    "q = abs(-v) + max(v, v)",
    "q = v*2 < v and s",
    "exact v = v(0) - g*t",
    "exact s = s(0) + v(0)*t - 0.5*g*t^2",
])
def test_units_that_fit(model, line):
    model("step 1 [s]\nstate v = 0 [m/s]\nstate s = 0 [m]\nparam m = 1 [kg]\nparam g = 9.81 [m/s^2]\n"
          "param free = 2\nv' = -g\ns' = v\n" + line)


def test_without_units_nothing_is_checked(model):
    model("step 1\nstate x = 0\nstate u = 0\nx' = u\nu' = -x + sin(u)*x^2 + (x < u) - 1")


def test_names_that_the_si_does_not_have_are_units_of_their_own(model, errors):
    text = "step 1 [d]\nstate hare = 9 [pelt]\nparam r = 2 [1/d]\nhare' = r*hare\n"
    model(text)
    assert "[pelt/d]" in errors(text.replace("[1/d]", "[1/s]"))
