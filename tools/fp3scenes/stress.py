"""Limits of scenes whose objects see each other, each beside what they do in a run: theory is a formula, or eigenvalues by NumPy; what is found
comes from `fp3 run` and `fp3 stress SCENE`."""

import json
import math
import subprocess

import numpy as np
from fp3gen.text import evidence, markdown
from fp3world import contact
from fp3world import scene as ws
from fp3world.physics import Lab, relative, row

CHAIN = """shared k = 100
shared c = 0
state u = 0
state v = 0
links s
u' = v
v' = sum(o in s: k*(o.u - u) + c*(o.v - v))
step 0.05
"""
STACK = """shared k = 1000
shared c = 0
shared R = 0.05
shared m = 0.01
state x = 0
state v = 0
near touch(x, 2*R)
x' = v
v' = -9.81 + (sum(o in touch: (k*(abs(o.x - x) - 2*R)/abs(o.x - x))*(o.x - x) + c*(o.v - v)) + (x < R ? k*(R - x) - c*v : 0*x))/m
step 0.001
"""
# Hairer and Wanner, Solving Ordinary Differential Equations II, IV.2: |R(iz)| = 1 and |R(-z)| = 1; of the others the eigenvalues of a step.
SPRINGS = {"semi_implicit_euler": 2, "leapfrog": 2, "rk4": math.sqrt(8)}
DAMPERS = {"semi_implicit_euler": 2, "leapfrog": 2, "rk4": 2.785294}
SHIPPED = ["balls", "chain", "cloth", "cradle", "dam", "eight", "pair", "planets", "players", "rope", "slope", "stars"]
SCENES = ["springs", "dampers", "told", "wave", "stack", "drift", *SHIPPED]
HEAD = """\
`fp3 stress SCENE` (a path that ends in `.scene`) says how near its limits a scene of objects that see each other comes:

    $ fp3 stress programs/world/cloth.scene
    ok   scene: cloth, semi_implicit_euler: h omega of springs, h = 0.000977, object 133 at time 3: measured 0.8708562, expected at most 2
    ok   scene: cloth, semi_implicit_euler: h c/m of dampers, h = 0.000977, object 150 at time 0: measured 0.07977317, expected at most 2
    ok   scene: cloth, semi_implicit_euler: growth of a small error in a step, h = 0.000977: measured 1, expected at most 1

It runs the scene on the engine `fast`, and looks at the start and at each eighth of its steps. The host linearises the equations of all objects in double.
ω² is the largest eigenvalue of -∂v'/∂x, and c/m that of ∂v'/∂v (and of equations of first order), by 200 turns of a power iteration. The limits are those of
the integrator, for springs without dampers and for dampers without springs. If every oscillation grows by the integrator, the limit is where it grows by a fifth in a
step. Both together decide the third figure: how much one step of the integrator enlarges a small disturbance of all objects. It is 1 if
nothing grows, or if the motion itself grows as fast. Otherwise a longest step is named, and the exit code is 3. If objects hardly ever touch in the run, a few are also
put side by side. Of large scenes the objects that answer a disturbance most are looked at, and a figure may be some percent low. Adaptive
steps are refused: they become shorter by themselves. `fp3 run` looks at the [third figure](command.md#is-the-result-right), and warns."""

FAR = 1e3       # times as far as at first: it grows
PARTS = 1 / 512  # of a limit, how finely it is looked for
AT_LEAST, AT_MOST = "at least", "at most"


def bounded(scene, what, relation, expected, found, why):
    return {**row(scene, what, expected, found, 0, why), "relation": relation, "holds": bool(found >= expected if relation == AT_LEAST else found <= expected)}


