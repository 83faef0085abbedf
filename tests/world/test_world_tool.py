"""make world in its quick form: every part has its rows, and whatever differs ends it with exit code 1."""

import collections
import importlib
import itertools
import json
import subprocess
import sys

import numpy
import pytest

pytestmark = pytest.mark.xdist_group("world_tool")  # measured once


@pytest.fixture(scope="module")
def world(root, build, tmp_path_factory):
    def world(*options, fp3=build / "fp3"):
        path = tmp_path_factory.mktemp("tool") / "world.json"
        done = subprocess.run([sys.executable, root / "tools/world.py", "--quick", "--fp3", fp3, "--bench", build / "bench/world", "--output", path, *map(str, options)],
                              capture_output=True, text=True, timeout=300)
        return done, json.loads(path.read_text()) if path.exists() else None
    return world


@pytest.fixture(scope="module")
def measured(world):
    done, found = world()
    assert done.returncode == 0, done.stderr
    return found


def test_each_scene_has_one_hash(measured):
    rows = measured["hashes"]
    assert {"balls, 60", "balls, 2000", "chain", "chain, 2000", "cloth 8 x 8", "cloth 50 x 50", "planets", "train"} == {row["scene"] for row in rows}
    for scene, steps in {(row["scene"], row["steps"]) for row in rows}:
        same = [row for row in rows if (row["scene"], row["steps"]) == (scene, steps)]
        assert len(same) > 1 and len({row["hash"] for row in same}) == 1 and not any(row["words_differing"] for row in same)
    assert {"isa", "fast", "rtl"} == {row["engine"] for row in rows}
    assert {"skin 0, 2 threads", "objects in another order", "native x86-64, 1 thread", "interpreter, 2 threads", "world"} <= {row["variant"] for row in rows}
    assert measured["refused"] == measured["refused_on_chip"] == []


def test_what_goes_with_what(measured, long, root, build, tmp_path, monkeypatch):
    """The page has each cell that this finds, of each feature two of five (with --long all, and nothing else); an engine with other words is told."""
    monkeypatch.syspath_prepend(root / "tools")
    combinations = importlib.import_module("fp3world.combinations")
    page = (root / "docs/relations.md").read_text()
    if combinations.NO_MPI not in {row["state"] for row in measured["combinations"]}:  # else the machine that made the page had more than this one
        assert not combinations.differing(page, measured["combinations"]), "make world PARTS=combinations"
        if long:
            assert combinations.page(page, combinations.measure(build / "fp3", tmp_path, lambda said: None)) == page, "make world PARTS=combinations"
    assert {(row["relation"], row["engine"]) for row in measured["combinations"] if row["state"] == "works"} == set(itertools.product(combinations.RELATIONS, combinations.ENGINES))
    assert collections.Counter(row["feature"] for row in measured["combinations"]) == {feature.name: 2 * len(feature.engines) for feature in combinations.FEATURES}
    cell = measured["combinations"][0]
    assert len(combinations.differing(page, [cell | {"state": "no"}, cell | {"feature": "another"}, cell])) == 2
    longer = combinations.Feature("longer", trial=lambda cell: cell.words("--steps", 8 + (cell.engine == "fast")), engines=("isa", "fast"))
    beside = combinations.Feature("beside", trial=lambda cell: cell.words("--steps", 9), engines=("fast",), is_beside=True)
    rows = combinations.measure(build / "fp3", tmp_path, lambda said: None, [beside])
    assert len(rows) == 5 == len(combinations.wrong(rows))
    rows = combinations.measure(build / "fp3", tmp_path, lambda said: None, [longer])
    assert [(row["relation"], row["engine"]) for row in combinations.wrong(rows)] == [(relation, "fast") for relation in ("links", "near", "all", "several", "kinds")]


