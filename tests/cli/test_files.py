"""Files of a command: none is lost, outputs are whole or not there, what cannot be written is found before the work."""

import fcntl
import os
import resource
import signal
import stat
import subprocess
import threading
import time

import pytest

MODEL = "state x = 1\nstate v = 0\nx' = v\nv' = -x\nstep 0.01\n"
SOURCE = ".state x\nstep:\nadd x, x, 1.0\n"


@pytest.fixture
def folder(fp3, root, tmp_path):
    (tmp_path / "m.ode").write_text(MODEL)
    (tmp_path / "M.ODE").write_text(MODEL)
    (tmp_path / "p.s").write_text(SOURCE)
    (tmp_path / "euler.cfg").write_bytes((root / "programs/integrators/euler.cfg").read_bytes())
    (tmp_path / "x.cfg").write_text("x = 1;\n")
    (tmp_path / "m.scene").write_text('config = "many_full"; groups = ( { program = "M.ODE"; objects = 3; params = "x.cfg"; integrator = "euler.cfg"; } );\n')
    (tmp_path / "link").symlink_to("m.ode")
    (tmp_path / "dangling").symlink_to("new")
    os.link(tmp_path / "m.ode", tmp_path / "hard")
    (tmp_path / "folder").mkdir()
    subprocess.run([fp3, "asm", "p.s", "-o", "p.fp3"], cwd=tmp_path, check=True)
    return tmp_path


@pytest.fixture
def start(fp3, folder):
    def start(command, **options):
        return subprocess.run([fp3, *command.split()], cwd=folder, capture_output=True, timeout=120, **options)
    return start


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


# Which output would be lost: each command line, and what the message says.
COLLISIONS = {
    "compile m.ode -o m.ode": "--output m.ode would overwrite MODEL m.ode",
    "compile m.ode -o ./folder/../m.ode": "would overwrite",
    "compile m.ode --image link": "--image link would overwrite",
    "compile m.ode --params hard": "--params hard would overwrite",
    "compile link -o m.ode": "would overwrite",
    "compile m.ode -i euler.cfg -o euler.cfg": "would overwrite --integrator euler.cfg",
    "compile m.ode -o a --image a": "--output a and --image a are one file",
    "compile m.ode -o a --image ./a": "are one file",
    "compile m.ode -o new --image dangling": "are one file",
    "compile m.ode -o - --image -": "are one file",
    "compile m.ode -o - --image /dev/stdout": "are one file",
    "run m.ode --kanata m.ode": "--kanata m.ode would overwrite PROGRAM m.ode",
    "run m.ode --bus-log link": "--bus-log link would overwrite",
    "run m.ode --params x.cfg --bus-log x.cfg": "would overwrite --params x.cfg",
    "run m.ode --kanata a --bus-log a": "are one file",
    "run p.fp3 --bus-log p.fp3": "would overwrite",
    "run --scene m.scene --bus-log m.scene": "would overwrite --scene m.scene",
    "run --scene m.scene --bus-log M.ODE": "would overwrite program M.ODE",
    "run --scene m.scene --bus-log x.cfg": "would overwrite params x.cfg",
    "run --scene m.scene --bus-log euler.cfg": "would overwrite integrator euler.cfg",
    "compare m.ode --quick --json hard": "--json hard would overwrite",
    "compare m.ode --quick -i euler.cfg --json euler.cfg": "would overwrite",
    "bench -p ./m.ode --json link": "--json link would overwrite",
    "bench -p ./m.ode -P x.cfg --json x.cfg": "would overwrite",
    "bench ./m.ode --quick --csv m.ode": "--csv m.ode would overwrite MODEL",
    "bench ./m.ode --quick --csv a.csv --json a.csv": "are one file",
    "asm p.s -o p.s": "would overwrite SOURCE p.s",
    "asm p.s --hex a --listing a": "are one file",
    "dis p.fp3 -o p.fp3": "would overwrite IMAGE p.fp3",
    "compile - --params -": "",  # no collision: one is read, the other written
}


