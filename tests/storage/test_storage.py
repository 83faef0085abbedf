"""Records of 16 bits: what a store makes of a number, what is refused, how many objects fit, and that all engines agree."""

import os
import re
import subprocess

import pytest

ENGINES = [("isa", ""), ("fast", "interpreter"), ("fast", ""), ("rtl", "")]
SUM = ".state x\n.param v\nstep:\nadd x, x, v\n"
SPRING = ".state x v\n.param k\n.shared dt\n.temp k_dt\nstep:\nmul k_dt, k, dt\nmsub v, k_dt, x, v\nmadd x, v, dt, x\n"


@pytest.fixture
def run(fp3, tmp_path):
    """Runs a program, or a file, and tells what was printed."""
    def start(program, *more, how="", config="many_half", status=0):
        path = program
        if isinstance(program, str):
            path = tmp_path / "program.s"
            path.write_text(program)
        done = subprocess.run([fp3, "run", path, *(["-c", config] if config else []), *map(str, more)], capture_output=True, text=True, timeout=300,
                              env={"FP3_FAST": how, "FP3_CACHE_DIR": str(tmp_path / "cache"), "PATH": "/usr/bin:/bin"})
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    return start


def states(said):
    return re.findall(r"^(\w+) +(\S+) +0x(\w+) +object (\d+)$", said, re.M)


