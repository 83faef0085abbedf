"""What must not be: every misuse is an exception that says what was expected, never a crash or a silent number."""

import contextlib
import copy
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import fp3

TEXT = "param k = 1\nshared g = 1\nstate x = 1\nstate y = 0\nstep 0.0625\nx' = -k*x*g\ny' = x\n"
NAN, INF = float("nan"), float("inf")
ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("options, told", [
    ({"t_span": (0, 0)}, "t_span"), ({"t_span": (1, 0)}, "t_span"), ({"t_span": (0, NAN)}, "t_span"), ({"t_span": (0, INF)}, "t_span"),
    ({"t_span": 3}, "t_span"), ({"t_span": (0, 1, 2)}, "t_span"), ({"t_span": (0, 1e30)}, "steps"),
    ({"y0": [1]}, r"shape \(1,\), expected \(2,\) or \(objects, 2\) numbers: x, y"), ({"y0": [1, 2, 3]}, "y0"), ({"y0": np.zeros((2, 2, 2))}, "y0"),
    ({"y0": ["a", "b"]}, "y0"), ({"y0": [[]]}, "y0"), ({"y0": np.zeros((0, 2))}, "shape"), ({"y0": {"z": 1}}, "no state 'z'"), ({"y0": [1j, 0]}, "y0"),
    ({"y0": [NAN, 0]}, "'x' is -?nan"), ({"y0": [[0, 0], [INF, 0]]}, "object 1: 'x' is inf"), ({"y0": [1e39, 0]}, "x"), ({"y0": {"x": None}}, "x"),
    ({"params": {"k": NAN}}, "'k' is -?nan"), ({"params": {"k": [1, NAN]}}, "object 1: 'k'"), ({"params": {"q": 1}}, "no 'q'"), ({"params": {"x": 1}}, "is a state"),
    ({"params": {"g": [1, 2]}}, "shared"), ({"params": {"h": 1}}, "h="), ({"params": {"until": 1}}, "t_span"), ({"params": {"k": [[1]]}}, "shape"),
    ({"params": {"k": "fast"}}, "expected"), ({"params": {"k": ["a"]}}, "expected"), ({"params": {"k": [1, 2]}, "y0": np.zeros((3, 2))}, "number of objects"),
    ({"params": {"k": 1e50}}, "k"), ({"objects": 0}, "objects"), ({"objects": -1}, "objects"), ({"objects": 2.0}, "whole number"),
    ({"objects": True}, "whole number"),
    ({"objects": 2**26}, "objects"), ({"objects": 2**40}, "objects"), ({"objects": 3, "y0": [[1, 0]]}, "number of objects"),
    ({"h": 0}, "h"), ({"h": -1}, "h"), ({"h": NAN}, "h"), ({"h": "small"}, "h"), ({"h": 1e-46}, "h|steps"), ({"h": INF}, "h"),
    ({"rtol": 0}, "rtol"), ({"rtol": NAN}, "rtol"), ({"rtol": 1e-12}, "tolerance"), ({"rtol": "x"}, "rtol"), ({"atol": 1e-3}, "without rtol"), ({"max_step": 1}, "without rtol"),
    ({"rtol": 1e-3, "atol": -1}, "atol"), ({"rtol": 1e-3, "method": "rk4"}, "rk4"), ({"rtol": 1e-3, "cut": True}, "cut"), ({"rtol": 1e-3, "max_step": 0}, "max_step"),
    ({"t_eval": []}, "t_eval"), ({"t_eval": [1, 0]}, "ascend"), ({"t_eval": [0, 0]}, "ascend"), ({"t_eval": [-1]}, "ascend"), ({"t_eval": [2]}, "ascend"),
    ({"t_eval": [0.5, 1, 1 + 1e-9]}, "ascend"), ({"t_eval": [-1e-9, 0]}, "ascend"), ({"t_eval": [1 + 1e-6]}, "ascend"), ({"t_eval": [0, INF]}, "ascend"),
    ({"t_eval": [0.5, 2, 1]}, "ascend"), ({"t_eval": [NAN]}, "ascend"),
    ({"t_eval": 1}, "t_eval"), ({"t_eval": ["a"]}, "t_eval"), ({"t_eval": [0.3, 0.3 + 1e-12]}, "same FP32"),
    ({"engine": "quick"}, "no engine 'quick'"), ({"engine": "fa\0st"}, "NUL"), ({"config": "huge"}, "huge"), ({"method": "rk5"}, "rk5"), ({"arithmetic": "none"}, "arithmetic"),
    ({"threads": -1}, "threads"), ({"threads": 5000}, "threads"), ({"attempts": 0}, "attempts"), ({"links": {"near": ([0], [1])}}, "near"), ({"links": {"near": 3}}, "expected \\(a, b\\)"),
    ({"y0": np.ma.array([0.0, 1.0], mask=[0, 1])}, "masked"), ({"params": {"k": np.ma.array([0.0, 1.0], mask=[0, 1])}}, "masked"),
    ({"method": "stoermer_verlet"}, "."), ({"config": "single_full", "objects": 2}, "room")])