def test_the_chip_has_cycles(measured):
    assert {row["scene"] for row in measured["chip"]} == {"balls, 60", "chain", "cloth 8 x 8", "planets", "stars, 60"}
    for row in measured["chip"]:
        assert row["lanes"] >= 1 and 10 < row["cycles_per_object_step"] < 10000 and 0 <= row["exchange_share"] < 1
        assert (row["lanes"] > 1) == (row["exchange_share"] > 0)


def test_loops_by_hand_have_the_same_words(measured):
    rows = [row for row in measured["speed"] if row["engine"] in ("hand", "fast")]  # not those that are measured where they are installed
    assert {(row["scene"], row["engine"], row["threads"]) for row in rows} == {
        (scene, engine, n) for scene in ("net, small", "heap, small", "heap of two kinds, small", "stars, 1024, small") for engine, n in (("hand", 1), ("fast", 1), ("fast", 2))}
    for row in rows:
        assert row["words_differing"] == 0 and 0.1 < row["ns_per_object_step"] < 1e5 and 0.01 < row["ratio_to_hand"] < 1000
        assert row["engine"] == "fast" or row["ratio_to_hand"] == 1


@pytest.fixture
def peers(tmp_path):
    """A Python that has the packages of others, and what they do there: shell commands by name, which write to $OUTPUT."""
    def peers(**done):
        python = tmp_path / "python"
        cases = "".join(f"{name}) {command} ;;\n" for name, command in done.items())
        python.write_text(f"""#!/bin/sh
test "$2" = list && {{ echo "{' '.join(done)}"; exit; }}
case "$*" in *"--bullet "*"/bullet --fp3 "*"--folder "*"--output "*" --quick") ;; *) exit 3 ;; esac
OUTPUT=$(echo "$*" | sed 's/.*--output //; s/ .*//')
case $2 in
{cases}esac
""")
        python.chmod(0o755)
        return python
    return peers


def written(engine, scene="net, small", objects=800, ns=50.0, error="2e-6", variant=""):
    """What a peer does that has one row."""
    return f"""echo '[{{"scene": "{scene}", "engine": "{engine}", "variant": "{variant}", "threads": 1, "objects": {objects}, "ns_per_object_step": {ns}, "error": {error}}}]' >"$OUTPUT" """


def test_others_stand_beside_the_loops(world, peers):
    """What a Python that has their packages writes."""
    python = peers(taichi=written("taichi"), box2d=written("box2d", "heap, small", 91, error="null", variant="2D"))
    done, found = world("--parts", "speed", "--peers", python)
    hand, = (row for row in found["speed"] if (row["scene"], row["engine"]) == ("net, small", "hand"))
    taichi, box2d = found["speed"][-2:]
    assert done.returncode == 0 and (taichi["engine"], taichi["error"], box2d["engine"], box2d["error"]) == ("taichi", 2e-6, "box2d", None)
    assert taichi["ratio_to_hand"] == pytest.approx(50 / hand["ns_per_object_step"]) and "ratio_to_hand" not in box2d
    assert found["peers_failed"] == []


@pytest.mark.parametrize("command, why", [("echo 'warp: no processor' >&2; exit 1", "warp: warp: no processor"), ("kill -SEGV $$", "warp: exit code -11"), ("exit 0", "warp: wrote no rows"),
                                          ("echo '[{' >$OUTPUT", "warp: wrote no rows"), (written("warp", ns="NaN"), "warp: found nan ns and an error of 2e-06, expected a time above 0"),
                                          (written("warp", error="NaN"), "warp: found 50.0 ns and an error of nan"), (written("warp", ns=0), "warp: found 0 ns")])
def test_a_peer_that_fails_is_named(world, peers, command, why):
    """It has no row; those of the others stay."""
    done, found = world("--parts", "speed", "--peers", peers(taichi=written("taichi"), warp=command, rebound=written("rebound")))
    assert done.returncode == 1 and [row["engine"] for row in found["speed"][-3:]] == ["fast", "taichi", "rebound"]
    assert len(found["peers_failed"]) == 1 and found["peers_failed"][0].startswith(why) and f"world: {why}" in done.stderr and "Traceback" not in done.stderr


