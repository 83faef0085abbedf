"""Random scenes of objects that see each other: relations, kinds, what pairs remember, projections, events, sleep, births and ends, all at once.

    python3 tests/world/random_scenes.py build/fp3 FIRST_SEED COUNT     # a soak; prints what differs, and leaves those scenes in ./random
"""
import os
import random
import re
import subprocess
import sys
from pathlib import Path

STEP = 0.0078125
INTEGRATORS = ["euler", "semi_implicit_euler", "leapfrog", "verlet", "heun", "rk4", "ros2"]
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
PEGS = """model pegs
{kind}state x{size} = {zero}
state v{size} = {zero}
{near}step {step}
x' = v
v' = {pull}
{rest}"""


class Scene:
    """One scene, in a folder of its own."""

    def __init__(self, seed, folder):
        self.rng = random.Random(seed)
        self.folder, self.seed = folder, seed
        rng = self.rng
        self.dimensions = rng.choice([1, 2, 2, 3])
        self.relations = rng.sample(["links", "near", "all", "far"], rng.choice([1, 1, 1, 2, 2, 3]))
        self.remembers = rng.random() < 0.5
        self.kind = rng.choice([None, None, None, "still", "still", "moves"])
        self.repeats = rng.random() < 0.25
        self.rests = rng.random() < 0.35
        self.lives = rng.random() < 0.35
        self.event = rng.choice(["remove", "stop", "bounce", None, None, None])
        self.integrator = rng.choice(INTEGRATORS)
        self.is_double = self.dimensions < 3 and rng.random() < 0.2
        self.radii = rng.random() < 0.3
        self.steps = rng.choice([48, 100, 130])
        self.objects = rng.choice([7, 20, 40])
        self.has_near = bool({"near", "far"} & set(self.relations)) or self.kind is not None
        self.write()

    def vector(self, *values):
        return str(values[0]) if self.dimensions == 1 else f"({', '.join(map(str, values * self.dimensions))})"

    def columns(self, name):
        return [name] if self.dimensions == 1 else [f"{name}_{axis}" for axis in "xyz"[:self.dimensions]]

    def model(self):
        size, zero = "" if self.dimensions == 1 else f"[{self.dimensions}]", self.vector(0)
        axis = "" if self.dimensions == 1 else ".x"
        far = "abs(o.x - x)" if self.dimensions == 1 else "norm(o.x - x)"
        speed = "abs(v)" if self.dimensions == 1 else "norm(v)"
        field = f", s{size} = {zero}" if self.remembers else ""
        what = {"links": (f"links ties(k = 8{', w = 1' if self.remembers else ''})", f"sum(o in ties: o.k*{'o.w*' if self.remembers else ''}(o.x - x))",
                          f"remember o in ties: o.w = {far} < 0.6 ? o.w : 0.5*o.w"),
                "near": (f"near touch(x, {'R + o.R' if self.radii else '0.35'}{field})", f"sum(o in touch: 20*(x - o.x){' + 3*o.s' if self.remembers else ''})",
                         "remember o in touch: o.s = o.s + h*(o.v - v)"),
                "far": ("near far(x, 0.6)", "sum(o in far: (0.1 + o.m)*(o.v - v))", None),
                "all": ("all others", f"sum(o in others: 0.5*(o.x - x)/(0.1 + {far}*{far}))", None),
                "pegs": (f"near pin(x, pegs.x, 0.3{field.replace('s', 'q', 1)})", f"sum(o in pin: 15*(x - o.x){' + o.q' if self.remembers else ''})",
                         "remember o in pin: o.q = o.q + h*(o.v - v)")}
        seen = [what[name] for name in self.relations + (["pegs"] if self.kind else [])]
        lines = ["model cell", f"kind pegs(x{size}, v{size})" if self.kind else "", "param m = 1", "param R = 0.2", f"state x{size} = {zero}", f"state v{size} = {zero}",
                 *(declared for declared, _, _ in seen), f"step {STEP}", f"F = {' + '.join(pull for _, pull, _ in seen)} - {self.rng.choice([0.5, 2, 8])}*v", "x' = v", "v' = F/m"]
        own = [declared.split()[1].split("(")[0] for declared, _, _ in seen if declared[0] != "a"]
        if own and (self.repeats or self.rng.random() < 0.5):
            lines += [f"repeat {self.rng.randint(1, 4)}"] * self.repeats
            lines += [f"project x = x + 0.01*sum(o in {self.rng.choice(own)}: o.x - x)"] + ["end"] * self.repeats
        happens = {"remove": "remove", "stop": "stop", "bounce": "v = -0.5*v"}
        if self.event:
            lines.append(f"when x{axis} > 1.5{f' and v{axis} > 0' if self.event == 'bounce' else ''}: {happens[self.event]}")
        if own and self.rng.random() < 0.3:
            lines.append(f"when count(o in {self.rng.choice(own)}: o.x{axis} > x{axis}) > 2: v = 0.9*v")
        self.rest = f"rest when {speed} < {self.rng.choice([0.3, 1, 3])} for 0.0625\n" if self.rests else ""
        lines += [self.rest, *(line for _, _, line in seen if self.remembers and line)]
        pegs = PEGS.format(kind=f"kind cell(x{size})\n" * (self.kind == "moves"), near="near seen(x, cell.x, 0.3)\n" * (self.kind == "moves"), size=size, zero=zero, step=STEP,
                           pull="sum(o in seen: 4*(x - o.x)) - v" if self.kind == "moves" else "0*v", rest=self.rest * (self.rng.random() < 0.6))
        return "\n".join(line for line in lines if line) + "\n", pegs

    def write(self):
        rng, n = self.rng, self.objects
        self.folder.mkdir(parents=True, exist_ok=True)
        model, pegs = self.model()
        (self.folder / "cell.ode").write_text(model)
        (self.folder / "pegs.ode").write_text(pegs)
        side = 0.25 * max(2, round(n ** (1 / self.dimensions)))
        rows = [[rng.uniform(0.5, 2), rng.choice([0.1, 0.15, 0.2, 0.6]), *(rng.uniform(0, side) for _ in range(self.dimensions)), *(rng.choice([0, 1, 1, 8]) * rng.uniform(-2, 2) for _ in range(self.dimensions))]
                for _ in range(n)]
        (self.folder / "cells.csv").write_text("\n".join([",".join(["m", "R", *self.columns("x"), *self.columns("v")]), *(",".join(f"{one:.4f}" for one in row) for row in rows)]) + "\n")
        pairs = list({tuple(sorted(rng.sample(range(n), 2))) for _ in range(n * rng.choice([1, 2]))})
        rng.shuffle(pairs)
        (self.folder / "ties.csv").write_text("a,b\n" + "".join(f"{a},{b}\n" for a, b in pairs))
        life = f"born = [0, {rng.randint(0, 60)}]; " + f"gone = [{rng.randint(61, 100)}, {rng.randint(61, 140)}]; " * (rng.random() < 0.6) if self.lives else ""
        how = f'integrator = "{self.integrator}"; ' + "double_single = true; " * self.is_double
        self.group = (f'program = "cell.ode"; {how}points = "cells.csv"; {life}'
                      + 'links = { relation = "ties"; file = "ties.csv"; }; ' * ("links" in self.relations))
        spread = " ".join(f"{name} = [0.1, {0.9 * side:.2f}];" for name in self.columns("x"))
        self.pegs = f'program = "pegs.ode"; {how}objects = 9; spread = {{ {spread} }}; '
        self.scene()

    def scene(self, skin=None):
        """Its file, with another skin."""
        said = f"skin = {skin}; " if skin is not None and self.has_near else ""
        groups = [f"{{ {self.group}{said}}}"] + ([f"{{ {self.pegs}{said if self.kind == 'moves' else ''}}}"] if self.kind else [])
        path = self.folder / f"{'usual' if skin is None else skin}.scene"
        path.write_text(f'config = "world"; steps = {self.steps}; groups = ( {", ".join(groups)} );\n')
        return path

    def run(self, fp3, *options, skin=None, ranks=1):
        """All words in the end."""
        before = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*before, str(fp3), "run", "--scene", str(self.scene(skin)), "--all", "--allow-failures", *map(str, options)],
                              capture_output=True, text=True, env={**os.environ, **MPI}, timeout=300)
        if done.returncode == 2 and any(why in done.stderr for why in ("object registers", "apart within a step by more than the skin")):
            raise TooMuch
        if done.returncode not in (0, 3):
            raise Failed(f"seed {self.seed}, {' '.join(map(str, options))}: exit code {done.returncode}: {done.stderr.strip()[-400:]}")
        return re.findall(r"0x[0-9a-f]{8}\b", done.stdout)


