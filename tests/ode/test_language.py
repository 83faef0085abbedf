"""The model language: what each statement becomes, and what expressions are worth."""

import math
import random

import pytest

pytestmark = pytest.mark.smoke
LEAF = {"NUMBER", "STATE", "PARAM", "TIME", "INITIAL"}

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
    ("log2(x) - log2(k)", "(SUB (LOG2 x) (LOG2 k))"),
    ("expm1(x) + log1p(y)*logistic(x)", "(ADD (EXPM1 x) (MUL (LOG1P y) (LOGISTIC x)))"),
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
    assert "expected two values with the same unit" in errors(text.replace(f"[{base}]", f"[{base}*K]"))


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
