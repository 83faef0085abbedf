"""Pictures from the chip (rtl/video): frames are those that picture.py computes from the words of the engine fast, pixel by pixel; syncs, edges, counts, and
what happens when there is too much to draw; seeded bugs. The host, the processor and its bus are real: pictures.c."""

import pathlib
import random
import re
import struct
import subprocess
import sys

import pytest

import picture
import pictures
from bugs import Bug, few, tree
from picture import Frame, View, disc

pytestmark = pytest.mark.xdist_group("pictures")       # built once

FULL = Frame()
SMALL = Frame(across=(64, 4, 8, 4), down=(48, 2, 2, 20), objects_w=6, spare=6)
WINDOW = 1 << 18                                       # of the registers: behind the processor's addresses
OBJECTS, STATUS, HALF = 0x20000, 0x14, 0x54            # docs/registers.md
WARN = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


def succeeds(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def bits(number):
    return struct.unpack("<I", struct.pack("<f", number))[0]


# ---- what is built ----

@pytest.fixture(scope="module")
def scenes(root, fp3, tmp_path_factory):
    """scenes_data.py, and a folder with what it makes."""
    sys.path.insert(0, str(root / "examples/litex"))
    import scenes_data
    folder = tmp_path_factory.mktemp("scenes")
    scenes_data.make(fp3, folder)
    return scenes_data, folder


@pytest.fixture(scope="module")
def host(root, scenes):
    """The objects of the host: all but the chip."""
    folder = scenes[1]
    options = [f"-I{root / name}" for name in ("sw", "sw/bare", "sw/include", "sim", "tests/video", "examples/litex")]
    succeeds("gcc", "-std=c11", "-D_GNU_SOURCE", "-g", *WARN, "-ffp-contract=off", *options, f"-I{folder}", "-c", root / "tests/video/pictures.c",
             *sorted((root / "sw/bare").glob("*.c")), cwd=folder)
    return sorted(folder.glob("*.o"))


def chip(root, build, host, folder, frame, optimise="-O1"):
    """The command, of the RTL in `root` or in a broken copy of it; memories begin as noise."""
    made = folder / "made"
    succeeds("verilator", "--cc", "-Wno-fatal", "-O3", "--x-assign", "fast", "--x-initial", "unique", "--prefix", "Vfp3_pictures", "--Mdir", made,
             "+incdir+rtl", *(word for name in ("bus", "lib", "video") for word in ("-y", f"rtl/{name}")), "+libext+.v",
             *(f"-G{key}={value}" for key, value in frame.parameters().items()), "--top-module", "fp3_pictures", "rtl/video/fp3_pictures.v", cwd=root)
    include = succeeds("verilator", "--getenv", "VERILATOR_ROOT").strip() + "/include"
    tests = pathlib.Path(__file__).parent
    (made / "all.cpp").write_text("".join(f'#include "{path}"\n' for path in [*sorted(made.glob("V*.cpp")), tests / "pictures_shim.cpp"]))
    runtime = [build / f"obj/verilator/{name}.o" for name in ("verilated", "verilated_threads")]
    succeeds("g++", "-std=c++17", optimise, "-isystem", made, "-isystem", include, "-isystem", f"{include}/vltstd", "-I", tests, made / "all.cpp", *host,
             *runtime, "-ldl", "-pthread", "-o", folder / "pictures")
    return folder / "pictures"


@pytest.fixture(scope="module")
def full(root, build, host, tmp_path_factory):
    return chip(root, build, host, tmp_path_factory.mktemp("full"), FULL)


@pytest.fixture(scope="module")
def small(root, build, host, tmp_path_factory):
    return chip(root, build, host, tmp_path_factory.mktemp("small"), SMALL)


# ---- a session ----

class Session:
    """Lines for the command, and what it is to say to each."""

    def __init__(self, frame):
        self.frame, self.lines, self.looks = frame, [], []

    def do(self, line, look=None):
        self.lines.append(line)
        if line.split()[0] in ("w", "r", "frame"):
            self.looks.append((line, look))

    def write(self, name, value, said="ok"):
        at = WINDOW + picture.REGISTERS[name] if isinstance(name, str) else name
        self.do(f"w {at:x} {value:x}", said)

    def read(self, name, value):
        self.do(f"r {WINDOW + picture.REGISTERS[name]:x}", value if value is None or isinstance(value, str) else f"{value:08x}")

    def show(self, view):
        self.write("control", 0)
        self.do("go 20000")                            # what is being read comes to its end
        for name, value in view.words().items():
            self.write(name, value)
        for i, colour in enumerate(view.palette):
            self.write(WINDOW + picture.COLOURS + 4 * i, colour)
        self.write("control", 1)

    def frames(self, count=1):
        """Frames of which the last one counts; the first after a change may be of before and after."""
        self.do(f"go {(count - 1) * self.frame.pixels() * self.frame.ticks}")
        self.do(f"frame @{len(self.looks)} {self.frame.pixels()}", str(self.frame.ticks))
        return len(self.looks) - 1

    def play(self, command, processor, folder, seed=0):
        """The pictures by the number of their look: the rows of each."""
        lines = [line.replace("@", f"{folder}/frame") for line in self.lines]
        said = succeeds(command, processor, seed, input="\n".join(lines) + "\n").split("\n")[:-1]
        assert len(said) == len(self.looks)
        for got, (line, wanted) in zip(said, self.looks):
            assert wanted is None or got == wanted, f"{line}: {got}, expected {wanted}"
        self.said, found, flags = said, {}, self.frame.flags()
        for i, (line, _) in enumerate(self.looks):
            if line.startswith("frame"):
                data = (folder / f"frame{i}").read_bytes()
                assert data[3::4] == flags, "visible or a sync is not where it is to be"
                colours = b"".join(data[at:at + 3] for at in range(0, len(data), 4))
                columns, width = 3 * sum(self.frame.across), 3 * self.frame.across[0]
                rows = [colours[at:at + columns] for at in range(0, len(colours), columns)]
                assert not any(row[width:].strip(b"\0") for row in rows) and not any(row.strip(b"\0") for row in rows[self.frame.down[0]:])
                found[i] = [row[:width] for row in rows[:self.frame.down[0]]]
        return found

    def number(self, look):
        return int(self.said[look], 16)


def expected(view, frame, words):
    return picture.draw(view, frame, list(picture.places(view, words)), view.background)


# ---- scenes on the processor ----

# Steps of the page's picture, and of the short test; columns, rows, shape and view.
LOOKS = {"balls": (60, 6, "x_x", "x_y", disc(7), {"x_scale": 9, "x_origin": 140, "y_scale": 9, "y_origin": 440}),
         "cloth": (241, 7, "x_x", "x_y", disc(4), {"x_scale": 9, "x_origin": 205, "y_scale": 9, "y_origin": 1200})}


@pytest.fixture(scope="module")
def looked(build, fp3, scenes):
    """Of a scene after some steps the view, and words of the engine `fast`."""
    data, folder = scenes

    def look(name, steps):
        _, _, across, down, shape, view = LOOKS[name]
        header = (folder / f"{name}.h").read_text()
        at = {axis: int(re.search(rf"#define {name}_state_{axis} (\d+)u", header)[1]) for axis in (across, down)}
        record, count = int(re.search(r"\.record = (\d+)", header)[1]), len(data.SCENES[name][0]()["objects"])
        store = int(re.search(r"\.STORE_WORDS +\((\d+)\)", (build / "rtl/fp3_world.v").read_text())[1])
        words = data.expected(fp3, folder, name, "--steps", steps)
        states = [dict(zip(data.STATES, words[i:])) for i in range(0, len(words), len(data.STATES))]
        return (View(OBJECTS + 4 * at[across], OBJECTS + 4 * at[down], 4 << record, count, upper=2 * store, shape=shape, **view),
                [(state[across], state[down]) for state in states])
    return look


@pytest.mark.parametrize("name", LOOKS)
def test_a_frame_shows_what_the_engine_fast_has(build, full, looked, tmp_path, long, name):
    """`world` is the processor; words are in either half of its store, as the cloth makes an odd number of phases."""
    steps = LOOKS[name][0 if long else 1]
    view, words = looked(name, steps)
    session = Session(FULL)
    session.do(f"set {name}")
    session.do(f"run {steps}")
    session.show(view)
    last = session.frames(2)
    outside, numberless = picture.counts(view, FULL, list(picture.places(view, words)))
    for register, value in (("outside", outside), ("numberless", numberless), ("unfinished", 0), ("status", 1)):
        session.read(register, value)
    got = session.play(full, build / "lib/fp3/fp3_world.so", tmp_path, seed=3)[last]
    assert got == expected(view, FULL, words) and len(set(got)) > 5 and numberless == outside == 0


@pytest.mark.parametrize("name", LOOKS)
def test_the_page_shows_the_same(root, build, looked, name):
    """What the test before compares frames with, after more steps; with --long it does so, too."""
    view, words = looked(name, LOOKS[name][0])
    made, file = picture.png(expected(view, FULL, words)), f"pictures_{name}.png"
    (build / "tests" / file).write_bytes(made)
    assert (root / "docs" / file).read_bytes() == made, f"docs/{file} is another picture: see build/tests/{file}"
    page = (root / "docs/pictures.md").read_text()
    assert f"after {LOOKS[name][0]} steps" in page and f"| {LOOKS[name][4]:#010x} |" in page


def test_the_command_of_the_page_is_of_its_picture(root, looked):
    """The upper half, too, where words are only after an odd number of phases."""
    said = re.search(r"pictures\.py /dev/\S+ (.+)", (root / "docs/pictures.md").read_text())[1].split()
    words = dict(pictures.word(text) for text in said)
    wanted = looked("balls", 6)[0].words() | {"control": 1}
    assert len(words) == 9 and words == {name: wanted[name] for name in words}


# ---- small pictures, of words in a memory ----

STEP = 16


def put(session, words, upper=0):
    for i, (x, y) in enumerate(words):
        session.do(f"m {OBJECTS + upper + STEP * i:x} {x:x}")
        session.do(f"m {OBJECTS + upper + STEP * i + 4:x} {y:x}")


def view_of(words, **more):
    return View(OBJECTS, OBJECTS + 4, STEP, len(words), **more)


def plays(command, folder, session, seed=0):
    return session.play(command, "memory", folder, seed)


EDGES = [bits(number) for number in (
    0.0, -0.0, 1e-45, -1e-45, 0.5, -0.5, 1.0, -1.0, 0.99999994, -1.0000001, 63.99999, 64.0, 47.99999, 48.0, -13.0, -13.5, -14.0, 77.0, 78.0, -7.0, -7.5, 55.0,
    4095.5, 4096.0, -4095.5, -4096.0, 1e10, -1e10, 3e38)] + [0x7f800000, 0xff800000, 0x7fc00000, 0xffc00001]


def random_views(chance):
    """Positions at all edges, beside any, in views of all signs and scales."""
    for shape in (1, 0xffffffff, disc(7), 0x203, disc(2)) * 3:
        words = [(chance.choice(EDGES), bits(chance.uniform(0, 48))) if chance.random() < 0.4 else (bits(chance.uniform(0, 64)), chance.choice(EDGES))
                 for _ in range(chance.choice((0, 1, 8, 11) if shape != 0xffffffff else (3, 5)))]
        yield words, {"shape": shape, "shift": chance.randrange(4), "y_origin": chance.choice((0, 47, 48))}
    for scale in (-128, -20, -3, 5, 127):
        words = [(chance.getrandbits(23) | (127 - scale + chance.randrange(-3, 7) & 255) << 23 | chance.getrandbits(1) << 31,
                  bits(chance.uniform(-24, 24))) for _ in range(12)]
        yield words, {"x_scale": scale, "x_origin": chance.choice((-2048, 2047, 20, 31)), "y_origin": 24}


def check_positions(command, folder, seed=0):
    """Each view for a frame, and its counts; every second one from the upper half."""
    session, wanted = Session(SMALL), {}
    for i, (words, more) in enumerate(random_views(random.Random(seed + 1))):
        view = view_of(words, upper=0x8000 * (i % 2), **more)
        session.do(f"m {HALF:x} {i // 2 % 2:x}")
        put(session, words, view.upper if i // 2 % 2 else 0)
        session.show(view)
        look = session.frames(2)
        wanted[look] = expected(view, SMALL, words)
        outside, numberless = picture.counts(view, SMALL, list(picture.places(view, words)))
        for register, value in (("outside", outside), ("numberless", numberless), ("unfinished", 0), ("status", 1)):
            session.read(register, value)
    got = plays(command, folder, session, seed)
    for look, rows in wanted.items():
        assert got[look] == rows, f"frame {look}"


@pytest.mark.parametrize("seed", [0, 7])
def test_positions_become_pixels(small, tmp_path, seed):
    """The edges of the picture, of shapes and of floats. A seed: the processor's bus lets everything wait."""
    check_positions(small, tmp_path, seed)


def check_too_much(command, folder):
    """A row has 160 cycles here: 64 objects and five pixels of each are too much where all are in it."""
    words = [(bits(i % 60), bits(20 if i % 3 else i % 40)) for i in range(64)]
    view, session = view_of(words, y_origin=40, shape=0x33), Session(SMALL)
    put(session, words)
    session.show(view)
    look = session.frames(3)
    session.read("unfinished", None)
    got = plays(command, folder, session)[look]
    whole = expected(view, SMALL, words)
    found = list(picture.places(view, words))
    parts = [picture.draw(view, SMALL, found[:k], view.warning) for k in range(65)]
    cut = [y for y in range(SMALL.down[0]) if got[y] != whole[y]]
    assert cut == [19, 20, 21] and session.number(-1) == len(cut)
    for y in cut:
        assert any(got[y] in mixed(parts[k][y], parts[k + 1][y]) for k in range(12, 63)), f"row {y} is not that of the first objects"


def mixed(before, after):
    """Rows in which an object is drawn in part, from its left."""
    return [after[:at] + before[at:] for at in range(0, len(after) + 1, 3)]


def test_a_row_with_too_much_in_it_is_told(small, tmp_path):
    check_too_much(small, tmp_path)


def check_runs(command, folder):
    """While a run is under way the picture stays; what cannot be read has no picture; nothing moves while positions are read."""
    before, after = [[(bits(x + i % 8), bits(10 + i)) for i in range(30)] for x in (10, 40)]
    view = view_of(before, y_origin=45, shape=0x12)
    session, wanted = Session(SMALL), {}
    blind = [view.warning.to_bytes(3, "big") * SMALL.across[0]] * SMALL.down[0]
    session.do(f"m {STATUS:x} 1")
    put(session, before)
    session.show(view)
    wanted[session.frames(2)] = blind                  # a run is under way from the beginning
    session.read("status", 0)
    session.read("taken", 0)
    session.read("unfinished", SMALL.down[0])
    session.do(f"m {STATUS:x} 2")
    wanted[session.frames(2)] = expected(view, SMALL, before)
    session.do(f"m {STATUS:x} 1")
    put(session, after)
    wanted[session.frames(2)] = expected(view, SMALL, before)
    # The run ends. In the next blanking the host writes while positions are read: its word comes behind.
    session.do(f"m {STATUS:x} 2")
    session.do(f"go {SMALL.ticks * sum(SMALL.across) * SMALL.down[0] + 100}")
    session.do(f"w {OBJECTS + STEP * 29:x} {bits(3.0):x}", "ok")
    session.do(f"m {STATUS:x} 1")
    wanted[session.frames(1)] = expected(view, SMALL, after)
    session.do(f"m {STATUS:x} 2")
    wanted[session.frames(2)] = expected(view, SMALL, [*after[:29], (bits(3.0), after[29][1])])
    session.write("control", 3)                        # the picture is held
    put(session, before)
    wanted[session.frames(2)] = expected(view, SMALL, [*after[:29], (bits(3.0), after[29][1])])
    session.write("control", 1)
    wanted[session.frames(2)] = expected(view, SMALL, before)
    session.do(f"x {OBJECTS + STEP * 7:x}")            # refused
    wanted[session.frames(2)] = blind
    session.read("status", 0)
    session.write("control", 0)
    wanted[session.frames(2)] = expected(view, SMALL, [])
    session.read("unfinished", 0)
    got = plays(command, folder, session)
    for look, rows in wanted.items():
        assert got[look] == rows, f"frame {look}"


def test_a_run_is_not_disturbed(small, tmp_path):
    check_runs(small, tmp_path)


LINE = SMALL.ticks * sum(SMALL.across)


def check_told(command, folder):
    """When positions are read, and what registers say of it: once in a frame; a line after a run has ended, but not in the last lines of the blanking;
    not at all if the processor refuses. `off` takes settings when reading is over, and forgets what was read."""
    inside, outside = [[(bits(x + i % 8), bits(10 + i)) for i in range(30)] for x in (10, 1000)]
    view, session, last = view_of(inside, y_origin=45), Session(SMALL), SMALL.down[0] + SMALL.down[1] + SMALL.down[2] + SMALL.down[3] - SMALL.spare

    def taken():
        session.read("taken", None)
        return len(session.looks) - 1
    put(session, inside)
    session.show(view)
    session.frames(2)
    session.read("frames", None)
    begin = [len(session.looks) - 1, taken()]
    session.frames(4)
    session.read("frames", None)
    end = [len(session.looks) - 1, taken()]
    late = []
    for line in (last - 3, last + 2):                  # a run ends there
        session.do(f"m {STATUS:x} 1")
        session.do(f"go {LINE * line}")
        session.do(f"m {STATUS:x} 2")
        before = taken()
        session.do(f"go {LINE * SMALL.spare}")
        late.append((before, taken()))
        session.frames(1)
    session.do(f"go {LINE * SMALL.down[0] + 60}")      # positions are being read
    session.write("control", 0)
    session.write("x", view.x, "refused")
    session.read("status", 2)
    session.do("go 800")
    session.write("x", view.x)
    session.do(f"m {STATUS:x} 1")
    session.write("control", 1)
    session.read("status", 0)
    session.do(f"m {STATUS:x} 2")
    session.frames(2)
    session.read("outside", 0)
    put(session, outside)
    session.do(f"x {OBJECTS + STEP * 7:x}")
    refused = [taken()]
    session.frames(2)
    session.read("outside", 0)
    refused.append(taken())
    session.play(command, "memory", folder)
    number = session.number
    assert [number(b) - number(a) for a, b in zip(begin, end)] == [5, 5]
    assert [number(b) - number(a) for a, b in late] == [1, 0]
    assert number(refused[0]) == number(refused[1])


def check_status_that_is_refused(command, folder):
    """Nobody knows whether a run is under way, so nothing is read."""
    view, session = view_of([(0, 0)] * 3), Session(SMALL)
    session.do(f"x {STATUS:x}")
    session.show(view)
    session.frames(2)
    session.read("taken", 0)
    session.read("status", 0)
    session.play(command, "memory", folder)


def test_registers_tell_what_was_read(small, tmp_path):
    check_told(small, tmp_path)
    check_status_that_is_refused(small, tmp_path)


def test_taken_tells_of_what_a_run_left(small, tmp_path):
    """A host starts a run, reads `taken`, and waits for another value, as the page says: until the run has ended there is none, also where positions
    were being read when the host came; a value from before the start would change for these."""
    words, stale = [[(bits(x + i % 8), bits(10 + i)) for i in range(30)] for x in (10, 40)], 0
    for late in range(0, 240, 12):
        view, session = view_of(words[0], y_origin=45), Session(SMALL)
        put(session, words[0])
        session.show(view)
        session.frames(2)
        session.do(f"go {SMALL.ticks * sum(SMALL.across) * SMALL.down[0] + late}")
        session.read("taken", None)
        session.do(f"w {STATUS:x} 1", "ok")
        session.read("taken", None)
        put(session, words[1])
        session.do("go 300")
        session.read("taken", None)
        session.do(f"w {STATUS:x} 2", "ok")
        last = session.frames(2)
        session.read("taken", None)
        got = plays(small, tmp_path, session)[last]
        before, started, ended, after = (session.number(look) for look in (-7, -5, -4, -1))
        stale += before != started
        assert started == ended < after and got == expected(view, SMALL, words[1]), f"{late} cycles late"
    assert stale


def test_registers_take_what_is_possible(small, tmp_path):
    session = Session(SMALL)
    session.read("id", 0x46505630)
    ends = {"x": ((0, 0x3fffc), (2, 0x40000, 0xfffffffc)), "y": ((0x3fffc,), (1, 0x40000)), "upper": ((0x3fffc,), (0x40000,)),
            "step": ((0, 0xfffc), (3, 0x10000)), "objects": ((0, 64, 0xf0040), (65, 0x8000, 0x100000)),
            "across": ((0xff07ff, 0x80f800), (0x800, 0xf7ff, 0x1000000)), "down": ((0x7f07ff,), (0x7f0800,)), "shape": ((0xffffffff,), ()),
            "background": ((0xffffff,), (0x1000000,)), "warning": ((0,), (0xff000000,)), "control": ((3, 0), (4,))}
    for name, (takes, refuses) in ends.items():
        for value in takes:
            session.write(name, value)
            session.read(name, value)
        for value in refuses:
            session.write(name, value, "refused")
        session.read(name, takes[-1])
    for name in ("id", "status", "frames", "taken", "outside", "numberless", "unfinished"):
        session.write(name, 0, "refused")
    for at in (0x48, 0x7c, 0xc0, 0x100, 0x3fffc):
        session.do(f"r {WINDOW + at:x}", "refused")
        session.do(f"w {WINDOW + at:x} 0", "refused")
    session.do(f"r {WINDOW + 0x80:x}", "refused")      # colours are only written
    session.write(WINDOW + 0x80, 0x1000000, "refused")
    session.do("m 123c 5a5a5a5a")
    session.do("r 123c", "5a5a5a5a")                   # and all else is the processor's
    session.do("x 1240")
    session.do("r 1240", "refused")
    session.do("w 1240 0", "refused")
    # A place beyond the processor's addresses is nowhere: no wrong words, no picture.
    view = view_of([(0, 0)] * 4)
    session.show(dataclass_with(view, x=0x3fff8, step=16))
    for name in ("x", "y", "upper", "step", "objects", "across", "down"):
        session.write(name, 0, "refused")              # while it is on
    session.write("shape", 3)
    look = session.frames(2)
    session.read("status", 0)
    rows = plays(small, tmp_path, session)[look]
    assert rows == [view.warning.to_bytes(3, "big") * SMALL.across[0]] * SMALL.down[0]


def dataclass_with(view, **more):
    return View(**{**vars(view), **more})


# ---- bugs ----

BUGS = [
    Bug("negative positions are cut, not rounded down", "fp3_video_pixel.v", "{12'd0, negative_q && lost}", "13'd0"),
    Bug("far away is near", "fp3_video_pixel.v", "by_q < 10'sd0 || away[12]", "1'b0"),
    Bug("infinite is a place", "fp3_video_pixel.v", "exponent != 8'd255", "1'b1"),
    Bug("the lower half always", "fp3_video_reader.v", "upper_q <= answer_rdata_i[HALF_UPPER_LO]", "upper_q <= 1'b0"),
    Bug("positions are read in a run", "fp3_video_reader.v", "answer_rdata_i[STATUS_RUNNING_LO]", "1'b0"),
    Bug("a picture is not held", "fp3_pictures.v", "blank && !hold &&", "blank &&"),
    Bug("a refused position is one", "fp3_video_reader.v", "failed_q <= 1'b1", "failed_q <= 1'b0"),
    Bug("who stands beside the picture is not in it", "fp3_video_reader.v", "column_q >= -14'sd14 &&", "column_q >= 14'sd0 &&"),
    Bug("the host comes in between", "fp3_pictures.v", "&& !(moves && move_valid)", ""),
    Bug("rows of the frame before stay", "fp3_video_lines.v", "shown ? clear_q : draw_i", "!shown && draw_i"),
    Bug("an unfinished row is not told", "fp3_video_rows.v", "draws_q && (blind_q || !over)", "draws_q && blind_q"),
    Bug("the last object is not drawn", "fp3_video_rows.v", "next_q != objects_i", "next_q + 1'b1 != objects_i"),
    Bug("a shape is as wide to its right as it is high", "fp3_video_rows.v", "{half_q, 1'b0} - 5'd1", "{half_q, 1'b0} - 5'd2"),
    Bug("the vertical sync is a line late", "fp3_video_timing.v", "DOWN = HEIGHT + V_FRONT - 1", "DOWN = HEIGHT + V_FRONT"),
    Bug("a line has a pixel more", "fp3_video_timing.v", "WIDTH + H_FRONT + H_SYNC + H_BACK, LINES", "WIDTH + H_FRONT + H_SYNC + H_BACK + 1, LINES"),
    Bug("red and blue", "fp3_pictures.v", "there ? painted", "there ? {painted[7:0], painted[15:8], painted[23:16]}"),
    Bug("positions are read again in each line", "fp3_pictures.v", "(old_q || next == HEIGHT[9:0])", "1'b1"),
    Bug("who misses the first line waits for a frame", "fp3_pictures.v", "(old_q || next == HEIGHT[9:0])", "next == HEIGHT[9:0]"),
    Bug("reading begins too late", "fp3_pictures.v", "LATEST = LINES - SPARE", "LATEST = LINES"),
    Bug("settings move while positions are read", "fp3_video_registers.v", "(on_q || busy_i)", "on_q"),
    Bug("a refused status is no run", "fp3_video_reader.v", "(answer_error_i || answer_rdata_i", "(answer_rdata_i"),
    Bug("what was read outlives off", "fp3_video_reader.v", "if (rst_i || !on_i) shows_q", "if (rst_i) shows_q"),
    Bug("refused positions count", "fp3_video_reader.v", "taken_q <= drained && !failed_q", "taken_q <= drained"),
    Bug("refused positions are outside", "fp3_video_reader.v", "else if (drained && !failed_q) {outside", "else if (drained) {outside"),
    Bug("three bytes are written", "fp3_video_port.v", "{6'd0, 4'b1111}", "{6'd0, 4'b0111}"),
]


@pytest.mark.parametrize("bug", few((bug.name, bug) for bug in BUGS))
def test_a_bug_is_seen(root, build, host, tmp_path, bug):
    command = chip(tree(root, tmp_path, bug), build, host, tmp_path, SMALL, "-O0")
    with pytest.raises(AssertionError):
        for check in (check_positions, check_too_much, check_runs, check_told, check_status_that_is_refused, test_registers_take_what_is_possible):
            check(command, tmp_path)


# ---- formats ----

@pytest.mark.parametrize("given, said", [
    ({}, None), ({"WIDTH": 978, "H_SYNC": 10, "H_BACK": 19}, None), ({"HEIGHT": 495}, None), ({"SPARE": 44}, None),
    ({"WIDTH": 979, "H_SYNC": 10, "H_BACK": 10}, "WIDTH_is_978"), ({"HEIGHT": 496}, "WIDTH_is_978"), ({"H_BACK": 272}, "WIDTH_is_978"),
    ({"V_BACK": 532}, "WIDTH_is_978"), ({"SPARE": 45}, "SPARE_leaves"), ({"SPARE": -1}, "SPARE_leaves")])
def test_a_format_that_has_no_room_ends_elaboration(root, given, said):
    done = subprocess.run(["verilator", "--lint-only", "-Wno-lint", "-Wno-style", "+incdir+rtl", "+libext+.v",
                           *(word for name in ("bus", "lib", "video") for word in ("-y", f"rtl/{name}")),
                           *(f"-G{key}={value}" for key, value in given.items()), "--top-module", "fp3_pictures", "rtl/video/fp3_pictures.v"],
                          cwd=root, capture_output=True, text=True)
    assert (done.returncode == 0) == (said is None) and (said or "") in done.stderr, done.stderr


# ---- the channels of DVI ----

CONTROLS = {0b1101010100: 0, 0b0010101011: 1, 0b0101010100: 2, 0b1010101011: 3}


def decoded(word):
    """As DVI 1.0 (3.3) says: a word of ten bits to a value of eight."""
    low, by_xor = ~word if word >> 9 & 1 else word, word >> 8 & 1
    bit = lambda i: low >> i & 1
    return bit(0) | sum((bit(i) ^ bit(i - 1) ^ (not by_xor)) << i for i in range(1, 8))


@pytest.mark.parametrize("late", [0, 1, 3, 5, 7])
def test_the_bits_of_dvi_are_the_pixels(root, tmp_path, late):
    """Through the encoders and the shift registers, whose clock is early by `late` ns of 8: each word once, when it has stood for one to two of its
    cycles, and about as many ones as zeros on each line."""
    bench = tmp_path / "dvi.vvp"
    said = subprocess.run(["iverilog", "-g2012", "-Wall", "-Wno-timescale", f"-Pdvi_bench.LATE={late}", "-s", "dvi_bench", "-o", bench, "-y", "rtl/video",
                           "rtl/fpga/ecp5/fp3_pictures_serial.v", "tests/video/dvi_bench.v"], cwd=root, capture_output=True, text=True)
    assert said.returncode == 0 and not said.stderr, said.stderr
    out = succeeds("vvp", "-n", bench).splitlines()
    pixels = [tuple(int(word, 16) for word in line.split()[1:]) for line in out if line.startswith("p ")]
    lines = [line.split()[1] for line in out if line.startswith("b ")]
    ages = {int(line.split()[1]) for line in out if line.startswith("a ")}
    assert ages and 8 <= min(ages) and max(ages) <= 16
    at = next(i for i in range(len(lines)) if [line[0] for line in lines[i:i + 10]] == list("1111100000"))
    words = [[sum(int(lines[k + i][3 - c]) << i for i in range(10)) for c in range(4)] for k in range(at, len(lines) - 9, 10)]
    assert len(pixels) > 2000 and all(word[3] == 0b0000011111 for word in words)
    got = []
    for word in words:
        controls = [CONTROLS.get(word[c]) for c in range(3)]
        visible = controls == [None] * 3
        got.append((1, 0, sum(decoded(word[c]) << 8 * c for c in range(3))) if visible else (0, controls[0], 0))
    first = next(i for i in range(len(pixels)) if pixels[i:i + 50] == got[5:55])
    assert got[5:2000] == pixels[first:first + 1995]
    for c in range(3):
        balance, worst = 0, 0
        for word in words:
            balance = balance + 2 * bin(word[c]).count("1") - 10 if CONTROLS.get(word[c]) is None else 0
            worst = max(worst, abs(balance))
        assert worst <= 10