def test_what_solve_ivp_refuses(options, told):
    with pytest.raises(fp3.Error, match=told):
        fp3.solve_ivp(TEXT, **{"t_span": (0, 1), **options})


@pytest.mark.parametrize("misuse, told", [
    (lambda b: b["z"], "no 'z'"), (lambda b: b.__setitem__("z", 1), "no 'z'"), (lambda b: b.__setitem__("x", [1]), "one for each of 4"),
    (lambda b: b.__setitem__("x", NAN), "nan"), (lambda b: b.__setitem__("x", [1, 2, NAN, 4]), "object 2"), (lambda b: b.__setitem__("x", np.float32([1, 2, NAN, 4])), "object 2"),
    (lambda b: b.__setitem__("x", "a"), "number"), (lambda b: b.__setitem__("x", np.zeros((4, 1))), "shape"), (lambda b: b.__setitem__("x", [1j] * 4), "complex"),
    (lambda b: b.__setitem__("g", [1, 2, 3, 4]), "one number for all"), (lambda b: b.__setitem__("h", 0), "h"), (lambda b: b.write("x", [1], 4), "object 4"),
    (lambda b: b.write("x", [1, 2], 3), "object 3"), (lambda b: b.write("x", [1], -1), "first"), (lambda b: b.write("x", [1], 2**63), "4 objects"), (lambda b: b.read("x", 5), "first"),
    (lambda b: b.read("x", 0, 5), "count"), (lambda b: b.read("x", out=np.zeros(3)), "out"), (lambda b: b.read("x", out=[0] * 4), "out"), (lambda b: b.read("x", out=np.zeros(4, int)), "out"),
    (lambda b: b.read("x", out=b["x"]), "out"), (lambda b: b.run(-1), "steps"), (lambda b: b.run(2**32), "steps"), (lambda b: b.run(1.5), "steps"),
    (lambda b: b.add(-1), "count"), (lambda b: b.remove([5]), "no object"), (lambda b: b.link("near", [0], [1]), "near"), (lambda b: b.link("near", [0], [1, 2]), "one of each"),
    (lambda b: b.link("near", [0.5], [1]), "whole"), (lambda b: b.link("near", [-1], [1]), "-1"), (lambda b: b.link("near", [0], [1], f=[1, 2]), "shape")])
def test_what_a_batch_refuses(misuse, told):
    with fp3.Batch(TEXT, 4) as batch:
        batch.run()
        before = batch.read("x")
        with pytest.raises(fp3.Error, match=told):
            misuse(batch)
        assert np.array_equal(batch.read("x"), before)
        batch.run()


@pytest.mark.parametrize("options", [{"objects": 0}, {"objects": 2**33}, {"objects": 2**26}, {"h": -1}, {"h": NAN}, {"tolerance": -1}, {"tolerance": NAN}, {"engine": "x"},
                                     {"params": {"k": [1, 2]}}, {"params": {"zz": 1}}, {"threads": 2000}, {"links": {"near": ([0], [1])}}, {"until": INF, "tolerance": 1e-3}])
def test_what_cannot_be_opened(options):
    with pytest.raises(fp3.Error):
        fp3.Batch(TEXT, **options)


