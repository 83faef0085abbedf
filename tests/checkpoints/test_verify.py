"""fp3 verify: a part of a run again, on any engine, and whether its hashes agree."""

import os
import time

import h5py
import pytest


@pytest.fixture
def made(start, world, tmp_path):
    """A recording of steps 0, 10, .. 40, and checkpoints after 40 and 25."""
    start("run", *world("cloth"), "--steps", 40, "-e", "fast", "--every", 10, "--output", "r.h5", "--checkpoint", "a.ck", "--checkpoint-every", 25)
    return tmp_path


@pytest.mark.parametrize("options, told", [
    (("a.ck",), "a.ck: the hash of step 40 agrees, run again from step 25\n"),
    (("a.ck.1", "-e", "isa"), "a.ck.1: the hash of step 25 agrees, run again from step 0\n"),
    (("a.ck", "--from", 30), "a.ck: the hash of step 40 agrees, run again from step 0\n"),
    (("r.h5", "-e", "isa"), "r.h5: 5 hashes of steps 0 to 40 agree, run again from step 0\n"),
    (("r.h5", "--from", 10, "--to", 20, "--threads", 1), "r.h5: 2 hashes of steps 10 to 20 agree, run again from step 0\n"),
    (("r.h5", "--from", 26, "--restart", "a.ck.1", "-e", "isa"), "r.h5: 2 hashes of steps 30 to 40 agree, run again from step 25\n")])
def test_hashes_agree(start, made, options, told):
    names = sorted(path.name for path in made.iterdir())
    done = start("verify", *options)
    assert done.stdout == told and done.stderr == "" and sorted(path.name for path in made.iterdir()) == names


def test_on_ranks(start, made, ranks):
    assert "5 hashes" in start("verify", "r.h5", on=ranks[-1]).stdout


def test_a_hash_that_is_another(start, made):
    """Of one link that was changed the other parts of the run still agree, but for the one that follows it."""
    with h5py.File(made / "r.h5", "r+") as file:
        file["hash:chain"][2, 3] ^= 1
    assert "2 hashes" in start("verify", "r.h5", "--to", 10).stdout
    done = start("verify", "r.h5", code=1)
    assert done.stderr.startswith("fp3 verify: r.h5: after 20 steps its chain is ") and done.stdout == ""
    assert "after 30 steps" in start("verify", "r.h5", "--from", 30, code=1).stderr
    assert "the hash of step 40 agrees" in start("verify", "r.h5", "--from", 40).stdout


def test_another_program_makes_other_hashes(start, root, made):
    scene = (root / "programs/world/cloth.scene").read_text().replace('"cloth.ode"', f'"{root}/programs/world/cloth.ode"')
    (made / "same.scene").write_text(scene)
    (made / "other.scene").write_text(scene.replace("k = 10.0", "k = 10.001"))
    assert "5 hashes" in start("verify", "r.h5", "--source", "same.scene").stdout
    assert "after 10 steps" in start("verify", "r.h5", "--source", "other.scene", code=1).stderr
    assert "other links" in start("verify", "a.ck", "--source", "other.scene", code=2).stderr


def test_a_program_with_options(start, root, made):
    start("run", root / "programs/kepler.ode", "-c", "many_full", "-i", "verlet", "-N", 5, "--spread", "r_x=0.4:0.6", "-e", "rtl", "--bus-waits", 3, "-n", 12,
          "--every", 4, "--output", "k.h5", "--bus-log", "log")
    (made / "log").unlink()
    assert "4 hashes of steps 0 to 12" in start("verify", "k.h5", "-e", "fast").stdout
    assert "4 hashes of steps 0 to 12" in start("verify", "k.h5").stdout and not (made / "log").exists()


# ---- the command that a file keeps ----