@pytest.mark.parametrize("command", COLLISIONS)
def test_no_file_is_lost(start, folder, command):
    before = contents(folder)
    done = start(command, input=MODEL.encode())
    said = COLLISIONS[command]
    assert (done.returncode, done.stdout[:0] if not said else done.stdout) == (2 if said else 0, b""), done.stderr
    assert said in done.stderr.decode() and contents(folder) == before


UNWRITABLE = ["compile m.ode -o", "compile m.ode --image", "compile m.ode --params", "run m.ode --kanata",
              "run m.ode --bus-log", "compare m.ode --json", "bench -p ./m.ode --json", "bench ./m.ode --quick --csv", "asm p.s -o", "asm p.s --hex",
              "asm p.s --listing", "dis p.fp3 -o"]


@pytest.mark.parametrize("command", UNWRITABLE)
def test_what_cannot_be_written_is_found_before_the_work(start, folder, command):
    before = contents(folder)
    for path in ("nowhere/file", "folder", "m.ode/file", "x" * 256):
        done = start(f"{command} {path}")
        assert (done.returncode, done.stdout) == (2, b""), (path, done)
        assert f"{path}: cannot write: ".encode() in done.stderr
    assert contents(folder) == before


def test_devices_and_pipes_are_written_directly(start, folder):
    assert start("compile m.ode -o /dev/null --image /dev/null").returncode == 0
    whole = start("compile m.ode").stdout
    for name in ("-", "/dev/stdout", "/dev/fd/1"):
        assert start(f"compile m.ode -o {name}").stdout == whole
    assert start("compile m.ode -o /dev/stderr").stderr == whole
    assert start("asm p.s -o -").stdout == (folder / "p.fp3").read_bytes()
    full = start("compile m.ode -o /dev/full")
    assert full.returncode == 1 and b"/dev/full: cannot write: No space" in full.stderr
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_a_named_pipe_is_read_and_written(fp3, start, folder):
    """Nobody waits for ever: tests/hostile."""
    os.mkfifo(folder / "pipe")
    whole = start("compile m.ode").stdout
    with subprocess.Popen([fp3, "compile", "m.ode", "-o", "pipe"], cwd=folder) as writer:
        assert (folder / "pipe").read_bytes() == whole and writer.wait() == 0
    with subprocess.Popen([fp3, "compile", "pipe", "--model", "-o", "from.s"], cwd=folder) as reader:
        (folder / "pipe").write_text(MODEL)
        assert reader.wait() == 0 and (folder / "from.s").read_bytes().endswith(whole[-100:])


def test_standard_input_is_read_by_every_command(start, folder):
    assert start("compile -", input=MODEL.encode()).stdout.replace(b"# _ by", b"# m by") == start("compile m.ode").stdout
    image = start("asm - -o -", input=SOURCE.encode()).stdout
    assert image == (folder / "p.fp3").read_bytes()
    assert start("dis -", input=image).stdout == start("dis p.fp3").stdout
    assert start("info -", input=image).stdout == start("info p.fp3").stdout
    cut = lambda done: [line for line in done.stdout.splitlines() if b"object " in line]
    assert cut(start("run - -e isa --set x=1", input=image)) == cut(start("run p.fp3 -e isa --set x=1")) != []
    assert cut(start("run - --model -e isa", input=MODEL.encode())) == cut(start("run m.ode -e isa")) != []
    assert b"_" in start("compare - --quick -i euler --most-steps 64", input=MODEL.encode()).stdout
    twice = start("compile - -i -", input=MODEL.encode())
    assert twice.returncode == 2 and b"standard input can be read once" in twice.stderr
    assert b"each configuration reads it again" in start("bench -p -").stderr


def test_what_is_printed_makes_room_for_data_on_standard_output(start):
    done = start("run m.ode --kanata -")
    assert done.returncode == 0 and done.stdout.startswith(b"Kanata\t") and b"object_steps" not in done.stdout
    assert b"object_steps" in done.stderr
    done = start("compare m.ode --quick -i euler --most-steps 64 --json -")
    assert done.stdout.startswith(b"{") and b"floor" in done.stderr


