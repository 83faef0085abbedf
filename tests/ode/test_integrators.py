"""Tables of integrators: their orders, by the conditions and by experiment, and what is refused."""

import cmath
import math
import re
import subprocess

import pytest
from tables import (NAMES, accelerations, chebyshev_step, energy_error, estimate_to_error, gravity, has_estimate, kepler, linear_step, read, run, run_stoermer,
                    stability)

pytestmark = pytest.mark.smoke
KINDS = ["runge-kutta", "splitting", "stoermer", "rosenbrock", "chebyshev"]


@pytest.fixture
def integrators(build):
    def integrators(*arguments):
        return subprocess.run([build / "tests" / "integrators", *map(str, arguments)], text=True,
                              capture_output=True, timeout=60)

    return integrators


@pytest.fixture
def table(root):
    return lambda name: read(root / "programs/integrators" / f"{name}.cfg")


# ---- trees --------------------------------------------------------------------------------------

def parse_tree(text):
    return () if text == "t" else tuple(parse_tree(part) for part in split_tree(text[1:-1]))


def split_tree(text):
    parts, depth = [""], 0
    for c in text:
        depth += (c == "[") - (c == "]")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return parts


def order(tree):
    return 1 + sum(map(order, tree))


def gamma(tree):
    return order(tree) * math.prod(map(gamma, tree))


def canonical(tree):
    return tuple(sorted(map(canonical, tree)))


def test_there_are_as_many_trees_as_there_should_be_and_all_differ(integrators):
    rows = [line.split() for line in integrators("trees").stdout.splitlines()]
    trees = [parse_tree(text) for _, _, text in rows]
    assert [sum(n == str(k) for n, _, _ in rows) for k in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert len({canonical(tree) for tree in trees}) == 200
    assert [(order(tree), gamma(tree)) for tree in trees] == [(int(n), int(g)) for n, g, _ in rows]


# ---- the tables that are built in ---------------------------------------------------------------

def test_the_list_is_complete(integrators):
    names = [line.split()[0] for line in integrators("list").stdout.splitlines()]
    assert names == NAMES and "rk4" in NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_table_has_the_order_that_it_claims_and_no_more(name, integrators, table):
    got = integrators("show", name)
    assert (got.returncode, got.stderr) == (0, "")
    first, doc, source, *rows = got.stdout.splitlines()
    line, t = first.split(), table(name)
    assert line[0] == name == t["name"] and KINDS[int(line[1])] == t["kind"]
    assert int(line[3]) == int(line[5]) == t["order"]
    assert int(line[4]) == (1 if t["late_position"] else t["order"])
    assert float(line[6]) < 1e-13 and (float(line[7]) > 1e-6 or t["order"] == 8)  # beyond 8 the experiment below tells
    assert (doc, source) == (f"doc {t['doc']}", f"source {t['source']}")
    if t["kind"] == "splitting":
        for row, (which, x) in zip(rows, t["substeps"], strict=True):
            assert row.split()[0] == which and float(row.split()[1]) == pytest.approx(x, rel=1e-15)
    elif t["kind"] == "chebyshev":
        check_recurrence(t, rows)
    elif t["kind"] == "runge-kutta":
        for row, a, b in zip(rows, t["A"], t["b"], strict=True):
            numbers = [float(x) for x in row.split() if x not in "cba"]
            assert numbers == pytest.approx([sum(a), b, *a], rel=1e-15, abs=1e-16)


def check_recurrence(t, rows):
    """What the library makes of the recurrence is what the paper's equations come to, on y' = t^9 + y/3."""
    c, b, *a = zip(*([float(x) for x in row.split() if x not in "cba"] + [0.0] * len(rows) for row in rows))
    h, k = 0.7, []
    for i, at in enumerate(c):
        k.append(at**9 + (1 + h * sum(row[i] * one for row, one in zip(a, k))) / 3)
    (_, got) = chebyshev_step(t, lambda y: [1.0 / h, y[0] ** 9 + y[1] / 3], [0.0, 1.0], h)
    assert 1 + h * sum(x * y for x, y in zip(b, k)) == pytest.approx(got, rel=1e-13)
    assert len(rows) == t["stages"] + 1 and (b[-1], c[-1]) == (0, pytest.approx(1, rel=1e-13))


@pytest.mark.parametrize("stages", [2, 3, 8, 20])
@pytest.mark.parametrize("damping", ["0", '"2/13"', "10"])
def test_every_number_of_stages_has_order_2(stages, damping, integrators, tmp_path):
    path = tmp_path / "mine.cfg"
    path.write_text(RKC.replace("5", str(stages)).replace('"2/13"', damping))
    line = integrators("show", path).stdout.split()
    assert line[2:6] == [str(stages + 1), "2", "2", "2"] and float(line[6]) < 1e-12


# Numbers of steps at which the error shows the order, and not rounding.
STEPS = {1: 4096, 2: 512, 3: 256, 4: 128, 5: 128, 6: 32, 8: 16}


@pytest.mark.parametrize("name", NAMES)
def test_the_error_of_an_orbit_falls_with_the_order(name, table):
    t = table(name)
    order = 1 if t["late_position"] else t["order"]
    (x, v), (end, _) = kepler(0.3, 0.5), kepler(0.3, 2.5)
    errors = []
    for steps in (STEPS[order], 2 * STEPS[order]):
        h = 2.0 / steps
        at = (run_stoermer(gravity, kepler(0.3, 0.5 - h)[0], x, h, steps) if t["kind"] == "stoermer"
              else run(t, gravity, x, v, h, steps)[0])
        errors.append(math.dist(at, end))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.12)