CABLE = fp3.Model("param k = 1\nlinks rope(rest = 1)\nstate x[2] = (1, 0)\nstep 0.0625\nx' = sum(o in rope: o.x - x)*k\n")
NUMBERS = {
    "set": lambda b, v: b.__setitem__("k", v), "write": lambda b, v: b.write("k", v), "write some": lambda b, v: b.write("k", [v]),
    "first": lambda b, v: b.write("k", [1.0], v),
    "count": lambda b, v: b.read("k", 0, v), "from": lambda b, v: b.read("k", v), "add": lambda b, v: b.add(v), "add with": lambda b, v: (b.remove(b.handles), b.add(1, k=v)), "run": lambda b, v: b.run(v),
    "link": lambda b, v: b.link("rope", [0], v), "link one": lambda b, v: b.link("rope", [0], [v]), "field": lambda b, v: b.link("rope", [0], [1], rest=v),
    "fields": lambda b, v: b.link("rope", [0], [1], rest=[v]),
    **{name: lambda b, v, name=name: fp3.Batch(TEXT, **{name: v}) for name in ("objects", "h", "skin", "threads", "until")},
    "tolerance": lambda b, v: fp3.Batch(TEXT, tolerance=v), "params": lambda b, v: fp3.Batch(TEXT, 4, params={"k": v}), "tune": lambda b, v: fp3.tune(TEXT, v),
    "ranges": lambda b, v: fp3.tune(TEXT, 1e-3, ranges={"k": (v, 2)}), "range": lambda b, v: fp3.tune(TEXT, 1e-3, ranges={"k": v}),
    "t_span": lambda b, v: fp3.solve_ivp(TEXT, (0, v)), "begin": lambda b, v: fp3.solve_ivp(TEXT, (v, 2)),
    **{name: lambda b, v, name=name: fp3.solve_ivp(TEXT, (0, 1), **{name: v}) for name in ("y0", "t_eval", "h", "rtol", "objects", "threads", "attempts")},
    "y0 of one": lambda b, v: fp3.solve_ivp(TEXT, (0, 1), [v, 0]), "y0 by name": lambda b, v: fp3.solve_ivp(TEXT, (0, 1), {"x": v}),
    "given": lambda b, v: fp3.solve_ivp(TEXT, (0, 1), params={"k": v}),
    "max_step": lambda b, v: fp3.solve_ivp(TEXT, (0, 1), rtol=1e-3, max_step=v), "time": lambda b, v: fp3.solve_ivp(TEXT, (0, 1), t_eval=[v])}
NO_NUMBERS = ["3", b"3", np.str_("3"), np.array("3", object), np.array("3"), 1j, 10**400, -10**5000, NAN, [[1], [2, 3]], np.ma.masked,
              np.ma.array([1.0, 2], mask=[0, 1]),
              np.datetime64(1, "s"), np.zeros(2, "f4,i4"), object(), {"a": 1}, {1}, lambda: 1, np.array([True] * 4), ["3"] * 4, [None] * 4, np.zeros((2, 2, 2))]


@pytest.mark.filterwarnings("ignore:Warning. converting a masked element:UserWarning")
@pytest.mark.parametrize("use", NUMBERS)
def test_what_is_no_number(use):
    """Text that looks like one, an integer without a float, a mask ...: each is refused in words, and nothing has changed."""
    with fp3.Batch(CABLE, 4) as batch:
        before = batch.read("k")
        for value in NO_NUMBERS + ([True, np.True_] if use not in ("write some", "link one", "fields", "y0 of one", "time", "t_span", "begin") else []):
            with pytest.raises(fp3.ArgumentError, match="[a-z0-9 ']+"):
                print(use, type(value), NUMBERS[use](batch, value))
        assert np.array_equal(batch.read("k"), before)


@pytest.mark.parametrize("options, told", [
    ({"params": [1]}, "a dict"), ({"params": np.ones(2)}, "a dict"), ({"links": [1]}, "a dict"), ({"cut": 1}, "True or False"),
    ({"may_compile": "no"}, "True or False"),
    ({"progress": 3}, "a function"), ({"method": "\ud800"}, "called"), ({"y0": {3: 1}}, "no state 3"), ({"y0": {"x": [1, 2], "y": [1]}}, "objects")])
