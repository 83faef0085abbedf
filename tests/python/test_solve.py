"""fp3.solve_ivp: the bits of `fp3 run`, SciPy's form, failures that are told."""

import subprocess
import warnings

import numpy as np
import pytest

import fp3

KEPLER = ("v_x", "v_y", "r_x", "r_y")


@pytest.fixture
def model(root):
    return lambda name: fp3.Model(root / "programs" / f"{name}.ode")


def same(solution, snapshots, names, number=np.float32):
    """Every number of every object at every time, bit for bit; -0 is not 0. The file has FP32 in nine digits."""
    assert len(snapshots) == solution.y.shape[-1]
    y = solution.y if solution.y.ndim == 3 else solution.y[None]
    for k, snapshot in enumerate(snapshots):
        for i, name in enumerate(names):
            expected = np.array(snapshot[name]).astype(number).astype(np.float64)
            assert np.ascontiguousarray(y[:, i, k]).tobytes() == expected.tobytes(), (name, k)


@pytest.mark.parametrize("method", [None, "rk4", "verlet", "rk8", "forest_ruth", "stoermer_verlet"])
@pytest.mark.parametrize("engine", ["fast", "isa"])
def test_fixed_steps_have_the_bits_of_the_command(model, ran, method, engine):
    vy = np.linspace(1.6, 1.8, 33)
    solution = fp3.solve_ivp(model("kepler"), (0, 6.25), {"v_y": vy}, method=method, engine=engine, t_eval=[0, 2.5, 6.25])
    options = ["-i", method] if method else []
    snapshots = ran("kepler", "-e", engine, "-c", "many_full", "-N", 33, "--spread", "v_y=1.6:1.8", "--times", "0,2.5,6.25", *options)
    same(solution, snapshots, KEPLER)
    assert solution.success and solution.status == 0 and list(solution.t) == [0, 2.5, 6.25] and not solution.failed.any()
    assert np.array_equal(solution["r_x"], solution.y[:, 2]) and solution.steps.tolist() == [400] * 33


@pytest.mark.parametrize("arithmetic, option", [("compensated", "--compensated"), ("double-single", "--double-single")])
def test_arithmetics_have_the_bits_of_the_command(model, ran, arithmetic, option):
    solution = fp3.solve_ivp(model("oscillator"), (0, 4), params={"k": np.linspace(0.5, 2, 16)}, arithmetic=arithmetic, t_eval=[1, 4])
    same(solution, ran("oscillator", "-e", "fast", "-c", "many_full", "-N", 16, "--spread", "k=0.5:2", "--times", "1,4", option), model("oscillator").states,
         np.float64 if arithmetic == "double-single" else np.float32)


def test_chosen_steps_have_the_bits_of_the_command(model, ran):
    vy = np.linspace(1.6, 1.8, 40)
    solution = fp3.solve_ivp(model("kepler"), (0, 12.5), {"v_y": vy}, rtol=1e-5, atol=1e-6, t_eval=[1, 2.503, 12.5])
    same(solution, ran("kepler", "-e", "fast", "-c", "many_full", "-N", 40, "--spread", "v_y=1.6:1.8", "--tolerance", "1e-5", "--set", "absolute=1e-6",
                       "--times", "1,2.503,12.5"), KEPLER)
    assert solution.h is None and (solution.steps > 10).all() and np.array_equal(solution.nfev, 6 * (solution.steps + solution.rejected))
    assert solution.t[1] == np.float32(2.503)


def test_many_attempts_are_made_in_parts(model, ran):
    """More than the first part has, for objects that end at different times."""
    vy = np.linspace(1.5, 1.8, 9)
    for options, of_the_command in (({"rtol": 1e-6}, ["--tolerance", "1e-6", "--until", 125]), ({"cut": True}, ["--until", 125])):
        solution = fp3.solve_ivp(model("kepler"), (0, 125), {"v_y": vy}, t_eval=[125], **options)
        same(solution, ran("kepler", "-e", "fast", "-c", "many_full", "-N", 9, "--spread", "v_y=1.5:1.8", "--times", "125", *of_the_command), KEPLER)
        assert (solution.steps > 300).all()