def drag_orders(t):
    """The orders of x and v for v' = 1 - v^2, x' = v, whose solution is v = tanh t, x = log cosh t."""
    errors = []
    for steps in (STEPS[t["order"]] // 4, STEPS[t["order"]] // 2):
        (x,), (v,) = run(t, lambda x, v: [1 - v[0] ** 2], [0.0], [0.0], 1.5 / steps, steps)
        errors.append((abs(x - math.log(math.cosh(1.5))), abs(v - math.tanh(1.5))))
    return [math.log2(a / b) for a, b in zip(*errors)]


def test_a_late_position_is_of_first_order_and_its_velocity_is_not(table):
    assert drag_orders(table("rk4_paper")) == [pytest.approx(1, abs=0.1), pytest.approx(4, abs=0.2)]


@pytest.mark.parametrize("name", ["verlet", "leapfrog", "forest_ruth", "pefrl", "yoshida6", "blanes_moan6"])
def test_a_splitting_is_of_first_order_where_there_is_drag(name, table):
    assert drag_orders(table(name) | {"order": 1}) == [pytest.approx(1, abs=0.1)] * 2


def test_the_page_says_what_is_so(root, table, long):
    """Limits and errors, which take long, of every third integrator (all)."""
    page = (root / "docs/integrators.md").read_text()
    rows = {cells[0].strip("`"): cells[1:] for cells in
            (re.split(r"\s*\|\s*", line.strip("| ")) for line in page.splitlines() if line.startswith("| `"))
            if len(cells) == 9}
    assert list(rows) and sorted(rows) == NAMES
    for i, (name, (kind, order, late, price, decay, swing, error, source)) in enumerate(sorted(rows.items())):
        t = table(name)
        assert [kind, order, late, price, source] == [
            t["kind"], str(t["order"]), "1" if t["late_position"] else str(t["order"]), str(accelerations(t)), t["source"]]
        if i % 3 and not long:
            continue
        assert [decay, swing] == ["-" if x is None else f"{x:.2f}" if x else "0" for x in stability(t)], name
        assert error == ("-" if t["kind"] == "stoermer" else f"{energy_error(t):.1g}"), name


def evaluations(t, acceleration, start, end, time, error=1e-6):
    """Of the right-hand side until that error, between numbers of steps that grow by the square root of 2."""
    before, n = None, 200 / accelerations(t)
    while True:
        steps = round(n)
        off = math.dist(sum(run(t, acceleration, *start, time / steps, steps), []), end)
        if off <= error:
            share = math.log(before[1] / error) / math.log(before[1] / off)
            return accelerations(t) * before[0] * (steps / before[0]) ** share
        before, n = (steps, off), n * math.sqrt(2)


@pytest.mark.long
def test_the_page_says_how_many_evaluations_small_errors_take(root, table):
    rows = [re.split(r"\s*\|\s*", line.strip("| ")) for line in (root / "docs/integrators.md").read_text().split("## Small errors")[1].split("\n## ")[0].splitlines() if line.startswith("| ")]
    names = [cell.strip("`") for cell in rows[0]]
    exact = sum(run(table("rk8"), lambda x, v: [-9.81 * math.sin(x[0])], [2.0], [0.0], 8 / 1024, 1024), [])
    problems = {"Kepler": (gravity, kepler(0.5, 0), sum(kepler(0.5, 12.5), []), 12.5),
                "pendulum": (lambda x, v: [-9.81 * math.sin(x[0])], ([2.0], [0.0]), exact, 8.0)}
    for name, cell in ((name, i) for i, name in enumerate(names) if name in NAMES):
        for row, problem in zip(rows[1:3], problems.values(), strict=True):  # the first table
            assert int(row[1 + cell]) == pytest.approx(evaluations(table(name), *problem), rel=0.01), name


# h lambda of the columns of the page's table of estimates; in the last three a step is much longer than what decays.
RATES = [-0.1, -1, -2, 0.1j, 1j, 2j, 1, -10, -100, -1e4]


def test_the_page_says_what_estimates_see(root, table):
    page = (root / "docs/integrators.md").read_text()
    rows = {cells[0].strip("`"): cells[1:] for cells in
            (re.split(r"\s*\|\s*", line.strip("| ")) for line in page.splitlines() if line.startswith("| `"))
            if len(cells) == 1 + len(RATES)}
    assert sorted(rows) == [name for name in NAMES if has_estimate(table(name))]
    for name, row in rows.items():
        assert row == [f"{estimate_to_error(table(name), z):.2g}" for z in RATES], name


@pytest.mark.parametrize("name", NAMES)
def test_no_estimate_is_blind(name, table):
    """Of what decays, swings or both, wherever a step is off by 1e-6 to 0.3: at least a sixth of the error. An estimate that is 0 at one h lambda fails, too."""
    t = table(name)
    if not has_estimate(t):
        return
    for degrees in (180, 165, 150, 135, 120, 90):
        for n in range(551):
            z = 10 ** (-2 + n / 100) * cmath.exp(1j * math.radians(degrees))
            error = abs(linear_step(t, z)[0] - cmath.exp(z))
            assert not 1e-6 < error < 0.3 or estimate_to_error(t, z) > 1 / 6, (degrees, abs(z))


# ---- tables that are refused --------------------------------------------------------------------

HEAD = 'name = "mine"; doc = "d"; source = "s"; kind = "{}"; order = {};\n'
RK4 = HEAD.format("runge-kutta", 4) + """A = ((),
     ("1/2"),
     (0, "1/2"),
     (0, 0, 1));
b = ("1/6", "1/3", "1/3", "1/6");
"""
VERLET = HEAD.format("splitting", 2) + """substeps = ({ kick = "1/2"; },
            { drift = 1; },
            { kick = 0.5; });
"""
STOERMER = HEAD.format("stoermer", 2)
RKC = HEAD.format("chebyshev", 2) + 'stages = 5;\ndamping = "2/13";\n'
ROS2 = HEAD.format("rosenbrock", 2) + """gamma = "1 - 1/sqrt(2)";
A = ((),
     (1));
G = ((),
     ("-2 + sqrt(2)"));
b = ("1/2", "1/2");
"""
ROS3P = HEAD.format("rosenbrock", 3) + """gamma = "1/2 + sqrt(3)/6";
A = ((),
     (1),
     (1, 0));
G = ((),
     (-1),
     ("-(1/2 + sqrt(3)/6)", "1/2 - 2*(1/2 + sqrt(3)/6)"));
b = ("2/3", 0, "1/3");
"""

WRONG = [
    # base, what is replaced, by what, line, message
    (RK4, 'name = "mine";', "", 1, "found no 'name', expected one"),
    (RK4, '"mine"', '"my own"', 1, "name: found 'my own', expected a name"),
    (RK4, '"mine"', "4", 1, "name: found '4', expected a text in quotes"),
    (RK4, 'doc = "d";', "", 1, "found no 'doc', expected one"),
    (RK4, '"s"', "( )", 1, "source: found a list ( ) of 0, expected a text in quotes"),
    (RK4, '"runge-kutta"', '"rk"', 1, "kind: found 'rk', expected runge-kutta, splitting, stoermer, rosenbrock or chebyshev"),
    (RK4, "order = 4", "order = 4.0", 1, "order: found '4.0', expected an integer from 1 to 8"),
    (RK4, "order = 4", "order = 0", 1, "order: found '0', expected an integer from 1 to 8"),
    (RK4, "order = 4", "order = 9", 1, "order: found '9', expected an integer from 1 to 8"),
    (RK4, "b = (", "B = (", 6, "found 'B', expected a setting of an integrator: name, doc, source, kind, order, late_position, A, b, gamma, G, embedded, embedded_order, substeps, stages, damping (did you mean 'b'?)"),
    (RK4, "b = (", "substeps = (); b = (", 6, "found 'substeps', which kind runge-kutta does not have"),
    (RK4, "b = (", "late_position = 1; b = (", 6, "late_position: found '1', expected true or false"),
    (RK4, "A = (", "X = (", 2, "found 'X'"),
    (RK4, '     ("1/2"),\n', '     "1/2",\n', 3, "A[2]: found a text, expected a list ( )"),
    (RK4, '(0, "1/2")', "(0)", 4, "A[3]: found the length 1, expected 2 (below the diagonal) or 4 (all)"),
    (RK4, '(0, "1/2")', '(0, "1/2", 0)', 4, "A[3]: found the length 3, expected 2"),
    (RK4, '(0, "1/2")', '(0, "1/2", "1/8", 0)', 4, "A[3][3]: found 0.125, expected 0 on and above the diagonal"),
    (RK4, "((),", "((0, 0, 1, 0),", 2, "A[1][3]: found 1, expected 0 on and above the diagonal"),
    (RK4, "(0, 0, 1)", "(0, 0, true)", 5, "A[4][3]: found true or false, expected a number or a text like \"1/6\""),
    (RK4, "(0, 0, 1)", '(0, 0, "1/")', 5, "A[4][3]: "),
    (RK4, "(0, 0, 1)", '(0, 0, "one")', 5, "A[4][3]: "),
    (RK4, "(0, 0, 1)", "(0, 0, 1e999)", 5, "A[4][3]: found '1e999', expected a number below 1.8e308"),
    (RK4, '"1/3", "1/3", ', '"1/3", ', 6, "b: found the length 3, expected 4, one for each row of A"),
    (RK4, '"1/3", "1/3", ', '"1/3", 0.334, ', 6, "b: found the sum 1.00066666667, expected 1"),
    (RK4, 'b = ("1/6", "1/3", "1/3", "1/6")', 'b = "1/6"', 6, "b: found a text, expected a list ( )"),
    (RK4, 'b = ("1/6", "1/3", "1/3", "1/6");', "", 1, "found no 'b', expected one"),
    (RK4, "order = 4", "order = 5", 1, "order 5 claimed: the condition of the tree ["),
    (RK4, '("1/2"),\n     (0, "1/2")', '(0.501),\n     (0, "1/2")', 1,
     "order 4 claimed: the condition of the tree [t] is off by 0.00033"),
    (RK4, '"1/3", "1/3"', '"0.3333", "1 - 0.3333 - 1/3"', 1, "order 4 claimed: the condition of the tree [[t]] is off by 8.3e-06"),
    (RK4, "A = (", "A = (" + "(), " * 21, 2, "A: found 25 rows, expected 1 to 24"),
    (RK4, "b = (", "b = (\n,", 7, "syntax error"),
    (RK4, "A = (", "order = 3; A = (", 2, "duplicate setting name"),
    (VERLET, '"splitting"', '"stoermer"', 2, "found 'substeps', which kind stoermer does not have"),
    (VERLET, "{ drift = 1; }", "{ drift = 1; kick = 0; }", 3,
     "substeps[2]: found a group { }, expected { kick = number; } or { drift = number; }"),
    (VERLET, "{ drift = 1; }", "{ }", 3, "substeps[2]: found a group { }"),
    (VERLET, "{ drift = 1; }", "{ push = 1; }", 3, "substeps[2]: found a group { }, expected"),
    (VERLET, "{ drift = 1; }", "1", 3, "substeps[2]: found '1', expected"),
    (VERLET, "{ drift = 1; }", "{ drift = ( ); }", 3, "substeps[2]: found a list ( ) of 0, expected a number"),
    (VERLET, "{ drift = 1; }", "{ drift = 0.999; }", 2, "substeps: found the sum 0.999 of all drifts, expected 1"),
    (VERLET, "0.5", "0.51", 2, "substeps: found the sum 1.01 of all kicks, expected 1"),
    (VERLET, '"1/2"', "0.501", 2, "substeps: found the sum 1.001 of all kicks, expected 1"),
    (VERLET, "order = 2", "order = 3", 1, "order 3 claimed: the condition of the tree ["),
    (VERLET, '"1/2"; },\n            { drift = 1; },\n            { kick = 0.5; }', '0.501; }, { drift = 1; }, { kick = 0.499; }', 1,
     "order 2 claimed: the condition of the tree [t], for positions, is off by 0.001"),
    (VERLET, "substeps = (", "substeps = ( ); x = (", 2, "found 'x'"),
    (ROS2, "order = 2", "order = 3", 1, "order 3 claimed: the condition of the tree ["),
    (ROS2, '"1 - 1/sqrt(2)"', "0.3", 1, "order 2 claimed: the condition of the tree [t] is off by 0.0071"),
    (ROS2, '"1 - 1/sqrt(2)"', "0", 2, "gamma: found 0, expected above 0 and below 100"),
    (ROS2, 'gamma = "1 - 1/sqrt(2)";', "", 1, "found no 'gamma', expected one"),
    (ROS2, 'G = ((),\n     ("-2 + sqrt(2)"));', "", 1, "found no 'G', expected one"),
    (ROS2, 'G = ((),', "G = ((), (0),", 5, "G: expected a list of 2 rows, as A is"),
    (ROS2, '("-2 + sqrt(2)")', '("-2 + sqrt(2)", 1)', 6, "G[2][2]: found 1, expected 0 on and above the diagonal"),
    (RK4, "b = (", "gamma = 1; b = (", 6, "found 'gamma', which kind runge-kutta does not have"),
    (RKC, "order = 2", "order = 3", 1, "order 3 claimed: the condition of the tree ["),
    (RKC, "stages = 5;\n", "", 1, "found no 'stages', expected one"),
    (RKC, 'damping = "2/13";', "", 1, "found no 'damping', expected one"),
    (RKC, "= 5", "= 1", 2, "stages: found '1', expected an integer from 2 to 20"),
    (RKC, "= 5", "= 21", 2, "stages: found '21', expected an integer from 2 to 20"),
    (RKC, "= 5", "= 5.5", 2, "stages: found '5.5', expected an integer from 2 to 20"),
    (RKC, '"2/13"', "-0.1", 3, "damping: found -0.1, expected 0 to 10"),
    (RKC, '"2/13"', '"10 + 1e-9"', 3, "damping: found 10, expected 0 to 10"),
    (RKC, "= 5", '= 5; A = (())', 2, "found 'A', which kind chebyshev does not have"),
    (RK4, "b = (", "stages = 4; b = (", 6, "found 'stages', which kind runge-kutta does not have"),
    # Lang and Verwer's own, and others of second order: all that there are lie on one line.
    (ROS3P, "b = (", 'embedded = ("1/3", "1/3", "1/3"); embedded_order = 2; b = (', 9,
     "embedded: found 0 as the error of y' = a y, whatever the step (b.(A + G)^k.1 is the same by both methods for all k), expected another method"),
    (ROS3P, "b = (", 'embedded_order = 2;\nembedded = ("1/2", 0.1666666666667, "1/3"); b = (', 10, "embedded: found 0 as the error of y' = a y, whatever the step"),
    (RK4, "b = (", 'embedded = ("1/6", "1/3", "1/3", "1/6"); embedded_order = 4; b = (', 6,
     "embedded: found 0 as the error of y' = a y, whatever the step (b.A^k.1 is the same by both methods for all k), expected another method"),
    (RK4, "b = (", 'embedded = ("1/6", "2/3", 0, "1/6"); embedded_order = 2; b = (', 6,
     "embedded: found 0 as the error of y' = f(t), whatever the step (b.c^k is the same by both methods for all k), expected another method"),
    (STOERMER, "order = 2", "order = 4", 1, "order 4 claimed: this method has order 2"),
    (STOERMER, ";\n", ";\nA = ( );", 2, "found 'A', which kind stoermer does not have"),
]


@pytest.mark.parametrize("base, old, new, line, message", WRONG, ids=map(str, range(len(WRONG))))
def test_a_wrong_table_is_refused_with_its_line(base, old, new, line, message, integrators, tmp_path):
    assert base.count(old) >= 1
    path = tmp_path / "mine.cfg"
    path.write_text(base)
    assert integrators("show", path).returncode == 0
    path.write_text(base.replace(old, new, 1))
    got = integrators("show", path)
    assert (got.returncode, got.stdout) == (2, "")
    assert got.stderr.startswith(f"{path}:{line}: {message}") and got.stderr.count("\n") == 1


@pytest.mark.parametrize("name", [n for n in NAMES if n != "stoermer_verlet" and "rkc" not in n])
def test_a_number_that_is_wrong_in_its_third_digit_is_found(name, root, table, integrators, tmp_path):
    """Each number that is not 0, in turn."""
    text = re.sub(r"#.*\n", "", (root / f"programs/integrators/{name}.cfg").read_text())
    head, body = re.split(r"(?=A = |substeps = )", text)
    places = [m for m in re.finditer(r'"[^"]*"|(?<=[ (])-?[\d.]+(?=[,;) ])', body) if m[0] != "0"]
    assert len(places) >= (1 if name == "euler" else 2)
    for m in places:
        path = tmp_path / "spoiled.cfg"
        path.write_text(head + body[:m.start()] + f'"({m[0].strip(chr(34))})*1.002"' + body[m.end():])
        got = integrators("show", path)
        assert got.returncode == 2 and f"{path}:" in got.stderr, m[0]


def test_a_table_may_claim_less_and_its_doc_says_so(integrators, tmp_path):
    path = tmp_path / "mine.cfg"
    path.write_text(RK4.replace("order = 4", "order = 3"))
    got = integrators("show", path).stdout.splitlines()
    assert got[0].split()[3:6] == ["3", "3", "4"] and got[1] == "doc d (the conditions of order 4 hold, too)"


def test_a_full_matrix_is_a_table_too(integrators, tmp_path):
    path = tmp_path / "mine.cfg"
    path.write_text(HEAD.format("runge-kutta", 2) + "A = ((0, 0), (0.5, 0)); b = [0, 1];")
    assert integrators("show", path).returncode == 0


def test_what_is_not_there_is_said(integrators, tmp_path):
    got = integrators("show", "rk5")
    assert got.returncode == 2
    assert got.stderr == f"no integrator 'rk5': there are {', '.join(NAMES)}, and files that end in .cfg\n"
    assert "cannot open" in integrators("show", "rk5.cfg").stderr
    assert "cannot open" in integrators("show", tmp_path / "rk5").stderr
    (tmp_path / "nul.cfg").write_bytes(RK4.encode() + b"\0")
    assert "found a NUL byte, expected text" in integrators("show", tmp_path / "nul.cfg").stderr


# McLachlan and Atela 1992: fourth order for x'' = a(x), third for splittings of other things.
NYSTROM = zip(["0.1344961992774310892", "-0.2248198030794208058", "0.7563200005156682911", "0.3340036032863214255"],
              ["0.5153528374311229364", "-0.085782019412973646", "0.4415830236164665242", "0.1288461583653841854"])


def test_conditions_are_those_of_second_order_equations(integrators, tmp_path):
    path = tmp_path / "mine.cfg"
    path.write_text(HEAD.format("splitting", 4) + "substeps = ("
                    + ", ".join(f"{{ kick = {b}; }}, {{ drift = {a}; }}" for b, a in NYSTROM) + ");\n")
    assert integrators("show", path).stdout.split()[2:6] == ["8", "4", "4", "4"]
    path.write_text(path.read_text().replace("order = 4", "order = 5"))
    assert "order 5 claimed: the condition of the tree" in integrators("show", path).stderr