class Bench(Lab):
    def scene(self, group, model, steps):
        (self.folder / "stressed.ode").write_text(model, encoding="utf-8")
        return ws.put(self.folder, f'config = "world"; steps = {steps}; groups = ( {{ program = "stressed.ode"; {group} }} );', "stressed")

    def snapshots(self, group, model, steps, every=None):
        return ws.record(self.fp3, self.scene(group, model, steps), "--every", every or steps)

    def stress(self, path):
        """Rows of fp3 stress; what it refuses is Failed."""
        output = self.folder / "stress.json"
        done = subprocess.run([self.fp3, "stress", path, "--json", output, *(["--quick"] if self.quick else [])], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise ws.Failed(done.stderr.strip())
        return json.loads(output.read_text(encoding="utf-8"))["results"]


def limit(grows, about):
    """The largest h with which nothing grows, by halves; NaN: not near what is expected."""
    low, high = 0.9 * about, 1.1 * about
    if grows(low) or not grows(high):
        return math.nan
    while high - low > PARTS * about:
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return (low + high) / 2


def grows_in(bench, of, model, state, steps):
    """Whether a state has become FAR times as large, or no number."""
    def grows(h):
        try:
            found, _ = bench.snapshots(of(h), model, steps)
        except ws.Failed as why:
            if "object" in str(why):
                return True
            raise
        return not abs(found[state][-1]).max() < FAR * abs(found[state][0]).max()
    return grows


def line(count, integrator, settings, struck):
    return (f'integrator = "{integrator}"; grid = {{ count = {count}; }}; links = {{ relation = "s"; grid = "structural"; }}; set = {{ {settings} }};'
            f' only = {{ objects = {struck[0]}; set = {{ {struck[1]} = {struck[2]!r}; }}; }};')


# ---- limits of steps ----

def springs(bench):
    """omega = 2 sqrt(k/m) cos(pi/2N) of N free masses (Goldstein, Classical Mechanics, chapter 13)."""
    omega = 20 * math.cos(math.pi / 64)
    for name, z in SPRINGS.items():
        found = limit(grows_in(bench, lambda h: line(32, name, f"h = {h!r};", (15, "u", 1.0)), CHAIN, "u", 4096), z / omega)  # pylint: disable=cell-var-from-loop
        yield relative("springs", f"h omega beyond which 32 masses on springs grow, {name}", z, found * omega, 4e-3, "how finely it is looked for, and what grows less than 1,000 times in 4,096 steps")


def dampers(bench):
    """Two masses part by exp(-2 c t/m)."""
    for name, z in DAMPERS.items():
        found = limit(grows_in(bench, lambda h: line(2, name, f"h = {h!r}; k = 0.0; c = 3.0;", (0, "v", 1.0)), CHAIN, "v", 4096), z / 6)  # pylint: disable=cell-var-from-loop
        yield relative("dampers", f"h 2c/m beyond which two masses at a damper grow, {name}", z, 6 * found, 4e-3, "how finely it is looked for")


def sheet():
    """The highest angular frequency of the cloth, flat, at rest and without weight: eigenvalues of its stiffness."""
    count, spacing, mass = 20, 0.05, 0.001
    links = [(link, k) for kinds, k in ((["structural", "shear"], 100), (["bending"], 10)) for link in ws.grid_links((count, count), spacing, kinds)]
    places = np.array([(i % count, i // count) for i in range(count * count)]) * spacing
    stiff = np.zeros((count * count, 2, count * count, 2))
    for (a, b, _), k in links:
        way = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            stiff[i, :, j] += sign * k / mass * np.outer(way, way)
    free = [i for i in range(2 * count * count) if i // 2 not in (0, 19)]
    return math.sqrt(np.linalg.eigvalsh(stiff.reshape(2 * count * count, -1)[np.ix_(free, free)])[-1])


def cloth(bench):
    omega = sheet()
    text = ws.replace(ws.text_of("cloth"), 'integrator = "semi_implicit_euler";', 'integrator = "semi_implicit_euler"; set = { h = %r; c = 0.0; air = 0.0; g_y = 0.0; };')
    text = ws.replace(text, r"only    = \{ objects = \[0, 19\]; set = \{ w = 0.0; \}; \};",
                      "only = ( { objects = [0, 19]; set = { w = 0.0; }; }, { objects = 210; set = { v_x = 1e-4; }; } );")

    def grows(h):
        try:
            found, _ = bench.record(text % h, "--steps", 2048, "--every", 2048)
        except ws.Failed:
            return True
        return not abs(found["v_x"][-1]).max() < 0.1
    yield relative("cloth", "h omega beyond which the cloth grows, flat and without dampers", 2, omega * limit(grows, 2 / omega), 6e-3, "how finely it is looked for")
    named = {r["name"].split(",")[0]: r for r in bench.stress(ws.put(bench.folder, text % 2.0 ** -10, "flat"))}
    yield relative("cloth", "h omega that fp3 stress names", omega / 1024, named["h omega of springs"]["measured"], 2e-3, "a power iteration of 200 turns; the speed of one mass bends the cloth a little")


def dam(bench):
    """Monaghan, Smoothed particle hydrodynamics, Annual Review of Astronomy and Astrophysics 30 (1992): h (1 + 0.6 viscosity) c/width below 0.4."""
    stays = 0
    for courant in (0.3, 0.4, 0.5, 0.7):
        h = courant * 0.065 / 20 / 1.06
        text = ws.replace(ws.text_of("dam"), 'integrator = "heun";', f'integrator = "heun"; set = {{ h = {h!r}; }};')
        try:
            found, _ = bench.record(text, "--steps", round(1.2 / h), "--every", round(0.1 / h))
        except ws.Failed:
            break
        if not abs(found["rho"] - 1).max() < 0.1:
            break
        stays = courant
    yield bounded("dam", "Courant number (1 + 0.6 thick) c h/wide with which water stays within 10 % of its density", AT_LEAST, 0.4, stays, "0.3, 0.4, 0.5 and 0.7 are tried")


def told(bench):
    """fp3 run warns either side of the limit."""
    wrong = 0
    for name, z in SPRINGS.items():
        for share in (0.95, 1.05):
            path = bench.scene(line(8, name, f"h = {share * z / 20 / math.cos(math.pi / 16)!r};", (3, "u", 1e-9)), CHAIN, 128)
            said = subprocess.run([bench.fp3, "run", "--scene", path, "--allow-failures"], capture_output=True, text=True).stderr
            wrong += ("the step is too long" in said) != (share > 1)
    yield row("told", "of 6 runs at 0.95 and 1.05 of the limit, those that fp3 run warns of and should not, or the reverse", 0, wrong, 0, "")


def shipped(bench):
    """What fp3 stress says of the scenes of programs/world."""
    for name in ("balls", "pair") if bench.quick else SHIPPED:
        for found in bench.stress(ws.FOLDER / f"{name}.scene"):
            yield bounded(name, found["name"].split(", object")[0], AT_MOST, found["expected"], found["measured"], found["why"])


# ---- long runs, contact ----

def drift(bench):
    """A symplectic method keeps an energy that differs by (h omega)^2 of the real one (Hairer, Lubich and Wanner, Geometric Numerical Integration, IX); the
    classical method of Runge and Kutta loses z^6/72 - z^8/576 of it in a step, z = h omega."""
    z, omega = 0.2, math.sqrt(200)
    for name, steps in (("leapfrog", 10 ** 5 if bench.quick else 10 ** 7), ("rk4", 10 ** 5 if bench.quick else 10 ** 6)):
        found, _ = bench.snapshots(line(2, name, f"h = {z / omega!r};", (0, "u", 1.0)), CHAIN, steps, steps // 1000 + 1)
        energy = (found["v"] ** 2).sum(1) / 2 + 50 * (found["u"][:, 1] - found["u"][:, 0]) ** 2
        if name == "rk4":
            left = (1 - z ** 6 / 72 + z ** 8 / 576) ** (steps // (steps // 1000 + 1) * (steps // 1000 + 1))
            yield relative("drift", f"energy after {steps} steps of rk4 at h omega = {z}, of the first", left, energy[-1] / energy[0], 5e-3, "a rounding of 2^-24 in each step is a random walk, and coefficients are FP32 numbers")
        else:
            part = len(energy) // 8
            yield row("drift", f"energy of two masses at a spring: mean of the last eighth of {steps} steps, of the first eighth", 1, energy[-part:].mean() / energy[:part].mean(), 2e-3,
                      "bounded, and a random walk of roundings of 2^-24: 1e-4 in 10^7 steps")


def stack(bench):
    """A column stands lower by what its weight presses: ball i by (n - i) m g/k more than the one below it."""
    n, m, r = 20, 0.01, 0.05
    for k in (300, 3000, 30000):
        fast = math.sqrt(k / m)
        h = 0.1 / fast
        group = (f'integrator = "semi_implicit_euler"; objects = {n}; set = {{ k = {float(k)!r}; c = {2 * math.sqrt(k * m)!r}; h = {h!r}; }};'
                 f' spread = {{ x = [{r}, {(2 * n - 1) * r!r}]; }};')
        found, _ = bench.snapshots(group, STACK, 40000)
        pressed = m * 9.81 / k * np.arange(n, 0, -1)
        places = np.cumsum(np.concatenate([[r - pressed[0]], 2 * r - pressed[1:]]))
        yield row("stack", f"height of {n} balls, stiffness {k} N/m, m", places[-1], found["x"][-1].max(), 2e-5, "a rounding of 2^-24 of 2 m, and what still moves")
        yield row("stack", f"largest error of a ball's place, stiffness {k} N/m, m", 0, abs(np.sort(found["x"][-1]) - places).max(), 2e-5, "likewise")


def bessel(orders, x):
    """J_n(x) by Bessel's integral, whose trapezoidal sum is exact but for roundings."""
    angle = np.arange(4096) * 2 * np.pi / 4096
    return np.cos(np.multiply.outer(orders, angle) - x * np.sin(angle)).mean(1)


def wave(bench):
    """Of an endless chain one mass is struck: v_n = v J_2n(2 t sqrt(k/m)) (Schroedinger, Annalen der Physik 44, 1914)."""
    count, middle, h = 401, 200, 2.0 ** -9
    found, times = bench.snapshots(line(count, "leapfrog", f"h = {h!r};", (middle, "v", 1.0)), CHAIN, 4608, 32)
    away = np.arange(-150, 151)
    speeds = np.array([bessel(2 * abs(away), 20 * t) for t in times[-24:]])
    yield row("wave", "largest difference of a speed from Bessel's functions, of the first one's", 0, abs(found["v"][-24:, middle + away] - speeds).max(), 1e-3,
              "leapfrog is ahead by (h omega)^2/24 of the time of a wave")
    t = times[-1]
    front = np.argmax(found["v"][-1, middle:]), np.argmax(bessel(2 * np.arange(middle + 1), 20 * t))
    yield relative("wave", "speed of the front, masses in a second", front[1] / t, front[0] / t, 0.01, "a front is at a mass; sound itself goes sqrt(k/m) = 10")


def held(bench):
    """What other pages hold against theory: restitution, chains of contacts, momentum."""
    for check in (contact.pair,) if bench.quick else (contact.pair, contact.cradle, contact.players):
        yield from check(bench)


CHECKS = [springs, dampers, cloth, dam, told, drift, stack, wave, held, shipped]


# ---- the part ----

def measure(options, say):
    bench, rows = Bench(options.fp3, options.folder, options.quick), []
    for check in CHECKS:
        say(f"limits, {check.__name__}")
        rows += check(bench)
    return [found for found in rows if not options.scenes or found["scene"] in options.scenes]


def wrong(rows):
    for found in rows:
        if not found["holds"]:
            yield f"{found['scene']}: {found['what']}: found {found['found']:.7g}, expected {found.get('relation', 'about')} {found['expected']:.7g}: {found['why']}"


def limit_text(found):
    return " ".join(word for word in (found.get("relation"), f"{found['expected']:.5g}") if word)


def pages(rows, _):
    body, before = [], None
    for found in rows:
        body.append([f"`{found['scene']}`" if found["scene"] != before else "", found["what"], limit_text(found), f"{found['found']:.5g}" + ("" if found["holds"] else ": does not hold")])
        before = found["scene"]
    lines = ["## Scenes", "", *evidence("scenes.stress"), "", HEAD, "",
             f"`make scenes PARTS=stress` measures {len(rows)} figures, of which {sum(found['holds'] for found in rows)} hold. `springs`, `dampers`, `told`, `drift`, `stack` and `wave` are "
             "scenes of its own (`tools/fp3scenes/stress.py`), the others those of `programs/world`.", ""]
    return {"stress.md": lines + markdown(["scene", "what", "expected", "found"], body)}