def test_what_else_solve_ivp_refuses(options, told):
    with pytest.raises(fp3.ArgumentError, match=told):
        fp3.solve_ivp(TEXT, (0, 1), **options)


@pytest.mark.parametrize("name", [None, 3, b"x", {"x": 1}, np.float32(1), ("x", 1), [None]])
def test_names_are_strings(name):
    with fp3.Batch(TEXT, 4) as batch:
        for use in (lambda: batch[name], lambda: batch.__setitem__(name, 1), lambda: batch.read(name), lambda: batch.write(name, [1]),
                    lambda: batch.link(name, [], []),
                    lambda: fp3.Batch(TEXT, engine=name), lambda: fp3.solve_ivp(TEXT, (0, 1), arithmetic=name or 0)):
            with pytest.raises(TypeError, match="expected a string"):
                use()
        for several in (["x"], ("x",)):  # read and write alone take them
            for use in (lambda: batch[several], lambda: batch.__setitem__(several, 1), lambda: batch.link(several, [], [])):
                with pytest.raises(TypeError, match="expected a string"):
                    use()
        group = fp3.Scene(ROOT / "programs/mixed.scene", engine="fast").groups[0]
        with pytest.raises(TypeError, match="expected a string"):
            group[name]
        assert name not in group and name not in batch and "x" in batch and "k" in batch and "z" not in batch and "x\0" not in batch and "\ud800" not in batch


def test_arrays_of_other_layouts():
    """Not aligned, backwards, read-only, of a record, of another order of bytes: the values count, not how they lie."""
    record = np.zeros(4, "u1,f4")
    record["f1"] = [1, 2, 3, 4]
    locked = np.array([1, 2, 3, 4], np.float32)
    locked.flags.writeable = False
    with fp3.Batch(TEXT, 4) as batch:
        for array in (record["f1"], np.frombuffer(b"!" + locked.tobytes(), np.float32, offset=1), locked, locked[::-1].copy()[::-1], locked.astype(">f4"),
                      locked.astype(">i2")):
            batch["k"] = 9
            batch["k"] = array
            assert batch.read("k").tolist() == [1, 2, 3, 4]
        for out in (np.empty(17, "u1")[1:].view(np.float32), np.empty(8, np.float32)[::2], np.empty(4, ">f4"), locked, np.ma.array(np.empty(4)), batch["k"]):
            with pytest.raises(fp3.ArgumentError, match="out"):
                batch.read("k", out=out)


def test_what_a_batch_is_not(root):
    """It is no sequence, and no copy of it can be made: it says so. What can be copied is copied."""
    batch, scene = fp3.Batch(TEXT, 4), fp3.Scene(root / "programs/mixed.scene", engine="fast")
    for of, kind in ((batch, "batch"), (scene, "scene")):
        for use in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match=f"a {kind} cannot be pickled or copied"):
                use(of)
    for of in (batch, scene.groups[0]):
        with pytest.raises(TypeError, match="not iterable"):
            list(of)
    for use in (copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="cannot be pickled or copied"):
            use(batch._program)
    assert "r_x" in scene.groups[0] and "q" not in scene.groups[0] and 0 not in scene.groups[0]
    solution = fp3.solve_ivp(batch.model, (0, 1))
    for use in (copy.copy, copy.deepcopy, lambda of: pickle.loads(pickle.dumps(of))):
        assert np.array_equal(use(solution)["x"], solution["x"]) and use(batch.model).states == ("x", "y") and use(batch["x"]).tolist() == [1] * 4
    assert "x" in solution and "t" in solution and "z" not in solution and solution.get("x") is not None and solution.get("z", 3) == 3


class Closes:
    """A value that closes the batch while it is read."""

    def __init__(self, batch):
        self.batch = batch

    def __float__(self):
        self.batch.close()
        return 1.0

    def __index__(self):
        self.batch.close()
        return 1

    def __array__(self, *of, **options):
        self.batch.close()
        return np.zeros(4, np.float32)

    def __fspath__(self):
        self.batch.close()
        return "x"


