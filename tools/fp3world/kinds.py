"""The balls of a case, dealt in turn to two kinds that see each other by the same law: what a second kind costs."""

import re

from fp3world import scene as ws
from fp3world import truth

NAMES = ("white", "black")


def model(name, other):
    """programs/world/balls.ode, which sees another kind, too."""
    text = (ws.FOLDER / "balls.ode").read_text(encoding="utf-8")
    text = ws.replace(text, "model balls", f"model {name}")
    text = ws.replace(text, r"near touch\(x, 2\*R\)", f"kind {other}(x[3] [m], v[3] [m/s])\nnear touch(x, 2*R)\nnear meet(x, {other}.x, 2*R)")
    force = re.search(r"^F = sum\(o in touch: (.*)\)$", text, re.M)
    return text.replace(force[0], f"{force[0]} + sum(o in meet: {force[1]})")


def put(lab, case):
    """The scene of both, from where one kind of balls begins."""
    x, _ = truth.at(lab, case, 0)
    numbers = re.search(r"set *= \{.*?\}", case.text(lab.quick))[0]
    groups = []
    for begin, (name, other) in enumerate((NAMES, NAMES[::-1])):
        (lab.folder / f"{name}.ode").write_text(model(name, other), encoding="utf-8")
        points = "".join(",".join(f"{of:.9g}" for of in ball) + "\n" for ball in x[begin::2])
        (lab.folder / f"{name}.csv").write_text("x_x,x_y,x_z\n" + points, encoding="utf-8")
        groups.append(f'{{ program = "{name}.ode"; integrator = "semi_implicit_euler"; points = "{name}.csv"; {numbers}; }}')
    return ws.put(lab.folder, f"steps = 8192;\ngroups = ( {', '.join(groups)} );\n", "dealt")