def test_a_python_that_fails_is_told(world, peers):
    python = peers()
    python.write_text("#!/bin/sh\necho no such package >&2\nexit 1\n")
    done, found = world("--parts", "speed", "--peers", python)
    assert done.returncode == 1 and found is None and "peers: no such package" in done.stderr


def test_what_is_not_installed_is_left_out(world, root, tmp_path):
    """Python finds no package where there is none; without its program Bullet is none either."""
    def found(*options):
        done = subprocess.run([sys.executable, "-I", "-S", root / "tools/world_peers.py", "list", *options], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout.split()
    (tmp_path / "bullet").write_text("")
    assert found() == [] and found("--bullet", tmp_path / "nonesuch") == [] and found("--bullet", tmp_path / "bullet") == ["bullet"]
    done, data = world("--parts", "speed", "--peers", tmp_path / "nonesuch")
    assert done.returncode == 0 and {row["engine"] for row in data["speed"]} == {"hand", "fast"}


@pytest.fixture
def lab(root, build, tmp_path, monkeypatch):
    """The tools' modules, on the quick forms."""
    monkeypatch.syspath_prepend(root / "tools")
    return importlib.import_module("fp3world.physics").Lab(build / "fp3", tmp_path, True)


def test_the_error_of_a_net_is_its_distance_from_double_precision(lab, measured):
    """The double steps against forces of all links one by one; a wrong spring, a step too many and a moved mass are told."""
    truth, physics, ws = (importlib.import_module(name) for name in ("fp3world.truth", "fp3world.physics", "fp3world.scene"))
    net = truth.Net(True)
    x, v, steps = net.start(), numpy.zeros((net.objects, 3)), net.steps
    links = [(a, b, k, numpy.hypot(b % 40 - a % 40, b // 40 - a // 40) * net.spacing) for kind, k in net.stiffness.items() for a, b, _ in ws.grid_links((40, 20), net.spacing, (kind,))]
    springs = physics.Springs(links, [link[2] for link in links], [link[3] for link in links], net.objects)
    for _ in range(steps):
        v[40:] += net.h * (net.w * springs.forces(x)[40:] + [0, -net.g, 0])
        x += net.h * v
    double = net.in_double()
    assert abs(double - x).max() < 1e-12 and 0.9 < double[:, 1].min() < 0.999
    rows = [row for row in measured["speed"] if row["scene"] == "net, small" and row["engine"] in ("hand", "fast")]
    assert len(rows) == 3 and {row["error"] for row in rows} == {truth.of_fp3(lab, net.case)} and 1e-8 < rows[0]["error"] < 2e-6
    x[100, 2] += 1e-5 * net.size
    assert net.error(lab, x) == pytest.approx(1e-5)
    for found in (truth.at(lab, net.case, steps + 1)[0], x + 1, x * numpy.nan):
        with pytest.raises(ws.Failed, match="expected less than 0.0001"):
            net.error(lab, found)
    for found in (net.start(), x * numpy.nan, 3 * x):
        with pytest.raises(ws.Failed, match="bursts"):
            net.check(found)


def test_the_error_of_stars_is_that_of_their_energy(lab, measured):
    """A longer step errs more, by its square; fp3 in float32 has roundings beside it."""
    truth = importlib.import_module("fp3world.truth")
    stars = truth.Stars("stars, 1024", True)

    def error(parts):
        x, v = stars.start(lab)
        h, m = stars.h * stars.steps / parts, 1 / stars.objects
        for _ in range(parts):
            x = x + h / 2 * v
            way = x[None] - x[:, None]
            v = v + h * m * (way / ((way ** 2).sum(-1) + stars.soft ** 2)[..., None] ** 1.5).sum(1)
            x = x + h / 2 * v
        return stars.error(lab, x, v)
    assert error(8) / error(16) == pytest.approx(4, rel=0.1) and error(64) < 1e-8
    rows = [row for row in measured["speed"] if row["scene"] == "stars, 1024, small" and row["engine"] in ("hand", "fast")]
    assert {row["error"] for row in rows} == {truth.of_fp3(lab, stars.case)} and abs(rows[0]["error"] - error(64)) < 1e-7 and rows[0]["error"] > 0
    assert {row["error"] for row in measured["speed"] if row["scene"] == "heap, small" and row["engine"] in ("hand", "fast")} == {None}


def test_a_net_by_bullet(root, build, lab):
    """Where its library is installed: springs as in double precision; threads that neither burst nor stay; bad arguments."""
    truth, program = importlib.import_module("fp3world.truth"), build / "bench/bullet"
    if not program.exists():
        pytest.skip("needs libbullet-dev: make setup-bench")
    net = truth.Net(True)

    def run(*arguments):
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=60)
        return done, numpy.array(done.stdout.split(), float)
    for kind, most in (("springs", 2e-6), ("threads", 1e-3)):
        done, found = run(kind, 40, 20, net.steps, 5, 3)
        assert done.returncode == 0 and len(found) == 6 * 800 + 1 and 1e-7 < found[-1] < 0.1
        assert net.difference(lab, found[:2400].reshape(-1, 3)) < most
    for arguments in ((), ("springs", 40, 20, 1, 1), ("ropes", 40, 20, 1, 1, 1), ("springs", 0, 20, 1, 1, 1), ("springs", "4x", 20, 1, 1, 1), ("threads", 40, 20, 1, 1, 10001)):
        done, found = run(*arguments)
        assert done.returncode == 2 and "usage: bullet springs|threads" in done.stderr and not len(found)


@pytest.fixture
def bench(root, build, tmp_path):
    def bench(*options):
        path = tmp_path / "rows.json"
        done = subprocess.run([build / "bench/world", "--json", path, *map(str, options)], capture_output=True, text=True, timeout=120)
        return done, json.loads(path.read_text()) if path.exists() else None
    return bench


def scene_of(root, folder, name, *changes):
    text = (root / f"programs/world/{name}.scene").read_text().replace('program = "', f'program = "{root}/programs/world/')
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "x.scene").write_text(text)
    return folder / "x.scene"


@pytest.mark.parametrize("name, changes", [
    ("net", [("[128, 128]", "[7, 5]"), ("0..127", "0..6")]), ("net", [("[128, 128]", "[33, 3]"), ("0..127", "0..32")]),
    ("net", [("[128, 128]", "[1, 50]"), ("0..127", "0..0")]),
    ("net", [("grid    = { position = \"x\"; along = \"xz\"; count = [128, 128]; spacing = 0.0078125; origin = [0.0, 1.0, 0.0]; };", "points = \"p.csv\";"),
             ("links   = ( { relation = \"springs\"; grid = [\"structural\", \"shear\"]; rest = \"rest\"; },", "links = ( { relation = \"springs\"; file = \"l.csv\"; } );"),
             ("{ relation = \"springs\"; grid = \"bending\"; rest = \"rest\"; set = { k = 6.0; }; } );", ""), ("0..127", "0..5")]),
    ("stars", [("objects = 300", "objects = 1")]), ("stars", [("objects = 300", "objects = 33")]), ("stars", [("objects = 300", "objects = 97")]),
    ("balls", [("objects = 300", "objects = 1")]), ("balls", [("objects = 300", "objects = 17")]),
    ("balls", [("objects = 300", "objects = 200"), ("apart = 0.1", "apart = 0.07"), ("semi_implicit_euler\";", "semi_implicit_euler\"; set = { damp = 0.1; v_x = 3.0; };")])])
def test_loops_by_hand_of_any_size(root, tmp_path, bench, name, changes):
    """Objects that fill no vector, and links without an order, whose neighbours are gathered."""
    random = numpy.random.default_rng(1)
    (tmp_path / "p.csv").write_text("x_x,x_y,x_z\n" + "".join(",".join(map(str, row)) + "\n" for row in random.uniform(0, 0.02, (70, 3)).round(4)))
    pairs = {tuple(sorted(pair)) for pair in random.integers(0, 70, (300, 2)).tolist() if pair[0] != pair[1]}
    (tmp_path / "l.csv").write_text("a,b,k\n" + "".join(f"{a},{b},{1 + a / 64}\n" for a, b in sorted(pairs, key=lambda pair: (pair[1] * 7 % 11, pair))))
    done, rows = bench("--scene", scene_of(root, tmp_path, name, *changes), "--loop", name, "--steps", 40, "--repeats", 4)
    assert done.returncode == 0, done.stderr
    assert [row["words_differing"] for row in rows] == [0, 0, 0]


def test_what_the_bench_program_tells(root, tmp_path, bench):
    scene = scene_of(root, tmp_path, "stars", ("objects = 300", "objects = 20"))
    assert [row["words_differing"] for row in bench("--scene", scene, "--loop", "stars", "--flip", "--threads", 1)[1]] == [0, 1]
    assert "no loop 'moons'" in bench("--scene", scene, "--loop", "moons")[0].stderr
    assert "loop 'stars' has one kind of objects" in bench("--scene", root / "programs/world/players.scene", "--loop", "stars")[0].stderr
    assert "the scene's program has no 'w'" in bench("--scene", scene, "--loop", "net")[0].stderr
    assert bench("--scene", scene, "--steps", "0")[0].returncode != 0 and bench()[0].returncode != 0
    scene = scene_of(root, tmp_path, "balls", ("objects = 300;", "objects = 300; only = { objects = 7; set = { x_x = -1e8; }; };"))
    assert "a ball is far from all others" in bench("--scene", scene, "--loop", "balls")[0].stderr
    assert "nonesuch" in bench("--scene", tmp_path / "nonesuch.scene")[0].stderr


@pytest.fixture
def liar(build, tmp_path):
    """A command that changes what another one says, where its options have a word."""
    def liar(word, change):
        path = tmp_path / "fp3"
        path.write_text(f'#!/bin/sh\ncase "$*$FP3_FAST" in *"{word}"*) {build}/fp3 "$@" | sed "{change}";; *) exec {build}/fp3 "$@";; esac\n')
        path.chmod(0o755)
        return path
    return liar


@pytest.mark.parametrize("word, variant, count", [pytest.param("--threads 2", "interpreter, 2 threads", 1, marks=pytest.mark.long),
                                                  ("x86-64-v3", "native x86-64-v3, 1 thread", 1),
                                                  pytest.param("skin.scene", "skin 0, 2 threads", 1, marks=pytest.mark.long),
                                                  ("shuffled", "objects in another order", 1)])
def test_a_wrong_bit_is_told(world, liar, word, variant, count):
    """One bit of one word."""
    done, found = world("--parts", "hashes", "--scenes", "balls" if word == "skin.scene" else "chain", fp3=liar(word, r"/^\(x_x\|u\) .*object 7$/ { s/f   obj/0   obj/; t; s/.   obj/f   obj/ }"))
    assert done.returncode == 1
    bad = [row for row in found["hashes"] if row["words_differing"]]
    assert variant in {row["variant"] for row in bad} and {row["words_differing"] for row in bad} == {count}
    assert f"{bad[0]['scene']}, fast, {bad[0]['variant']}: {count} words differ" in done.stderr


def test_a_run_of_another_kind_is_no_row(world, liar):
    """Native code that was not made would compare the interpreter with itself."""
    done, found = world("--parts", "hashes", fp3=liar("x86-64-v3", "s/native x86-64-v3/interpreter x86-64-v3/"))
    assert done.returncode == 1 and found is None and "expected a run by x86-64-v3" in done.stderr


def test_the_page_has_all_rows(root, measured, tmp_path):
    def page(data):
        (tmp_path / "world.json").write_text(json.dumps(data))
        done = subprocess.run([sys.executable, root / "tools/pages.py", "world", "--results", tmp_path, "--docs", tmp_path], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return (tmp_path / "world.md").read_text()
    text = page(measured)
    for row in measured["physics"]:
        assert row["what"] in text
    assert text.count("| `world` |") == text.count("| `fabric` |") == len(measured["chip"]) / 2 and text.count("| by hand |") == 4 and ": does not hold" not in text
    assert all(f"| `{row['hash']}` | 0 |" in text for row in measured["hashes"])
    hand = next(row for row in measured["speed"] if row["engine"] == "hand")
    assert f"| 1.00 | {hand['error']:.2g} |\n" in text and "| of the loop by hand | error |\n" in text
    other = {"scene": "net, small", "engine": "bullet", "variant": "another model", "threads": 1, "objects": 800, "ns_per_object_step": 87.5, "ratio_to_hand": 9.1, "error": None}
    assert "| net, small | bullet (another model) | 1 | 800 | 87.5 | 9.10 |  |\n" in page(measured | {"speed": [other]})
    measured["physics"][0]["holds"], measured["hashes"][0]["words_differing"] = False, 5
    try:
        text = page(measured)
    finally:
        measured["physics"][0]["holds"], measured["hashes"][0]["words_differing"] = True, 0
    assert text.count(": does not hold |") == 1 and text.count("` | 5 |") == 1


def test_rows_stay_of_scenes_that_are_not_measured(root, build, tmp_path, measured):
    """The others keep theirs, in their order; the page says which scenes were measured later."""
    path, page = tmp_path / "world.json", tmp_path / "world.md"
    rows = [row | {"hash": "0" * 16} if row["scene"] in ("train", "chain") else row for row in measured["hashes"]]
    path.write_text(json.dumps(measured | {"hashes": rows}))
    command = [sys.executable, root / "tools/world.py"]
    done = subprocess.run([*command, "--fp3", build / "fp3", "--output", path, "--parts", "hashes", "--scenes", "train", "--quick"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = json.loads(path.read_text())
    assert [row for row in found["hashes"] if row["scene"] == "train"] == [row for row in measured["hashes"] if row["scene"] == "train"]
    assert sorted(map(str, found["hashes"])) == sorted(str(row | {"hash": "0" * 16} if row["scene"] == "chain" else row) for row in measured["hashes"])
    made = subprocess.run([sys.executable, root / "tools/pages.py", "world", "--results", tmp_path, "--docs", tmp_path])
    assert made.returncode == 0 and "Later than their parts: hashes of `train` " in page.read_text()
    refused = subprocess.run([*command, "--parts", "chip", "--scenes", "train"], capture_output=True, text=True)
    assert refused.returncode == 2 and "expected --parts hashes or physics beside --scenes" in refused.stderr


@pytest.mark.long
def test_parts_stay_that_are_not_measured(root, build, tmp_path, measured):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(measured | {"chip": []}))
    command = [sys.executable, root / "tools/world.py", "--fp3", build / "fp3", "--output", path, "--parts", "chip", "--quick"]
    assert subprocess.run(command, capture_output=True, text=True, timeout=120).returncode == 0
    assert json.loads(path.read_text()) | {"about": 0, "measured": 0} == measured | {"about": 0, "measured": 0}
    path.write_text(json.dumps(measured | {"about": {"form": "full"}}))  # the rows of another form do not
    assert subprocess.run(command, capture_output=True, text=True, timeout=120).returncode == 0
    assert set(json.loads(path.read_text())) == {"about", "measured", "chip", "refused_on_chip"}


def test_arguments(world, root):
    assert world("--parts", "nonesuch")[0].returncode == 2
    done, found = world(fp3=root / "nonesuch")
    assert done.returncode == 1 and found is None and "nonesuch" in done.stderr and "Traceback" not in done.stderr
