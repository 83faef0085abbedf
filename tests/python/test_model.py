"""fp3.Model: what a model has, and mistakes with their place."""

import pickle

import pytest

import fp3


def test_a_model_from_a_file(root):
    model = fp3.Model(root / "programs/kepler.ode")
    assert (model.name, model.states, model.params, model.shared) == ("kepler", ("v_x", "v_y", "r_x", "r_y"), ("mu",), ("mu",))
    assert model.step == 0.015625 and model.span == 12.5 and model.defaults["v_y"] == 3**0.5 and "energy" in model.invariants and not model.uses_time
    assert fp3.Model(root / "programs/duffing.ode").uses_time and fp3.Model(root / "programs/ship.ode").units["m"] == "kg"
    assert fp3.Model(str(root / "programs/kepler.ode")).states == model.states and "kepler" in repr(model)


def test_a_model_from_a_text():
    model = fp3.Model("param k = 2\nstate x = 1\nstep 0.125\nx' = -k*x\n", name="decay")
    assert model.states == ("x",) and model.text.startswith("param k")
    assert fp3.solve_ivp(model, (0, 1)).y[0, -1] == pytest.approx(0.1353, abs=1e-4)


@pytest.mark.parametrize("name", [None, "mine"])
def test_a_mistake_has_its_place(tmp_path, name):
    text = "state x = 1\nstep 0.125\nx' = -k*x\n"
    with pytest.raises(fp3.ProgramError) as said:
        fp3.Model(text, name=name)
    assert (said.value.file, said.value.line, said.value.column) == (name or "text", 3, 7) and "^" in said.value.report
    (tmp_path / "m.ode").write_text(text)
    with pytest.raises(ValueError) as said:
        fp3.solve_ivp(tmp_path / "m.ode", (0, 1))
    assert (said.value.file, said.value.line) == (str(tmp_path / "m.ode"), 3) and str(said.value).count("error:") == 1
    again = pickle.loads(pickle.dumps(said.value))
    assert type(again) is fp3.ProgramError and (again.line, again.text, str(again)) == (3, said.value.text, str(said.value))


def test_all_mistakes_are_in_the_message():
    with pytest.raises(fp3.ProgramError) as said:
        fp3.Model("state x = 1\nstate y = 1\nstep 0.125\nx' = -k*x\ny' = q\n")
    assert "'k'" in str(said.value) and "'q'" in str(said.value) and "\n" not in said.value.text


def test_what_does_not_fit_the_hardware_has_its_place():
    """The compiler's refusals, too, begin with the place."""
    model = fp3.Model("state x = 1\nstep 0.125\nx' = 1/(2 - x)\n")
    with pytest.raises(fp3.ProgramError, match="many"):
        fp3.solve_ivp(model, (0, 1), config="many", method="rodas3")


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(FileNotFoundError):
        fp3.Model(tmp_path / "none.ode")
    with pytest.raises(IsADirectoryError):
        fp3.Model(tmp_path)
    with pytest.raises(TypeError):
        fp3.Model(3)
    with pytest.raises(fp3.ArgumentError):
        fp3.Model("a\0b")


def test_bytes_that_are_no_text(tmp_path):
    (tmp_path / "m.ode").write_bytes(b"\x00\xff\xfe state")
    with pytest.raises(fp3.ProgramError) as said:
        fp3.Model(tmp_path / "m.ode")
    assert said.value.line == 1


def test_integrators_and_arithmetics(root):
    assert {"rk4", "cash_karp", "pefrl"} <= set(fp3.integrators())
    with pytest.raises(fp3.ArgumentError, match="plain, compensated, folded, double-single"):
        fp3.solve_ivp(root / "programs/kepler.ode", (0, 1), arithmetic="exact")
    with pytest.raises(fp3.ArgumentError, match="rk5"):
        fp3.solve_ivp(root / "programs/kepler.ode", (0, 1), method="rk5")


def test_a_table_of_ones_own_is_read_again(root, tmp_path):
    table = tmp_path / "mine.cfg"
    kepler = fp3.Model(root / "programs/kepler.ode")
    answers = []
    for name in ("rk4", "euler"):
        table.write_text((root / f"programs/integrators/{name}.cfg").read_text())
        answers.append(fp3.solve_ivp(kepler, (0, 1), method=str(table)).y[0, -1])
    assert answers[0] == fp3.solve_ivp(kepler, (0, 1), method="rk4").y[0, -1] != answers[1]


def test_a_pickled_model_is_the_same(root):
    model = pickle.loads(pickle.dumps(fp3.Model(root / "programs/kepler.ode")))
    assert model.states == ("v_x", "v_y", "r_x", "r_y") and fp3.solve_ivp(model, (0, 1)).success


def test_a_warning_of_the_compiler_is_a_warning(tmp_path):
    """A splitting of forces that depend on speeds."""
    text = "state v = 1\nstate x = 1\nstep 0.125\nv' = -x - v\nx' = v\n"
    with pytest.warns(RuntimeWarning, match="order"):
        fp3.solve_ivp(text, (0, 1), method="forest_ruth")
