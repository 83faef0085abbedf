"""Loads that the compiler makes operands of the arithmetic that reads them: which, and that the sums stay what the equations say."""

import subprocess

import pytest

MODEL = """
state x = 0
state y = 0
state s = 0
links ties{fields}
step 1
x' = 0
y' = 0
s' = {sums}
"""
LINKS = [(0, 1, 2, 3, 5), (0, 2, -1, 4, 7), (1, 2, 3, -2, 6), (3, 0, 5, 1, -4), (2, 3, 1, 8, 2)]
X, Y = [3, -2, 7, 4], [5, 11, -6, 1]
FORMS = ["ldn", "ldl", *(name + kind for name in ("add", "sub", "rsb", "mul") for kind in "nl")]
# Terms, and what a loop has of neighbours: loads are seldom.
CASES = [
    ("o.x", "addn"), ("-o.x", "subn"), ("o.x - x", "rsbn"), ("x - o.x", "subn"), ("max(x*o.x, y)", "muln"), ("max(o.x*x, o.y + y)", "addn muln"),
    ("o.k", "addl"), ("o.k - x", "rsbl"), ("x - o.k", "subl"), ("max(o.k*x, y)", "mull"), ("max(o.k*(o.x - x), y)", "mull rsbn"),
    ("o.x*x", "ldn"),                                       # of three operands
    ("o.x*o.x", "ldn"),                                     # both operands
    ("(o.x - x)*(o.x - y)", "rsbn rsbn"),                   # read twice, and nowhere else
    ("o.x*o.x + (o.x - x)", "ldn"),                         # one of those that read it needs a register
    ("max(o.k*(o.l*(o.x - x)), y)", "mull mull rsbn"),      # fields in another order than theirs
    ("max(o.k*(o.x - x), o.m*o.m)", "ldl ldl rsbn"),        # what stands before a field that is loaded is loaded, too
    ("max(o.k*o.k, o.m*(o.x - x))", "ldl mull rsbn"),       # what stands behind is not
    ("max(o.x, x*x*y)", "ldn"), ("max(max(o.k, o.l)*o.m, y)", "ldl ldl mull"),
]


def value(term, i):
    """Both ends of a link have the other one as a neighbour."""
    total = 0
    for a, b, *fields in LINKS:
        for k in [b] if a == i else [a] if b == i else []:
            total += eval(term, {"x": X[i], "y": Y[i], "max": max, "o": type("Other", (), dict(zip("xyklm", [X[k], Y[k], *fields])))})
    return total


SCENE = """steps = 1;
groups = ( { program = "m.ode"; integrator = "euler"; points = "p.csv"; links = { relation = "ties"; file = "l.csv"; }; } );
"""


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
@pytest.mark.parametrize("term, given", CASES)
def test_a_load_becomes_an_operand(fp3, folder, record, term, given, engine):
    """The fields that the term does not read are left out of the entries."""
    used = [name for name in "klm" if f"o.{name}" in term]
    fields = "(" + ", ".join(f"{name} = 1" for name in used) + ")" if used else ""
    (folder / "m.ode").write_text(MODEL.format(fields=fields, sums=f"sum(o in ties: {term})"))
    (folder / "p.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in zip(X, Y)))
    rows = [[a, b, *(words["klm".index(name)] for name in used)] for a, b, *words in LINKS]
    (folder / "l.csv").write_text(",".join(["a", "b", *used]) + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    made = subprocess.run([fp3, "compile", "m.ode", "-c", "world", "-i", "euler"], cwd=folder, capture_output=True, text=True, timeout=60)
    assert made.returncode == 0, made.stderr
    words = [line.split()[0] for line in made.stdout.split(" each ")[1].split(" next")[0].splitlines()[1:] if line.strip()]
    assert sorted(word for word in words if word in FORMS) == sorted(given.split()), made.stdout
    assert [one["s"] for one in record(SCENE, "-e", engine)[-1]] == [value(term, i) for i in range(len(X))]


SPHERES = """
shared far = 0.01
state x[3] = (0, 0, 0)
state n = 0
all others
step 1
c = sum(o in others: dot(o.x - x, o.x - x) < far ? 1 : 0)
x' = (0*c, 0, 0)
n' = c
"""


def test_a_turn_takes_the_cycles_that_the_pages_tell(fp3, root, tmp_path):
    """Of docs/neighbours.md: a sphere test, a pair of stars, a link of a net."""
    (tmp_path / "spheres.ode").write_text(SPHERES)
    for model, integrator, turn in ((tmp_path / "spheres.ode", "euler", "10 per turn of others"), (root / "programs/world/stars.ode", "leapfrog", "21 per turn of others"),
                                    (root / "programs/world/net.ode", "semi_implicit_euler", "19 per turn of springs")):
        done = subprocess.run([fp3, "compile", model, "-i", integrator, "-c", "world", "--report"], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0 and turn in done.stdout, done.stdout + done.stderr