def test_cut_steps_have_the_bits_of_the_command(model, ran):
    solution = fp3.solve_ivp(model("kepler"), (0, 12.5), h=2**-5, method="pefrl", t_eval=[1, 2.501, 12.5])
    same(solution, ran("kepler", "-e", "fast", "-c", "many_full", "-N", 1, "-i", "pefrl", "--until", "12.5", "--set", "h=2^-5", "--times", "1,2.501,12.5"), KEPLER)
    with pytest.raises(fp3.ArgumentError, match="multiple"):
        fp3.solve_ivp(model("kepler"), (0, 12.5), h=2**-5, t_eval=[1, 2.501], cut=False)
    whole = fp3.solve_ivp(model("bouncing_ball"), (0, 2), h=2**-6)
    cut = fp3.solve_ivp(model("bouncing_ball"), (0, 2), h=2**-6, cut=True, t_eval=[0.5, 2])
    same(cut, ran("bouncing_ball", "-e", "fast", "-c", "many_full", "-N", 1, "--until", "2", "--set", "h=2^-6", "--times", "0.5,2"), model("bouncing_ball").states)
    assert not np.array_equal(whole.y[:, -1], cut.y[:, -1])


@pytest.mark.parametrize("options", [{}, {"rtol": 1e-4}, {"cut": True}], ids=["fixed", "chosen", "cut"])
def test_times_that_end_the_span_but_for_rounding(options):
    """6 * 0.1 is above 0.6 and 3 * 0.1 above 0.3 by a unit of double: in FP32, with which objects end, they are the same."""
    text = "state x = 1\nstep 0.05\nx' = -x\n"
    told = fp3.solve_ivp(text, (0, 0.6), t_eval=np.arange(7) * 0.1, **options)
    assert np.array_equal(told.y, fp3.solve_ivp(text, (0, 0.6), t_eval=[*np.arange(6) * 0.1, 0.6], **options).y) and told.y.shape == (1, 7)
    assert np.array_equal(fp3.solve_ivp(text, (3 * 0.1, 1.3), t_eval=[0.3, 1.3], **options).y, fp3.solve_ivp(text, (0.3, 1.3), **options).y)
    for times in ([0, 0.6000001], [-1e-7, 0.5]):
        with pytest.raises(fp3.ArgumentError, match="ascend"):
            fp3.solve_ivp(text, (0, 0.6), t_eval=times, **options)


def test_every_model_of_the_project(root, ran):
    """By its defaults, over some steps: whatever states, events, vectors and relations it has."""
    seen = 0
    for path in sorted((root / "programs").glob("*.ode")):
        m = fp3.Model(path)
        if m.relations:
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("error", fp3.FailedWarning)
            solution = fp3.solve_ivp(m, (0, 16 * m.step), may_compile=False)
        snapshots = ran(m.name if (root / "programs" / f"{m.name}.ode").exists() else path, "-e", "isa", "-c", "many_full", "-N", 1, "-n", 16)
        same(solution, snapshots, m.states)
        seen += 1
    assert seen > 15


def test_starts_follow_params(tmp_path, ran):
    """As with --set: a start that is an expression of params is computed from those that are given."""
    path = tmp_path / "follow.ode"
    path.write_text("param a = 2\nparam b = 3\nstate x = a*b + 0.1\nstate y = b\nstep 0.125\nx' = -x\ny' = -y\n")
    for given, options in (({"a": 0.3}, ["--set", "a=0.3"]), ({"a": np.linspace(0.3, 0.7, 5)}, ["--spread", "a=0.3:0.7"]), ({}, [])):
        solution = fp3.solve_ivp(path, (0, 1), params=given, objects=5)
        same(solution, ran(path, "-e", "fast", "-c", "many_full", "-N", 5, "-n", 8, *options), ("x", "y"))
    solution = fp3.solve_ivp(path, (0, 1), {"x": 1.0}, params={"b": 0.7})
    same(solution, ran(path, "-e", "fast", "-c", "many_full", "-N", 1, "-n", 8, "--set", "b=0.7", "--set", "x=1"), ("x", "y"))