def test_the_standard_output_is_a_file_like_others(fp3, folder):
    for command, target in (("run m.ode", "m.ode"), ("run m.ode --bus-log log", "log"), ("compile m.ode -o out", "out")):
        with open(folder / target, "ab") as out:
            done = subprocess.run([fp3, *command.split()], cwd=folder, stdout=out, stderr=subprocess.PIPE)
        assert done.returncode == 2 and b"standard output" in done.stderr, command
    assert (folder / "m.ode").read_text() == MODEL


def test_a_name_may_begin_with_a_hyphen(start, folder):
    (folder / "-m.ode").write_text(MODEL)
    assert start("compile -o -out -- -m.ode").returncode == 0
    assert (folder / "-out").read_bytes() == start("compile ./-m.ode").stdout


def test_a_file_keeps_its_mode_and_a_symbolic_link_stays_one(start, folder):
    (folder / "secret").write_text("old")
    (folder / "secret").chmod(0o640)
    (folder / "to").symlink_to("secret")
    assert start("compile m.ode -o to").returncode == 0 and start("compile m.ode -o dangling").returncode == 0
    (folder / "one").write_text("old")
    os.link(folder / "one", folder / "other")
    assert start("compile m.ode -o one").returncode == 0 and (folder / "other").read_text() == "old"
    assert (folder / "to").is_symlink() and stat.S_IMODE((folder / "secret").stat().st_mode) == 0o640
    assert (folder / "secret").read_bytes() == (folder / "new").read_bytes() == start("compile m.ode").stdout


def test_a_bus_log_is_there_whole_or_not_at_all(start, folder):
    (folder / "log").write_text("old")
    assert start("run m.ode --set nope=1 --bus-log log").returncode == 2  # found after the hardware was opened
    assert (folder / "log").read_text() == "old"
    assert start("run m.ode --bus-log log").returncode == 0
    assert (folder / "log").read_text().startswith("r 0")
    done = start("run m.ode -e isa --bus-log log2")
    assert done.returncode == 2 and b"only the hardware" in done.stderr
    (folder / "isa.scene").write_text('engine = "isa"; ' + (folder / "m.scene").read_text())
    done = start("run --scene isa.scene --bus-log log2")
    assert done.returncode == 2 and b"no bus" in done.stderr
    assert not [path for path in folder.iterdir() if path.name.startswith(".") or path.name == "log2"]


@pytest.mark.parametrize("option", ["--bus-log", "--kanata"])
def test_a_full_disk_is_found_before_the_run(start, folder, option):
    """Ten million steps of the hardware would take minutes."""
    done = start(f"run m.ode -n 10000000 {option} /dev/full", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (10, 10)))
    assert done.returncode == 1 and b"/dev/full: cannot write: No space left on device" in done.stderr, done