class ClosesAsNumber:
    __init__, __float__, __index__ = Closes.__init__, Closes.__float__, Closes.__index__


CLOSING = [lambda b, v: b.__setitem__("x", v), lambda b, v: b.write("x", v), lambda b, v: b.write("x", [1.0], v), lambda b, v: b.read("x", v),
           lambda b, v: b.read("x", 0, v),
           lambda b, v: b.add(v), lambda b, v: b.add(0, x=v), lambda b, v: b.remove(v), lambda b, v: b.write_of("x", b.handles, v), lambda b, v: b.run(v), lambda b, v: b.read(v), lambda b, v: b[v], lambda b, v: b.write(v, [1.0]),
           lambda b, v: b.link("near", v, v),
           lambda b, v: b.link("near", [0], [1], f=v), lambda b, v: b.link(v, [0], [1])]


@pytest.mark.parametrize("number", range(len(CLOSING)))
def test_arguments_that_close_the_batch(number):
    for kind in (Closes, ClosesAsNumber):
        batch = fp3.Batch(TEXT, 4)
        with pytest.raises((fp3.ArgumentError, TypeError)):
            CLOSING[number](batch, kind(batch))
        assert kind is ClosesAsNumber or "closed" in repr(batch)


def test_a_signal_handler_closes_the_batch():
    """Wherever it comes: the call that is on its way ends as it would have, and the next one is refused."""
    before, refused = signal.getsignal(signal.SIGALRM), 0
    try:
        for turn in range(40):
            batch = fp3.Batch(TEXT, 50)
            x = batch["h"]
            signal.signal(signal.SIGALRM, lambda *of: batch.close())
            signal.setitimer(signal.ITIMER_REAL, 0.0003 + 0.0001 * turn)
            try:
                while True:
                    batch.run()
                    batch["x"], batch["k"] = 0.5, x[:1].repeat(50)
                    batch.add(0)
            except fp3.ArgumentError as error:
                refused += "closed" in str(error)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert refused == 40


def test_a_progress_that_closes_the_scene(root):
    scene = fp3.Scene(root / "programs/mixed.scene", engine="fast")
    with pytest.raises(fp3.ArgumentError, match="scene is closed"):
        scene.run(1000, progress=lambda share: scene.close())


def test_a_fork_while_another_thread_steps(python):
    """The lock of its parent's thread is held for ever in the child, which is refused all the same, can close, and can open its own."""
    told = python(f"""
import os, signal, threading, time, fp3
batch, scene, stop = fp3.Batch({TEXT!r}, 20_000, threads=1), fp3.Scene({str(ROOT / "programs/mixed.scene")!r}, engine="fast"), []
def work():
    while not stop:
        with batch._c(), scene._c(), fp3._library._lock:
            batch.run(20)
fp3.Batch({TEXT!r})
thread = threading.Thread(target=work)
thread.start()
time.sleep(0.1)
for turn in range(3):
    child = os.fork()
    if not child:
        signal.alarm(60)  # if it hangs
        refused = 0
        for use in (batch.run, scene.run, lambda: batch["x"], lambda: batch.time):
            try:
                use()
            except fp3.ArgumentError as error:
                refused += "forked" in str(error)
        batch.close()
        scene.close()
        fp3._library._loaded = None
        with fp3.Batch({TEXT!r}, 50) as own:
            own.run()
        os._exit(refused)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
stop.append(1)
thread.join()
batch.run()
""")
    assert told.split() == ["4"] * 3


def test_a_fork_waits_for_code_that_is_loaded(python):
    """By another thread. The child would wait for the linker's lock for ever: one of 50 did."""
    told = python(f"""
import os, threading, time, fp3
fp3.Batch({TEXT!r})
begun, done = threading.Event(), []
def work():
    with fp3._library.loading:
        begun.set()
        time.sleep(0.3)
        done.append(1)
thread = threading.Thread(target=work)
thread.start()
begun.wait()
child = os.fork()
if not child:
    fp3.Batch({TEXT!r}).run()
    os._exit(len(done))
with fp3._library.loading:
    inner = os.fork()  # one that this thread itself is in, as a signal handler may be, waits for nobody
    if not inner:
        os._exit(2)
print([os.waitstatus_to_exitcode(os.waitpid(each, 0)[1]) for each in (child, inner)])
fp3.Batch({TEXT!r}).run()
""")
    assert told.split("\n")[0] == "[1, 2]"


