"""The model language: what each error says and where, and what happens at each limit."""

import subprocess

import pytest

pytestmark = pytest.mark.smoke


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
STATEMENT = ("expected a statement: model, param, shared, state, step, span, exact, invariant, when, for, project, repeat, rest, kind, links, near, "
             "all, remember, or an equation")
END = "expected an operator or the end of the line"
OPERAND = "expected a number, a name or '('"
UNIT = "expected a unit such as m, 1/s or kg*m/s^2"
WHEN = "expected an operator or ':', and then a new value, as in `x = 0`"
ACT = "expected the name of a state, as in `when x < 0: x = -x, v = -v`"
SIZE = "expected a number from 2 to 64, the size of a vector (write a unit after the value)"
POWER = "expected an exponent of numbers and params only (write exp(y*log(x)) for any other x^y)"

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
    ("param q = 1 [m^k]", 16, "'k'", "expected an integer from -99 to 99 as the power of a unit"),
    ("param q = 1 [m^1.5]", 16, "'1.5'", "expected an integer from -99 to 99 as the power of a unit"),
    ("param q = 1 [m^100]", 16, "'100'", "expected an integer from -99 to 99 as the power of a unit"),
    ("param q = 1 [" + "*".join(["m^99"] * 11) + "]", 64, "'m'", "expected a unit with smaller powers"),
    ("param q = 1 [" + "*".join(f"a{i}" for i in range(15)) + "]", 60, "'a14'",
     "expected at most 16 different units in a model"),
    ("param q = 1 [kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg*kg]", 13, "'['",
     "expected a unit of fewer than 63 characters"),
    ("param q = 1 \"no end", 13, "'\"no end'", "expected a text that ends with '\"' on its line"),
    ("param q = 1 \"\\\"\"", 16, "'\"'", END),
    ("param q = 1 \"a\tb\"", 13, "'\"a\\x09b\"'", "expected a text in UTF-8 without control characters"),
    ("param q[4] = 1", 14, "'1'", "expected a vector of 4 (this is a number)"),
    ("param q[1] = 1", 9, "'1'", SIZE),
    ("param q[65] = 1", 9, "'65'", SIZE),
    ("param q [m] = 1", 10, "'m'", SIZE),
    ("param q[2.5] = 1", 9, "'2.5'", "expected a whole number of at most 1000000 (this is 2.5)"),
    ("param q[2 = (1, 2)", 11, "'='", "expected ']'"),
    ("param q[2] = 1", 14, "'1'", "expected a vector such as (1, 0) (this is a number)"),
    ("param q[3] = (1, 2)", 14, "'('", "expected a vector such as (1, 0, 0) (this is a vector of 2)"),
    ("param q = (1, 2)", 11, "'('", "expected a number (this is a vector of 2)"),
    ("param q = k", 11, "'k'", "expected a number (only the start of a state may use params)"),
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
    ("step 1", 1, "'step'", "expected only one 'step' (line 1 has one)"),
    ("span 0 [s]", 6, "'0'", "expected a span above 0"),
    ("span -1 [s]", 6, "'-'", "expected a span above 0"),
    ("span 1 [m]", 1, "'span'", "expected the unit of the step (line 1)"),
    ("span", 5, "end of file", OPERAND),
    ("span (1, 2)", 6, "'('", "expected a number (this is a vector of 2)"),
    # equations
    ("q' = 3", 1, "'q'", "expected a name that is defined above"),
    ("k' = 3", 1, "'k'", "expected a state (line 5 declares something else)"),
    ("x' = 3", 1, "'x'", "expected only one equation like this (line 8 has another)"),
    ("r.y' = 3", 1, "'r.y'", "expected only one equation like this (line 10 has another)"),
    ("x'' = 3", 1, "'x'", "expected only one equation for 'u' (line 9 has one)"),
    ("r'' = -k^2*r", 1, "'r'", "expected an equation r_x' = v as well, where v is a state: r_x'' is then v'"),
    ("x' 3", 4, "'3'", "expected '='"),
    ("exact r = 3", 9, "'='", "expected a vector of 2 on both sides (on the right is a number)"),
    ("exact x = w", 9, "'='", "expected a number on both sides (on the right is a vector of 3)"),
    ("exact 3", 7, "'3'", "expected the name of a state"),
    ("exact k = 3", 7, "'k'", "expected a state (line 5 declares something else)"),
    ("exact x' = 3", 8, "'''", "expected '='"),
    ("exact x = u*t", 11, "'u'", "expected t, params, or the start of a state, as in u(0)"),
    ("exact x = F", 11, "'F'", "expected a definition without states (this is a closed form)"),
    ("exact x = x(1)", 13, "'1'", "expected 0, as in v(0)"),
    ("exact x = x(0", 14, "end of file", "expected ')'"),
    ("exact x = k(0)", 12, "'('", "expected an operator ('k' is not a function)"),
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
    ("when x ? 1 : x = 1", 16, "'='", "expected an operator or ':', and then a new value, as in `x = 0`"),
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
    ("when x < u: x = 0", 8, "'<'", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("when x < 0: x = -x, x = 0", 21, "'x'", "expected another state (this `when` already gives it a value)"),
    ("when x < 0: r.y = 0, r = r", 22, "'r'", "expected another state (this `when` already gives it a value)"),
    ("when x < 0: x = x(0)", 18, "'('", "expected an operator (the start of a state is allowed only in 'exact')"),
    ("when 2^x > 1: x = 0", 7, "'^'", POWER),
    ("when = 1", 6, "'='", OPERAND),
    ("state when = 1", 7, "'when'", NAME_OF_ITS_OWN.format("when")),
    ("wen x < 0: x = 0", 1, "'wen'", "expected a statement (did you mean 'when'?)"),
    ("param q = t", 11, "'t'", "expected a value that is known before the start (t is the time since then)"),
    ("state q = 2*t", 13, "'t'", "expected a value that is known before the start (t is the time since then)"),
    ("invariant q = x(0)", 16, "'('", "expected an operator (the start of a state is allowed only in 'exact')"),
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
    ("q = k(x)", 6, "'('", "expected an operator ('k' is not a function)"),
    ("q = FF + x", 5, "'FF'", "expected a name that is defined (did you mean 'F'?)"),
    ("q = q", 5, "'q'", "expected a name that is defined above"),
    ("q = 2^t", 6, "'^'", POWER),
    ("q = x(0)", 6, "'('", "expected an operator (the start of a state is allowed only in 'exact')"),
    # what the hardware cannot
    ("q = 2^x", 6, "'^'", POWER),
    ("q = F^x", 6, "'^'", POWER),
    ("q = x^(1 + x)", 6, "'^'", POWER),
    # vectors
    ("q = r + x", 7, "'+'", "expected two numbers, or two vectors of the same size (these are a vector of 2 and a number)"),
    ("q = w - r", 7, "'-'", "expected two numbers, or two vectors of the same size (these are a vector of 3 and a vector of 2)"),
    ("q = r*r", 6, "'*'", "expected a number on one side (dot and cross multiply vectors)"),
    ("q = x/r", 6, "'/'", "expected a number to divide by (this is a vector of 2)"),
    ("q = r^2", 6, "'^'", "expected numbers for '^' (these are a vector of 2 and a number)"),
    ("q = r < r", 7, "'<'", "expected numbers for '<' (these are a vector of 2 and a vector of 2)"),
    ("q = not r", 5, "'not'", "expected a number for 'not' (this is a vector of 2)"),
    ("q = sqrt(r)", 5, "'sqrt'", "expected a number for 'sqrt' (this is a vector of 2)"),
    ("q = r ? 1 : 2", 7, "'?'", "expected a number and two choices of the same size (these are a vector of 2, a number and a number)"),
    ("q = x ? r : 2", 7, "'?'", "expected a number and two choices of the same size (these are a number, a vector of 2 and a number)"),
    ("q = dot(r, w)", 5, "'dot'", "expected two vectors of the same size for 'dot' (these are a vector of 2 and a vector of 3)"),
    ("q = cross(x, x)", 5, "'cross'", "expected two vectors of the same size for 'cross' (these are a number and a number)"),
    ("q = norm(x)", 5, "'norm'", "expected two vectors of the same size for 'norm' (these are a number and a number)"),
    ("q = (" + "1, " * 64 + "1)", 5, "'('", "expected a vector of 2 to 64 (this has 65 components)"),
    ("q = (r, 1)", 5, "'('", "expected a vector of numbers (there is a vector of 2 in it)"),
    ("q = r.z", 5, "'r.z'", "expected a component .x or .y of it"),
    ("q = w.xy", 5, "'w.xy'", "expected a component .x, .y or .z of it"),
    ("q = x.x", 5, "'x.x'", "expected 'x' without a component (it is not a vector)"),
    ("q = nn.x", 5, "'nn'", "expected a name that is defined above"),
    # units
    ("q = x + u", 7, "'+'", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("q = x - k", 7, "'-'", "expected two values with the same unit (these are in [m] and [1/s])"),
    ("q = x < u", 7, "'<'", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("q = x != u", 7, "'!='", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("q = atan2(k, k^2)", 5, "'atan2'", "expected two values with the same unit (these are in [1/s] and [1/s^2])"),
    ("q = min(x, u)", 5, "'min'", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("q = x ? x : u", 7, "'?'", "expected two values with the same unit (these are in [m] and [m/s])"),
    ("q = r*k + r", 9, "'+'", "expected two values with the same unit (these are in [m/s] and [m])"),
    ("q = sin(x)", 5, "'sin'", "expected a value without a unit (this is in [m])"),
    ("q = exp(k)", 5, "'exp'", "expected a value without a unit (this is in [1/s])"),
    ("q = sqrt(k)^8*sqrt(sqrt(sqrt(sqrt(k))))", 15, "'sqrt'",
     "expected a value whose unit has a square root (this is in [1/s^0.125])"),
    ("q = k^c", 6, "'^'", "expected a number such as 2 or 0.5 as the exponent of a value in [1/s]"),
    ("q = c^k", 6, "'^'", "expected a value without a unit (this is in [1/s])"),
    ("q = k^0.3", 6, "'^'", "expected a number such as 2 or 0.5 as the exponent of a value in [1/s]"),
    ("exact x = k*t", 7, "'x'", "expected a closed form in [m] (its right side is in [1])"),
    ("exact x = exp(-t)", 11, "'exp'", "expected a value without a unit (this is in [s])"),
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
     "in.ode:2:1: error: found 'model', expected only one name of the model (line 1 has one)"),
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
    (lambda n: SMALL + "a0 = x\n" + "".join(f"a{i} = a0\n" for i in range(1, n)), 1024,
     "expected at most 1024 definitions"),
    (lambda n: SMALL + "".join(f"invariant a{i} = 1\n" for i in range(n)), 1024,
     "expected at most 1024 invariants"),
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