def test_time_that_does_not_begin_at_0(model, ran, root):
    """A model with t begins at t_span[0]; of another only the difference counts."""
    solution = fp3.solve_ivp(model("duffing"), (1, 3), t_eval=[1, 2, 3], h=2**-6)
    same(solution, ran("duffing", "-e", "fast", "-c", "many_full", "-N", 1, "--set", "h=2^-6", "--set", "steps=64", "--times", "0,1,2"), model("duffing").states)
    assert list(solution.t) == [1, 2, 3]
    chosen = fp3.solve_ivp(model("duffing"), (1, 3), rtol=1e-5)
    same(chosen, ran("duffing", "-e", "fast", "-c", "many_full", "-N", 1, "--set", "t=1", "--tolerance", "1e-5", "--times", "1,3")[-2:], model("duffing").states)
    assert np.array_equal(fp3.solve_ivp(model("kepler"), (0.7, 1.7)).y, fp3.solve_ivp(model("kepler"), (0, 1)).y)


def test_beside_scipy(model):
    """The equations, to about the accuracy of FP32."""
    integrate = pytest.importorskip("scipy.integrate")
    exact = integrate.solve_ivp(lambda t, y: [-y[2] / np.hypot(*y[2:])**3, -y[3] / np.hypot(*y[2:])**3, y[0], y[1]], (0, 6.25), [0, 3**0.5, 0.5, 0],
                                rtol=1e-12, atol=1e-12, t_eval=[2.5, 6.25])
    ours = fp3.solve_ivp(model("kepler"), (0, 6.25), t_eval=[2.5, 6.25], arithmetic="compensated")
    assert ours.y.shape == exact.y.shape and np.abs(ours.y - exact.y).max() < 2e-4
    assert {"t", "y", "sol", "t_events", "y_events", "nfev", "njev", "nlu", "status", "message", "success"} <= set(ours) & set(exact)


def test_the_form_of_the_result(model):
    m = model("kepler")
    one, row, two = fp3.solve_ivp(m, (0, 1)), fp3.solve_ivp(m, (0, 1), [[0, 1.7, 0.5, 0]]), fp3.solve_ivp(m, (0, 1), objects=2)
    assert one.y.shape == (4, 2) and row.y.shape == (1, 4, 2) and two.y.shape == (2, 4, 2) and one.nfev == 256 and two.nfev.tolist() == [256, 256]
    assert np.array_equal(one.y, two.y[1]) and one.y.dtype == np.float64 and one["r_y"].shape == (2,)
    with pytest.raises(AttributeError):
        one.nothing
    with pytest.raises(KeyError):
        one["nothing"]
    assert "reached the end" in repr(one)


def test_a_failed_object_is_never_silent(tmp_path):
    path = tmp_path / "explodes.ode"
    path.write_text("param a = 1\nstate x = 1\nstep 0.125\nx' = a*x*x\n")
    a = np.array([0.01, 1.0, 0.02, 2.0])
    for options in ({}, {"rtol": 1e-4}, {"cut": True}):
        with pytest.warns(fp3.FailedWarning, match="2 of 4 objects failed, first object [13]"):
            solution = fp3.solve_ivp(path, (0, 10), params={"a": a}, **options)
        assert not solution.success and solution.status == -1 and solution.failed.tolist() == [False, True, False, True], options
        assert np.isfinite(solution.y[::2]).all()
    assert "object 3 in step" in fp3_message(path, a)


def fp3_message(path, a):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return fp3.solve_ivp(path, (0, 10), params={"a": a}).message


def test_a_failure_in_the_middle_is_told_even_if_the_end_is_finite(tmp_path):
    """A square overflows in the first steps, and the states stay finite."""
    path = tmp_path / "brief.ode"
    path.write_text("state x = 1e20\nstate s = 0\nstep 0.125\nx' = -8*x\ns' = min(1, x*x)\n")
    with pytest.warns(fp3.FailedWarning, match="object 0 in step 1: overflow"):
        solution = fp3.solve_ivp(path, (0, 64), h=0.125)
    assert not solution.success and solution.failed.all() and np.isfinite(solution.y).all()