USES = [lambda b: b["x"], lambda b: b.run(), lambda b: b.__setitem__("x", 1), lambda b: b.read("x"), lambda b: b.add(0), lambda b: b.living, lambda b: b.handles, lambda b: b.remove([]), lambda b: b.restart(), lambda b: b.time,
        lambda b: b.how, lambda b: b.failure(), lambda b: b.status(), lambda b: b.link("near", [0], [1])]


@pytest.mark.parametrize("number", range(len(USES)))
def test_a_closed_batch(number):
    batch = fp3.Batch(TEXT, 4)
    batch.close()
    batch.close()
    with pytest.raises(fp3.ArgumentError, match="closed"):
        USES[number](batch)
    assert "closed" in repr(batch) and len(batch) == 4


def test_threads_follow_each_other():
    """Eight threads at one batch: its steps are counted, and no value is torn."""
    batch, wrong = fp3.Batch(TEXT, 2000), []
    x = batch["x"]

    def work():
        for _ in range(40):
            batch.run(1)
            now = batch.read("x")
            if not (now == now[0]).all():
                wrong.append(1)
    threads = [threading.Thread(target=work) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not wrong and batch.time == 320 / 16 and (x == x[0]).all()


def test_threads_solve_side_by_side(root):
    model, answers = fp3.Model(root / "programs/kepler.ode"), [None] * 6

    def work(i):
        answers[i] = fp3.solve_ivp(model, (0, 4), objects=200, threads=1, method=["rk4", "verlet"][i % 2]).y
    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert np.array_equal(answers[0], answers[2]) and np.array_equal(answers[1], answers[5]) and not np.array_equal(answers[0], answers[1])


def test_a_fork(python):
    """The child is refused the parent's batch, opens one of its own, and ends; so does the parent."""
    told = python(f"""
import os, fp3
batch = fp3.Batch({TEXT!r}, 50_000, threads=2)
batch.run(50)
x = batch["x"]
child = os.fork()
if not child:
    try:
        batch.run()
    except fp3.ArgumentError as error:
        assert "forked" in str(error)
        own = fp3.Batch({TEXT!r}, 50_000, threads=2)
        own.run(50)
        assert (own["x"] == x).all()
        del own, batch
        print("child", flush=True)
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
batch.run()
print("parent")
""")
    assert told.split() == ["child", "parent"]


def test_multiprocessing(python, tmp_path):
    (tmp_path / "work.py").write_text(f"import fp3\nMODEL = fp3.Model({TEXT!r})\ndef work(k):\n    return float(fp3.solve_ivp(MODEL, (0, 1), params={{'k': k}}).y[0, -1])\n")
    told = python("import sys; sys.path.insert(0, '.')\nimport multiprocessing as m, work\nif __name__ == '__main__':\n"
                  "    print([round(x, 4) for x in m.get_context('fork').Pool(2).map(work.work, [1.0, 2.0])], "
                  "[round(x, 4) for x in m.get_context('spawn').Pool(2).map(work.work, [1.0, 2.0])])")
    assert told.strip() == "[0.3679, 0.1353] [0.3679, 0.1353]"


def computed(pid):
    """Seconds of processor time, of a script and of a command that it has started: no load of the machine makes them pass."""
    took = 0
    for each in [str(pid), *pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()]:
        with contextlib.suppress(OSError):
            name, of = pathlib.Path(f"/proc/{each}/stat").read_text(encoding="utf-8").rsplit(")", 1)
            took += sum(map(int, of.split()[11:13])) if each == str(pid) or name.endswith("(fp3") else 0
    return took / os.sysconf("SC_CLK_TCK")


@pytest.fixture
def begun(environment, tmp_path):
    """A script that has printed `begun` and then computes. It hears Ctrl-C, also where the tests run in the background and ignore it; and it ends at last."""
    runs, timers = [], []

    def begun(script):
        hears = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
        run = subprocess.Popen([sys.executable, "-c", hears + script], env={**environment, "TMPDIR": str(tmp_path)}, cwd=tmp_path, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
        timers.append(threading.Timer(120, run.kill))
        timers[-1].start()
        runs.append(run)
        assert run.stdout.readline() == "begun\n", run.stderr.read()
        before = computed(run.pid)
        while run.poll() is None and computed(run.pid) < before + 0.2:
            time.sleep(0.01)
        assert run.poll() is None, run.communicate()
        return run
    yield begun
    for run, timer in zip(runs, timers):
        timer.cancel()
        run.kill()


@pytest.mark.parametrize("call", ["fp3.solve_ivp(M, (0, 1e6), objects=20_000)", "fp3.solve_ivp(M, (0, 1e6), objects=20_000, rtol=1e-6, max_step=1e-3)",
                                  "fp3.solve_ivp(M, (0, 1e5), h=2**-5, objects=200, engine='isa')", "fp3.Batch(M, 20_000).run(2**31)",
                                  "fp3.Batch(M, 20_000, tolerance=1e-6, maxstep=1e-3, until=1e6).run(2**31)"])
def test_a_keyboard_interrupt_ends_a_long_run(begun, call):
    """Soon, and the session goes on. Each of these runs would take minutes."""
    script = textwrap.dedent(f"""
        import fp3, sys, time
        M = fp3.Model({TEXT!r})
        fp3.solve_ivp(M, (0, 1))
        print("begun", flush=True)
        try:
            {call}
        except KeyboardInterrupt:
            print("stopped", time.perf_counter(), flush=True)
        print(fp3.solve_ivp(M, (0, 1)).success)
    """)
    run = begun(script)
    sent = time.perf_counter()
    os.kill(run.pid, signal.SIGINT)
    said = run.stdout.readline().split()
    assert len(said) == 2, run.stderr.read()
    word, at = said
    out, err = run.stdout.read(), run.stderr.read()  # communicate would leave out what readline has read ahead
    assert word == "stopped" and float(at) - sent < 30 and out == "True\n" and run.wait(60) == 0, (out, err)


@pytest.mark.parametrize("call", ["bench({})", "tune({}, 1e-5, around=0.05, held_out=4096)"])
def test_a_keyboard_interrupt_ends_a_command(begun, root, tmp_path, call):
    script = f"import fp3\nprint('begun', flush=True)\ntry:\n    fp3.{call.format(repr(str(root / 'programs/kepler.ode')))}\nexcept KeyboardInterrupt:\n    print('stopped')\n"
    run = begun(script)
    os.kill(run.pid, signal.SIGINT)
    assert run.stdout.read() == "stopped\n" and run.wait(60) == 0 and not list(tmp_path.glob("fp3-*"))


def test_a_library_of_another_version_is_refused(python, environment, tmp_path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib.c").write_text('const char *fp3_version(unsigned *n) { (void)n; return "9.9.9"; }\n'
                                    'void fp3_batch_set_default(void *def, unsigned long size) { (void)def; (void)size; }\n')
    subprocess.run(["gcc", "-shared", "-fPIC", tmp_path / "lib.c", "-o", tmp_path / "lib/libfp3.so.0"], check=True)
    environment["FP3_HOME"] = str(tmp_path)
    try:
        told = python("import fp3\ntry:\n    fp3.integrators()\nexcept ImportError as error:\n    print(error)")
        assert "version 9.9.9" in told
        environment["FP3_HOME"] = str(tmp_path / "none")
        assert "looked in" in python("import fp3\ntry:\n    fp3.integrators()\nexcept ImportError as error:\n    print(error)")
    finally:
        environment["FP3_HOME"] = os.environ["FP3_HOME"]


def test_no_memory_is_an_exception():
    """More results than a machine has room for."""
    with pytest.raises((MemoryError, fp3.Error, ValueError)):
        fp3.solve_ivp(TEXT, (0, 2**24), h=0.0625, objects=2**22, t_eval=np.arange(0, 2**24, 64))
