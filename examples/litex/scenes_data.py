"""Three scenes of objects that see each other, for scenes.c: what they begin with, and how `fp3 run` says that they end.

    scenes_data.make(fp3, folder)       programs and scenes_data.h into a folder
    scenes_data.expected(fp3, folder, NAME)   of a scene the words of all states of all objects, as the engine fast has them
"""

import csv
import math
import pathlib
import random
import re
import struct
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIG = "world"
SIDE = 10                                  # masses along a side of the cloth
REACH, SKIN = 0.1, 0.01                    # of balls, twice their radius
STATES = [f"{name}_{axis}" for name in "xv" for axis in "xyz"]


def cloth():
    """A square that hangs from two corners. Springs to the next mass along a thread, across, and to the next but one."""
    objects = [{"x_x": 0.05 * (i % SIDE), "x_y": 2, "x_z": 0.05 * (i // SIDE), "w": 0 if i in (0, SIDE - 1) else 1000} for i in range(SIDE * SIDE)]
    links = []
    for x, z, k in ((1, 0, 100), (0, 1, 100), (1, 1, 100), (-1, 1, 100), (2, 0, 10), (0, 2, 10)):
        for i in range(SIDE * SIDE):
            if 0 <= i % SIDE + x < SIDE and i // SIDE + z < SIDE:
                links.append({"a": i, "b": i + x + SIDE * z, "k": k, "rest": round(0.05 * math.hypot(x, z), 6)})
    return {"objects": objects, "links": links, "steps": 20, "shared": {}}


def stars():
    chance = random.Random(1)
    objects = [{"m": round(1 / 30, 6), **{f"x_{axis}": round(chance.uniform(-1, 1), 6) for axis in "xyz"}} for _ in range(30)]
    return {"objects": objects, "steps": 10, "shared": {"soft": 0.1}}


def balls():
    """They stand loosely in a box, and each flies another way: some touch at once, and lists are made again every few steps."""
    chance = random.Random(1)
    objects = []
    for i in range(300):
        place = {"x_x": i % 7, "x_y": i // 49, "x_z": i // 7 % 7}
        objects.append({name: round(0.1 + 0.105 * number + chance.uniform(-0.01, 0.01), 6) for name, number in place.items()}
                       | {f"v_{axis}": round(chance.uniform(-2, 2), 6) for axis in "xyz"})
    return {"objects": objects, "steps": 10, "shared": {}}


SCENES = {"cloth": (cloth, "semi_implicit_euler"), "stars": (stars, "leapfrog"), "balls": (balls, "semi_implicit_euler")}


def start(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True, **options).stdout


def bits(number):
    return struct.unpack("<I", struct.pack("<f", number))[0]


def words(numbers):
    return ", ".join(f"0x{bits(float(number)):08x}u" for number in numbers)


def value_of(values, name):
    """A value of the program, an FP32 number, or one that is computed of others."""
    value = values[name]
    if not isinstance(value, str):
        return struct.unpack("<f", struct.pack("<f", value))[0]
    formula = re.sub(r"[A-Za-z_]\w*", lambda found: f"({value_of(values, found[0])!r})", value)
    return eval(formula.replace("^", "**"), {"__builtins__": {}})  # noqa: S307 - of fp3 compile


def pack(assembly):
    """The program whose first registers are those that a record needs, as neighbours' and own phases load and store them: it then has 8 words, and `world` has room for 300 balls."""
    kept = set(re.findall(r"^    (?:ld|st) +(\w+)", assembly, re.M))
    lines = assembly.splitlines()
    at = [i for i, line in enumerate(lines) if re.match(r"\.(state|param|temp) ", line)]
    packed = sorted((lines[i] for i in at), key=lambda line: line.startswith(".temp") and line.split()[1] not in kept)
    for i, line in zip(at, packed, strict=True):
        lines[i] = line
    return "\n".join(lines) + "\n"


def image(fp3, folder, name, integrator):
    """The program, its header, and the values that it takes: numbers, and formulas of others."""
    path = folder / f"{name}.s"
    start(fp3, "compile", ROOT / f"programs/world/{name}.ode", "-i", integrator, "-c", CONFIG, "-o", path, "--params", folder / f"{name}.cfg")
    path.write_text(pack(path.read_text()))
    start(fp3, "asm", path, "-o", folder / f"{name}.fp3")
    start(fp3, "dis", folder / f"{name}.fp3", "--header", folder / f"{name}.h")
    found = re.findall(r'^(\w+) = (?:"([^"]*)"|([^";]+));', (folder / f"{name}.cfg").read_text(), re.M)
    return {key: formula if formula else float(number) for key, formula, number in found}


def header_of(name, scene, values, folder):
    """The C data of a scene."""
    text = (folder / f"{name}.h").read_text()
    registers = {kind: dict(re.findall(rf"#define {name}_{kind}_(\w+) (\d+)u", text)) for kind in ("shared", "state", "param")}
    size = 1 << int(re.search(r"\.record = (\d+)", text)[1])
    shared = [(int(index), bits(value_of(values | scene["shared"], key))) for key, index in registers["shared"].items()]
    lines = [f'#include "{name}.h"', f"#define {name.upper()}_OBJECTS {len(scene['objects'])}", f"#define {name.upper()}_STEPS {scene['steps']}",
             f"static const fp3_bare_constant {name}_shared[] = {{", *(f"    {{{index}, 0x{word:08x}u}}," for index, word in shared), "};",
             f"static const uint32_t {name}_states[] = {{" + ", ".join(f"{name}_state_{state}" for state in STATES) + "};",
             f"static const uint32_t {name}_start[] = {{"]
    for own in scene["objects"]:
        record = [0] * size
        for key, index in {**registers["state"], **registers["param"]}.items():
            record[int(index)] = value_of(values | scene["shared"] | own, key)
        lines.append(f"    {words(record)},")
    lines.append("};")
    if "links" in scene:
        lines += [f"static const fp3_bare_link {name}_links[] = {{", *(f"    {{{link['a']}, {link['b']}}}," for link in scene["links"]), "};",
                  f"static const uint32_t {name}_fields[] = {{", *(f"    {words((link['k'], link['rest']))}," for link in scene["links"]), "};"]
    return "\n".join(lines)


def write_scene(name, scene, integrator, folder):
    """The same as a file for `fp3 run`."""
    def write(file, rows):
        with (folder / file).open("w", newline="") as out:
            table = csv.DictWriter(out, rows[0])
            table.writeheader()
            table.writerows(rows)

    write(f"{name}_points.csv", scene["objects"])
    links = ""
    if "links" in scene:
        write(f"{name}_links.csv", scene["links"])
        links = f'links = {{ relation = "springs"; file = "{name}_links.csv"; }};'
    values = " ".join(f"{key} = {value!r};" for key, value in scene["shared"].items())
    (folder / f"{name}.scene").write_text(f"""steps = {scene["steps"]};
groups = ( {{ program = "{ROOT}/programs/world/{name}.ode"; integrator = "{integrator}"; points = "{name}_points.csv";
    set = {{ {values} }}; {links} }} );
""")


def make(fp3, folder, integrators=None):
    """integrators: of a scene another one than it has."""
    lines = ["/* What the scenes of scenes.c begin with; written by scenes.py. */", f"#define BALLS_REACH 0x{bits(REACH):08x}u", f"#define BALLS_SKIN 0x{bits(SKIN):08x}u"]
    for name, (of, integrator) in SCENES.items():
        integrator = (integrators or {}).get(name, integrator)
        scene = of()
        lines.append(header_of(name, scene, image(fp3, folder, name, integrator), folder))
        write_scene(name, scene, integrator, folder)
    (folder / "scenes_data.h").write_text("\n".join(lines) + "\n")


def expected(fp3, folder, name, *options):
    """The words of all states, object by object."""
    start(fp3, "run", "--scene", folder / f"{name}.scene", "-e", "fast", "-c", CONFIG, "--output", folder / f"{name}.csv", *options)
    with (folder / f"{name}.csv").open() as text:
        rows = [{key.split(" ")[0]: cell for key, cell in row.items()} for row in csv.DictReader(text)]
    last = [row for row in rows if row["step"] == rows[-1]["step"]]
    return [bits(float(row[state])) for row in last for state in STATES]


def hash_of(states):
    """As scenes.c prints it."""
    value = 2166136261
    for word in states:
        value = (value ^ word) * 16777619 & 0xffffffff
    return f"{value:08x}"