@pytest.mark.smoke
def test_words_are_rounded_and_draws_are_fair(build):
    """Each number of both formats and its neighbours; 3 standard deviations are reached by one measurement in 370."""
    done = subprocess.run([build / "tests/storage_words"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    words = dict(re.findall(r"^(\w+): (\d+) words, 0 wrong$", done.stdout, re.M))
    assert int(words["bfloat16"]) > 600_000 and int(words["binary16"]) > 10_000_000
    means = re.findall(r"means are off by (\S+) standard deviations at most", done.stdout)
    pairs = re.findall(r"agrees but for (\S+) standard deviations", done.stdout)
    assert len(means) == 2 and len(pairs) == 14 and all(float(off) < 3 for off in means + pairs), done.stdout


@pytest.mark.smoke
@pytest.mark.parametrize("engine, how", ENGINES)
def test_what_the_host_writes_is_rounded(run, engine, how):
    """The middle between 1 and 1 + 2^-10, 2^-25 and a bit more, and the last number that is not infinite."""
    for given, word in (("1.00048828125", "3f800000"), ("1.0004884", "3f802000"), ("2.98023224e-8", "00000000"), ("2.9802326e-8", "33800000"),
                        ("65519.996", "477fe000"), ("-65504", "c77fe000"), ("inf", "7f800000")):
        said = run(SUM, "-e", engine, "-N", 1, "-n", 0, "--set", f"x={given}", "--set", "v=0", "--allow-failures", how=how)
        assert states(said)[0][2] == word, (given, said)


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_numbers_that_no_record_has_are_refused(run, engine):
    said = run(SUM, "-e", engine, "-N", 3, "--set", "x=65520", "--set", "v=0", status=2)
    assert "object 0, register 0: 65520 is too large: configuration 'many_half' keeps records in binary16, up to 65504" in said
    said = run(SUM, "-e", engine, "-N", 3, "--spread", "x=65000:66000", "--set", "v=0", status=2)
    assert "object 2, register 0: 66000 is too large" in said


@pytest.mark.smoke
def test_a_parameter_that_would_lose_digits_is_refused(run):
    """A state may come near 0, and so may a parameter that a record has exactly."""
    said = run(SUM, "-e", "isa", "-N", 1, "--set", "x=1e-6", "--set", "v=1e-6", status=2)
    assert "object 0, param 'v': 9.99999997e-07 is too small: configuration 'many_half' keeps records in binary16, where it would be 1.01327896e-06" in said
    for v in ("0", "5.9604645e-8", "6.2e-5"):
        run(SUM, "-e", "isa", "-N", 1, "--set", "x=1e-6", "--set", f"v={v}")


@pytest.mark.smoke
@pytest.mark.parametrize("engine, how", ENGINES)
def test_a_store_that_overflows_is_a_failure(run, engine, how):
    """40000 + 20000 fits, 60000 + 20000 does not; registers have both, so within a visit nothing is wrong."""
    options = ("-e", engine, "--set", "x=40000", "--set", "v=20000", "-N", 30)
    said = run(SUM, *options, "-n", 3, "--visit", 1, how=how, status=3)
    assert re.search(r"^failed +30 of 30, first object 0 in step 2: overflow", said, re.M), said
    assert "overflow" in re.search(r"^flags +(.*)$", said, re.M)[1]
    assert {row[2] for row in states(said) if row[0] == "x"} == {"7f800000"}
    said = run(SUM, *options, "-n", 1, how=how)
    assert {row[1] for row in states(said) if row[0] == "x"} == {"60000"}


@pytest.mark.smoke
def test_a_program_counts_its_steps_as_far_as_records_do(run):
    counting = ".state steps\nstep:\nadd steps, steps, 1.0\n"
    assert states(run(counting, "-e", "isa", "-N", 1, "-n", 2048, "--set", "steps=0"))[0][1] == "2048"
    assert "the program counts its steps in many_half, which ends at 2048" in run(counting, "-e", "isa", "-N", 1, "-n", 2049, "--set", "steps=0", status=2)


@pytest.mark.smoke
def test_twice_the_objects_fit(run, root, monkeypatch):
    """As many bits of store as many_full, and one object more is refused: by the engine, and by the program's records."""
    monkeypatch.syspath_prepend(root / "tools")
    from fp3gen.read import load
    rows = {row["name"]: row for row in load(root).configs}
    full, half = rows["many_full"], rows["many_half"]
    assert half["storage"] == 2 and 16 * half["store_words"] == 32 * full["store_words"] and half["registers"] == full["registers"]
    start = ("-e", "rtl", "-n", 0, "--set", "x=0", "--set", "v=0")
    for config, most in (("many_full", 2048), ("many_half", 4096)):
        run(SUM, *start, "-N", most, config=config)
        assert f"{most + 1} objects: configuration '{config}' has room for {most} at most" in run(SUM, *start, "-N", most + 1, config=config, status=2)
    wide = ".state " + " ".join(f"s{i}" for i in range(32)) + "\nstep:\n" + "".join(f"add s{i}, s{i}, s0\n" for i in range(32))
    start = ("-e", "rtl", "-n", 0, *(word for i in range(32) for word in ("--set", f"s{i}=0")))
    for config, most in (("many_full", 512), ("many_half", 1024)):
        run(wide, *start, "-N", most, config=config)
        assert f"configuration '{config}' has room for {most} objects, not for {most + 1}" in run(wide, *start, "-N", most + 1, config=config, status=2)


@pytest.mark.smoke
def test_a_seed_gives_the_same_bits_everywhere(run):
    """Draws are of objects and steps, not of who computes them; another seed gives others, and none rounds to nearest."""
    def bits(*more, **options):
        return [row[2] for row in states(run(SPRING, "-N", 60, "-n", 40, "--visit", 3, "--all", "--spread", "x=1:2", "--set", "v=0",
                                             "--set", "k=0.37", "--set", "dt=0.01", *more, **options))]
    drawn = bits("--seed", 5, "-e", "isa")
    assert len(drawn) == 120
    for engine, how in ENGINES[1:]:
        assert bits("--seed", 5, "-e", engine, how=how) == drawn, (engine, how)
    assert bits("--seed", 5, "-e", "fast", "--threads", 1) == drawn
    others = [bits("--seed", 6, "-e", "isa"), bits("-e", "isa")]
    assert all(sum(a != b for a, b in zip(drawn, other)) > 60 for other in others)
    said = run(SUM, "-e", "isa", "--seed", 1, config="many_full", status=2)
    assert "seed: configuration 'many_full' keeps records in 32 bits" in said


@pytest.mark.smoke
def test_what_no_half_can_hold_is_refused(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    from fp3gen import configs
    from fp3gen.check import Bad
    from fp3gen.read import load
    known = load(root)
    row = next(row for row in known.configs if row["name"] == "many_half")
    for change, why in (({"sleep": 0, "exceptions": "run", "neighbours": 1}, "storage = 2 needs neighbours = 0: a record then holds numbers, and one integer for `sleep`"),
                        ({"add_latency": 3, "add_cuts": 0, "mul_latency": 4, "mul_cuts": 0}, "add_latency + mul_latency must be at least 8")):
        with pytest.raises(Bad, match=re.escape(why)):
            configs.check_configs([{**configs.settable(row, known.keys), **change}], known.keys)


SLEEPS = ".state x v slept\n.param k\n.shared dt\n.temp k_dt\nstep:\nmul k_dt, k, dt\nmsub v, k_dt, x, v\nmadd x, v, dt, x\nsleep slept, v, 0.02\n"
LATE = ".state slept t\n.shared limit\n.temp left\nstep:\nadd t, t, 1.0\nsub left, limit, t\nsleep slept, left, 0.5\n"


@pytest.mark.smoke
@pytest.mark.parametrize("config", ["many_half", "many_full"])
@pytest.mark.parametrize("load, steps", [("ld", 6), ("lds", 2)])
def test_a_program_may_write_and_load_the_word_itself(run, config, load, steps):
    """`ld` of the register of `sleep` gets all of its bits, and goes on; after `lds` of a word that is not 0 the object makes no visit."""
    own = f".state x slept\nfirst:\nld x\n{load} slept\nstep:\nadd x, x, 1.0\nadd slept, slept, 1.0009765625\nsleep slept, 1.0, 0.5\nlast:\nst x\nst slept\n"
    for engine, how in ENGINES:
        said = states(run(own, "-e", engine, "-N", 2, "-n", 6, "--visit", 2, "--all", "--set", "x=0", "--set", "slept=0", how=how, config=config))
        word = {2: "40002000", 6: "40c03000"}[steps]
        assert [row[1:3] for row in said if row[0] == "x"] == [(str(steps), {2: "40000000", 6: "40c00000"}[steps])] * 2, (engine, how)
        assert {row[2] for row in said if row[0] == "slept"} == {word}, (engine, how)


@pytest.mark.smoke
def test_adaptive_steps_are_refused(run, fp3, tmp_path):
    """By the compiler, and by an engine that gets such a program ready-made."""
    (tmp_path / "m.ode").write_text("state x = 1\nx' = -x\nstep 0.125\nspan 1\n")
    said = run(tmp_path / "m.ode", "--tolerance", "1e-3", status=2)
    assert "adaptive steps keep their time in the object's record: records of configuration 'many_half' have 16 bits" in said
    subprocess.run([fp3, "compile", tmp_path / "m.ode", "--tolerance", "1e-3", "-c", "many_full", "-o", tmp_path / "m.s"], check=True, timeout=300)
    said = run(tmp_path / "m.s", "-n", 10, status=2)
    assert "the program chooses its steps: configuration 'many_half' keeps records in binary16, which is too coarse for times" in said


@pytest.mark.smoke
@pytest.mark.parametrize("visit", [1, 7])
def test_objects_sleep_and_draw_alike(run, visit):
    """They fall asleep one by one, so that each lane's list is in an order of its own; what they draw is of the object all the same."""
    def bits(*more, **options):
        return [row[2:] for row in states(run(SLEEPS, "-N", 60, "-n", 105, "--visit", visit, "--all", "--spread", "x=1:2", "--set", "v=0.5",
                                              "--set", "k=0.37", "--set", "dt=0.01", *more, **options))]
    for seed in ((), ("--seed", 5)):
        expected = bits("-e", "isa", *seed)
        slept = {int(word, 16) for word, _ in expected[2::3]}
        assert 0 in slept and len(slept) > 20
        for engine, how in ENGINES[1:]:
            assert bits("-e", engine, *seed, how=how) == expected, (engine, how, seed)


@pytest.mark.smoke
@pytest.mark.parametrize("engine, how", ENGINES)
def test_the_step_in_which_it_slept_is_whole(run, engine, how):
    """70,001 has more than 16 bits, and no number of 16 bits is near 2^32 - 1."""
    said = run(LATE, "-e", engine, "-N", 2, "-n", 70005, "--set", "t=0", "--set", "limit=70001", how=how, status=3)
    assert {row[2] for row in states(said) if row[0] == "slept"} == {f"{70001:08x}"}
    assert re.search(r"^failed +2 of 2, first object 0 in step 70005: overflow", said, re.M), said # t is too large for its record


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_lifetimes(fp3, tmp_path, engine):
    """An object that is gone holds 2^32 - 1; who was born late made fewer steps. Visits end where somebody is born, so that stores round in the same steps."""
    (tmp_path / "x.s").write_text(SLEEPS.replace("0.02", "0"))
    (tmp_path / "x.scene").write_text("""config = "many_half"; steps = 40; visit = 5;
        groups = ({ program = "x.s"; objects = 5; born = [0, 20]; gone = 30; set = { x = 1.0; v = 0.5; k = 0.25; dt = 0.125; }; });""")
    alone = [states(subprocess.run([fp3, "run", "x.s", "-c", "many_half", "-e", "isa", "-N", "1", "-n", str(30 - born), "--visit", "5", "--set", "x=1", "--set", "v=0.5",
                                    "--set", "k=0.25", "--set", "dt=0.125"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=True).stdout)
             for born in (0, 5, 10, 15, 20)]
    done = subprocess.run([fp3, "run", "--scene", "x.scene", "-e", engine, "--all"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    held = states(done.stdout)
    for number, expected in enumerate(alone):
        assert [row[:3] for row in held if row[3] == str(number)][:2] == [row[:3] for row in expected][:2], (number, done.stdout)


@pytest.mark.long
def test_other_configurations_agree(root, build, tmp_path, monkeypatch):
    """bfloat16 records of numbers with 10 fraction bits, two groups of lanes, results as soon as may be: built, and tested as the named ones are."""
    monkeypatch.syspath_prepend(root / "tools")
    from fp3fpga import one_config
    from fp3gen.read import load
    row = next(row for row in load(root).configs if row["name"] == "many_half") | {
        "name": "some", "storage": 1, "fraction": 10, "lanes": 5, "contexts": 6, "store_words": 512, "registers": 16, "program_words": 512,
        "add_cuts": 4, "mul_cuts": 4, "add_latency": 4, "mul_latency": 4}
    tree = tmp_path / "some"
    one_config.build(row, tree, build)
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    for name in ("random_stream", "host_port"):
        one_config.run("gcc", *sanitize, "-o", tree / name, build / f"obj/tests/cosim/{name}.o", tree / "own.o", build / "lib/libfp3.a", *one_config.LIBS)
        done = subprocess.run([tree / name, *(["--instructions", "50000"] if name == "random_stream" else [])], env={**os.environ, "FP3_RTL_DIR": str(tree)},
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        assert ("instructions in" if name == "random_stream" else ", 0 failed") in done.stdout
