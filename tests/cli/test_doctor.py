"""fp3 doctor says what is missing, and how to get it; the shells complete what the command has."""

import os
import re
import shutil
import subprocess
import sys

import pytest


def doctor(fp3, **environment):
    done = subprocess.run([fp3, "doctor"], env={**os.environ, **environment}, capture_output=True, text=True, timeout=60)
    return done.returncode, dict(re.findall(r"^(\w+(?: \w+)?) +(.+)$", done.stdout, re.M))


def test_what_is_there_is_tried(fp3, build, tmp_path):
    code, found = doctor(fp3, FP3_CACHE_DIR=str(tmp_path), FP3_CC="gcc")
    assert found["engine fast"].startswith("native ") and found["C compiler"] == "gcc"
    held = re.fullmatch(r"(.+): 1 program, (\d+) kB", found["cache"])
    assert held[1] == str(tmp_path) and 1e3 * int(held[2]) == pytest.approx(sum(p.stat().st_size for p in tmp_path.rglob("*.so")), abs=1e3)
    total = re.fullmatch(r"(\d+) of (\d+) configurations", found["engine rtl"])
    assert total[1] == total[2] and int(total[1]) > 10 and found["HDF5"] == found["gnuplot"] == "yes"
    has_mpi = (build / "lib/fp3/fp3_mpi.so").exists()
    assert found["MPI"].startswith("yes" if has_mpi else "MISSING (")
    assert code == (0 if shutil.which("ffmpeg") and has_mpi else 1)


@pytest.mark.parametrize("name, environment, said", [
    ("C compiler", {"FP3_CC": "nonesuch"}, "no compiler 'nonesuch'"), ("engine fast", {"FP3_CC": "nonesuch"}, "interpreter"), ("C compiler", {"FP3_CC": "false"}, "'false' failed"),
    ("cache", {"FP3_CACHE_DIR": "/nonesuch/x"}, "/nonesuch/x: cannot be made"), ("engine rtl", {"FP3_RTL_DIR": "/nonesuch"}, "looked in /nonesuch"),
    ("HDF5", {"FP3_RTL_DIR": "/nonesuch"}, "fp3_hdf5.so"), ("MPI", {"FP3_RTL_DIR": "/nonesuch"}, "make setup-cluster all"), ("gnuplot", {"PATH": "/nonesuch"}, "gnuplot-nox"), ("ffmpeg", {"PATH": "/nonesuch"}, "Debian's package ffmpeg")])
def test_what_is_missing_is_named(fp3, tmp_path, name, environment, said):
    code, found = doctor(fp3, **{"FP3_CACHE_DIR": str(tmp_path), **environment})
    assert code == 1 and found[name].startswith("MISSING (") and said in found[name]


# ---- completion ----

@pytest.fixture(scope="module")
def written(root, build, tmp_path_factory):
    def written(shell):
        path = tmp_path_factory.mktemp("completion") / shell
        path.write_text(subprocess.run([sys.executable, root / "tools/completion.py", shell, build / "bin/fp3"], capture_output=True, text=True, check=True).stdout)
        return path
    return written


@pytest.mark.parametrize("line, expected", [
    (["fp3", "comp"], {"compile", "compare"}), (["fp3", "run", "--eng"], {"--engine="}), (["fp3", "run", "m.ode", "-c", "many"], {"many", "many_full", "many_half", "many_memory"}),
    (["fp3", "run", "--config", "=", "many_"], {"many_full", "many_half", "many_memory"}), (["fp3", "compare", "-i", "rk4_"], {"rk4_paper"}), (["fp3", "run", "-e", "f"], {"fast"}),
    (["fp3", "doctor", "--h"], {"--help"}), (["fp3", "run", "m."], set())])
def test_bash_completes(written, line, expected):
    script = f"source {written('bash')}; compopt() {{ :; }}; COMP_WORDS=({' '.join(line)}); COMP_CWORD={len(line) - 1}; _fp3; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-uc", script], capture_output=True, text=True, timeout=60)
    assert set(done.stdout.split()) == expected and not done.stderr


def test_zsh_reads_its_own(written):
    if not shutil.which("zsh"):
        pytest.skip("no zsh here")
    assert subprocess.run(["zsh", "-n", written("zsh")], capture_output=True, text=True, timeout=60).stderr == ""