def test_an_event_that_stops(tmp_path):
    path = tmp_path / "falls.ode"
    path.write_text("param g = 2\nstate x = 1\nstate v = 0\nstep 0.125\nx' = v\nv' = -g\nwhen root(x) falling: stop\n")
    solution = fp3.solve_ivp(path, (0, 10), params={"g": [2.0, 0.001]}, rtol=1e-5)
    assert solution.status == 1 and solution.success
    assert solution.t_events[0][0] == pytest.approx([1], abs=1e-3) and solution.t_events[1][0].size == 0
    assert solution.y_events[0][0].shape == (1, 2) and solution.y_events[0][0][0, 0] == pytest.approx(0, abs=1e-3)


def test_relations(root, ran, tmp_path):
    """Objects that see each other, with links in arrays, as with --links."""
    n = 20
    (tmp_path / "links.csv").write_text("a,b,rest\n" + "".join(f"{i},{i + 1},0.05\n" for i in range(n - 1)))
    path = root / "programs/world/cloth.ode"
    m = fp3.Model(path)
    solution = fp3.solve_ivp(m, (0, 16 * m.step), {"x_x": np.linspace(0, 1, n)}, links={m.relations[0]: (np.arange(n - 1), np.arange(1, n), {"rest": 0.05})})
    same(solution, ran(path, "-e", "fast", "-N", n, "-n", 16, "--links", f"{m.relations[0]}={tmp_path / 'links.csv'}", "--spread", "x_x=0:1"), m.states)


def test_progress(model):
    shares = []
    fp3.solve_ivp(model("kepler"), (0, 125), objects=64, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1 and len(shares) > 2
    with pytest.raises(ZeroDivisionError):
        fp3.solve_ivp(model("kepler"), (0, 125), progress=lambda share: 1 / 0)


def test_threads_change_no_bit(model):
    y0 = {"v_y": np.linspace(1.5, 1.8, 3000)}
    assert np.array_equal(fp3.solve_ivp(model("kepler"), (0, 4), y0, threads=1).y, fp3.solve_ivp(model("kepler"), (0, 4), y0, threads=2).y)


def test_many_times(model, ran):
    """A snapshot after each step: as many parts as steps, and each may be as long as any."""
    solution = fp3.solve_ivp(model("kepler"), (0, 32), t_eval=np.arange(2049) / 64)
    same(solution, ran("kepler", "-e", "fast", "-c", "many_full", "-N", 1, "-n", 2048, "--every", 1), KEPLER)


@pytest.mark.parametrize("slope, k, h, told", [("k*x", 1, 1e-9, True), ("k*x", 1, 2**-6, False), ("k*x", 0, 1e-9, False), ("k*(1 - x)", 1, 2**-7, False)])
def test_a_state_that_stands_still_is_told_as_the_command_tells_it(fp3, tmp_path, slope, k, h, told):
    """h k is too small to change x; so it is near an equilibrium, where nothing is lost."""
    import fp3 as package
    path = tmp_path / "still.ode"
    path.write_text(f"param k = 1\nstate x = 1.00000012\nstep 0.125\nx' = {slope}\n")
    steps = 2**21 if h < 1e-6 or "1 - x" in slope else 64
    done = subprocess.run([fp3, "run", path, "-e", "fast", "-c", "many_full", "-N", "3", "-n", str(steps), "--set", f"k={k}", "--set", f"h={h!r}"],
                          capture_output=True, text=True, timeout=300)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        package.solve_ivp(path, (0, steps * h), params={"k": k}, h=h, objects=3)
    ours = [str(of.message) for of in said if of.category is package.DigitsWarning]
    assert ("stands still" in done.stderr) == told and len(ours) == told
    if told:
        begin = ours[0].partition("; use")[0]
        assert begin in done.stderr, (begin, done.stderr)


def test_a_state_that_is_named_like_a_field():
    solution = fp3.solve_ivp("state y = 1\nstate t_x = 2\nstep 0.125\ny' = -y\nt_x' = 0*y\n", (0, 1))
    assert np.array_equal(solution.state("y"), solution.y[0]) and solution["y"] is solution.y and np.array_equal(solution["t_x"], solution.y[1])