@pytest.fixture
def keeps(start, root, tmp_path):
    """Gives the recording of a run another command, and verifies it."""
    start("run", root / "programs/kepler.ode", "-e", "isa", "-n", 8, "--every", 4, "--output", "k.h5")
    with h5py.File(tmp_path / "k.h5") as file:
        command = file.attrs["command"]

    def keeps(*words, options=(), code=0):
        with h5py.File(tmp_path / "k.h5", "r+") as file:
            file.attrs["command"] = "\n".join([str(root / "programs/kepler.ode"), *words] if words else [command])
        return start("verify", "k.h5", *options, code=code)
    return keeps


@pytest.mark.parametrize("words", ["--help", "--version", "--usage", "-?", "-V", "--HANG=5", "--he", "--us", "--v", "-eisa --help", "-k?", "--", "--nonesuch"])
def test_what_is_no_option_of_a_run_is_refused(keeps, words):
    """None of them ends the command before hashes are compared. Behind -- a word is a name."""
    done = keeps(*words.split(), *(["--help"] if words == "--" else []), code=2)
    assert done.stdout == "" and done.stderr.startswith("fp3"), done.stderr
    assert words in ("--", "-k?") or words.split()[-1].split("=")[0] in done.stderr, done.stderr


def test_no_port_is_opened(keeps, tmp_path):
    os.mkfifo(tmp_path / "port")
    for words in (("--engine", "board", "--port", "port"), ("-eboard", "--po=port"), ("-ke", "board", "--port=port", "--baud=9600")):
        assert "verify opens no port that a file names" in keeps(*words, code=2).stderr
    assert "3 hashes" in keeps("--engine", "board", "--port", "port", options=("-e", "isa")).stdout


def test_arguments_have_limits(keeps):
    for words in (["--set=h=1"] * 200000, ["x" * 200000]):
        before = time.monotonic()
        assert "more than 4096 arguments, or an argument of more than" in keeps(*words, code=2).stderr
        assert time.monotonic() - before < 10
    assert "more than 4096 arguments" in keeps("-" + "k" * 100000, code=2).stderr


def test_every_form_of_an_option_is_understood(keeps):
    for words in ((), ("-n8", "-eisa"), ("--eng=isa", "--ste", "8"), ("-e", "fast", "--threads=2", "--all", "--strict", "--check", "--clock", "5MHz"),
                  ("--out", "x.h5", "--every=3", "--compress", "--checkpoint", "x.ck", "--checkpoint-every", "5", "--restart=none", "--allow"),
                  ("--bus-log", "x", "--kan=y", "--native=z", "--bus-waits", "7", "--cycle-limit", "1", "--times", "1,2", "--observe", "r_x", "--plot", "p.svg")):
        assert "3 hashes of steps 0 to 8 agree" in keeps(*words).stdout, words
    assert "after 0 steps" in keeps("-N", "2", "-cmany_full", code=1).stderr
    assert "-o 2: found a number, expected a file: an fp3 in which -o was --objects" in keeps("-o", "2", "-cmany_full", code=2).stderr


def test_draws_are_those_of_the_seed_on_every_engine(start, root):
    start("run", root / "programs/kepler.ode", "-c", "many_half", "-N", 3, "--seed", 7, "-e", "fast", "-n", 8, "--output", "s.h5")
    assert "2 hashes" in start("verify", "s.h5", "-e", "isa").stdout


def test_what_cannot_be_compared(start, root, made):
    (made / "x.csv").write_text("step,object\n")
    start("run", root / "programs/kepler.ode", "--tolerance", "1e-5", "--times", "0.5,1", "-e", "fast", "--output", "t.h5")
    for options, told in ((("x.csv",), "x.csv: cannot read as HDF5"), (("nonesuch",), "No such file"), (("r.h5", "--from", 41), "steps 0 to 40"),
                          (("r.h5", "--from", 5, "--to", 3), "A not above B"), (("r.h5", "--restart", "a.ck"), "after 40 steps, and the first to compare is 0"),
                          (("t.h5",), "objects choose their own steps"), ((), "expected a checkpoint")):
        assert told in start("verify", *options, code=2).stderr, options
    with h5py.File(made / "r.h5", "r+") as file:
        del file["hash:chain"]
    assert "neither a checkpoint nor a recording with a chain" in start("verify", "r.h5", code=2).stderr