@pytest.mark.parametrize("command", ["run m.ode --bus-log log", "run m.ode -n 50 --kanata log", "compile m.ode -o log", "run m.ode -e isa -n 999 --every 1 --output log"])
def test_a_file_that_may_not_grow_is_a_write_that_fails(start, folder, command):
    """Without a signal's help: the kernel would end the command."""
    done = start(command, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
    assert done.returncode == 1 and b"log: cannot write: File too large" in done.stderr, done
    assert not (folder / "log").exists() and not [path for path in folder.iterdir() if path.name.startswith(".")]


@pytest.mark.parametrize("command", ["--help", "--version", "--usage", "run --help", "info", "compile m.ode", "compile --list",
                                     "dis p.fp3", "run m.ode", "compare m.ode --quick -i euler --most-steps 64"])
def test_a_full_disk_is_no_success(fp3, folder, command):
    with open("/dev/full", "wb") as full:
        done = subprocess.run([fp3, *command.split()], cwd=folder, stdout=full, stderr=subprocess.PIPE, timeout=120)
    assert done.returncode == 1 and b"cannot write the output" in done.stderr


@pytest.mark.parametrize("name, option", [("M.ODE", ""), ("m.Ode", ""), ("model", "--model"), ("m.s", "--model")])
def test_a_model_is_known_by_its_ending_in_any_case_or_by_an_option(start, folder, name, option):
    (folder / name).write_text("\ufeff" + MODEL, encoding="utf-8")
    states = [line for line in start("run m.ode -e isa").stdout.splitlines() if b"object " in line][:2]
    assert start(f"run {option} {name} -e isa").stdout.splitlines()[:2] == states
    assert start(f"compile {option} {name}").returncode == 0


def test_assembly_and_images_have_endings_in_any_case(start, folder):
    (folder / "P.S").write_text("\ufeff" + SOURCE, encoding="utf-8")
    assert start("asm P.S -o P.FP3").returncode == 0 and start("run P.S -e isa --set x=1").returncode == 0
    done = start("compile P.S")
    assert done.returncode == 2 and b"expected a model (*.ode, or --model)" in done.stderr


# Each way of writing: what is read as a file, HDF5, a checkpoint, pictures, pages, native code.
OUTPUTS = ["compile m.ode -o {}", "compile m.ode --native -o {}", "run m.ode -e isa --output {}", "run m.ode -e isa --output {}.h5", "run m.ode -e isa --checkpoint {}",
           "run m.ode --bus-log {}", "run m.ode --kanata {}", "asm p.s --listing {}", "compare m.ode --quick -i euler --most-steps 64 --json {}", "view r.csv --position x -o {}"]


def temporary_of(folder, command):
    return folder / f".fp3-{command.format('out').rsplit(' ')[-1]}.tmp"


@pytest.mark.parametrize("command", OUTPUTS)
def test_what_stands_at_the_name_of_a_temporary_is_safe(start, folder, command):
    """A link or a file there is refused, whoever made it. What another process writes now is refused, what was left behind is replaced."""
    (folder / "r.csv").write_text("step,object,x\n0,0,1\n1,0,2\n")
    (folder / "victim").write_text("precious")
    (folder / "door").mkdir()
    (folder / "door/new").write_text("precious")
    at = temporary_of(folder, command)
    for make in (lambda: at.symlink_to("victim"), lambda: at.symlink_to("door"), lambda: os.link(folder / "victim", at)):
        make()
        done = start(command.format("out"))
        assert done.returncode == 2 and f"{at.name} is in the way".encode() in done.stderr, done
        assert (folder / "victim").read_text() == (folder / "door/new").read_text() == "precious"
        at.unlink()
    at.mkdir()
    (at / "new").write_text("left behind")
    has = os.open(at, os.O_RDONLY)
    fcntl.flock(has, fcntl.LOCK_EX)
    done = start(command.format("out"))
    assert done.returncode == 2 and b"another process is writing this file" in done.stderr and not list(folder.glob("out*")), done
    os.close(has)
    done = start(command.format("out"))
    assert done.returncode == 0 and not list(folder.glob(".fp3-*")) and list(folder.glob("out*"))[0].stat().st_size, done


def test_an_input_in_the_temporary_of_an_output_is_not_lost(start, folder):
    (folder / ".fp3-log.tmp").mkdir()
    (folder / ".fp3-log.tmp/new").write_text(MODEL)
    for option in ("--bus-log", "--kanata", "--checkpoint", "--output"):
        done = start(f"run --model .fp3-log.tmp/new {option} log")
        assert done.returncode == 2 and b"log would overwrite PROGRAM .fp3-log.tmp/new" in done.stderr, done
    assert (folder / ".fp3-log.tmp/new").read_text() == MODEL


@pytest.mark.parametrize("command", OUTPUTS)
def test_an_output_has_the_mode_that_the_umask_leaves(start, folder, command):
    (folder / "r.csv").write_text("step,object,x\n0,0,1\n1,0,2\n")
    assert start(command.format("out"), preexec_fn=lambda: os.umask(0o027)).returncode == 0
    assert [stat.S_IMODE(path.stat().st_mode) for path in folder.glob("out*")] == [0o640]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_run_that_a_signal_ends(fp3, start, folder, number):
    """It has the names of its outputs for itself, and leaves nothing but after SIGKILL, and that the next run removes."""
    command = "run m.ode -e isa -n 4000000000 --every 1 --output out.h5 --checkpoint a.ck --checkpoint-every 1000"
    before = {path.name for path in folder.iterdir()}
    with subprocess.Popen([fp3, *command.split()], cwd=folder) as run:
        try:
            while run.poll() is None and not (folder / "a.ck.1").exists():
                time.sleep(0.01)
            for more in ("--output out.h5", "--checkpoint a.ck", "--checkpoint ./folder/../a.ck"):
                done = start(f"run m.ode -e isa -n 9 {more}")
                assert done.returncode == 2 and b"another process is writing this file" in done.stderr, done
            assert run.poll() is None
            run.send_signal(number)
            assert run.wait(60) == -number
        finally:
            run.kill()
    left = {path.name for path in folder.iterdir()} - before - {"a.ck", "a.ck.1"}
    assert left == ({".fp3-a.ck.tmp", ".fp3-out.h5.tmp"} if number == signal.SIGKILL else set())
    assert start("run m.ode -e isa -n 9 --output out.h5 --checkpoint a.ck").returncode == 0
    assert not list(folder.glob(".fp3-*"))


def test_a_checkpoint_that_another_process_gives_its_names(start, folder):
    """Between two renames FILE and FILE.1 are links of one file. A run says who has the names, whenever it looks."""
    at = folder / ".fp3-a.ck.tmp"
    at.mkdir()
    has, is_over = os.open(at, os.O_RDONLY), threading.Event()
    fcntl.flock(has, fcntl.LOCK_EX)

    def publish():
        while not is_over.is_set():
            (at / "new").write_text("")
            os.link(folder / "a.ck", at / "before")
            (at / "before").rename(folder / "a.ck.1")
            (at / "new").rename(folder / "a.ck")

    (folder / "a.ck").write_text("")
    other = threading.Thread(target=publish)
    other.start()
    try:
        said = {start("run m.ode -e isa -n 9 --checkpoint a.ck").stderr for _ in range(100)}
    finally:
        is_over.set()
        other.join()
        os.close(has)
    assert said == {b"fp3 run: a.ck: another process is writing this file\n"}


def test_an_ignored_signal_stays_ignored(fp3, folder):
    """As under nohup."""
    with subprocess.Popen([fp3, *"run m.ode -e isa -n 20000 --output out.csv --every 1".split()], cwd=folder, stdout=subprocess.PIPE,
                          preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)) as run:
        while run.poll() is None and not (folder / ".fp3-out.csv.tmp").exists():
            time.sleep(0.001)
        run.send_signal(signal.SIGHUP)
        assert run.wait() == 0 and (folder / "out.csv").exists()


def test_what_stands_beside_a_checkpoint_is_safe(start, folder):
    """FILE.tmp is a name like any other: a link, a program, the checkpoint of a restart."""
    (folder / "victim").write_text("precious")
    for make in (lambda: (folder / "a.ck.tmp").symlink_to("victim"), lambda: os.link(folder / "victim", folder / "a.ck.tmp")):
        make()
        assert start("run m.ode -e isa -n 5 --checkpoint a.ck").returncode == 0 and (folder / "victim").read_text() == "precious"
        (folder / "a.ck.tmp").unlink()
    (folder / "a.ck").rename(folder / "a.ck.tmp")
    kept = (folder / "a.ck.tmp").read_bytes()
    assert start("run m.ode -e isa -n 9 --restart a.ck.tmp --checkpoint a.ck").returncode == 0 and (folder / "a.ck.tmp").read_bytes() == kept


def test_a_write_begins_again_after_one_that_failed(build, tmp_path):
    """What the failed one left is gone; so is the folder of a temporary for whose name there is no memory."""
    done = subprocess.run([build / "tests/outputs"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "") and os.listdir(tmp_path) == ["file"]