class TooMuch(Exception):
    """The model does not fit the configuration, or its objects are too fast for several processes."""


class Failed(Exception):
    """A run that should have had words."""


def disagree(fp3, scene, ranks=()):
    """The runs of a scene whose words are not those of the first: other engines, threads, skins, a restart on another engine, several processes."""
    rng, checkpoint = scene.rng, scene.folder / "half.ck"
    first = scene.run(fp3, "-e", "isa")
    checkpoint.unlink(missing_ok=True)
    scene.run(fp3, "-e", "fast", "-n", rng.randint(1, scene.steps - 1), "--checkpoint", checkpoint)
    found = {"fast": scene.run(fp3, "-e", "fast", "--threads", 1), "fast, two threads, no skin": scene.run(fp3, "-e", "fast", "--threads", 2, skin=0.0),
             "isa, wide skin": scene.run(fp3, "-e", "isa", skin=2.0), "restart": scene.run(fp3, "-e", rng.choice(["isa", "fast"]), "--restart", checkpoint)}
    alone = scene.kind or scene.rests or scene.lives or scene.event == "remove" or (scene.has_near and (scene.is_double or scene.radii))
    if not alone:  # several processes refuse the others
        found |= {f"{n} ranks": scene.run(fp3, "-e", "fast", ranks=n) for n in ranks}
    return [name for name, words in found.items() if words != first]


def main(fp3, first, count):
    wrong = too_much = 0
    for seed in range(int(first), int(first) + int(count)):
        try:
            said = disagree(fp3, Scene(seed, Path("random") / str(seed)), ranks=(2, 3))
        except Failed as why:
            said = [str(why)]
        except TooMuch:
            too_much += 1
            continue
        if said:
            wrong += 1
            print(f"seed {seed}: {'; '.join(said)}", flush=True)
    print(f"{count} scenes, {wrong} that differ or fail, {too_much} too much")
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
