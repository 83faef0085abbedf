"""Links and reaches from C: promises of fp3/batch.h and fp3/program.h, and the example of a cloth."""

import re
import shutil
import subprocess


def test_promises_are_kept(root, build):
    done = subprocess.run([build / "tests/world_links", root / "programs/world"], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def compiled(root, build, tmp_path, name):
    library = build / "lib/libfp3.so.0"
    sanitize = ["-fsanitize=address,undefined"] if build.name == "build-san" else []
    subprocess.run(["gcc", "-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", *sanitize, f"-I{root}/sw/include", root / f"examples/{name}.c", library,
                    f"-Wl,-rpath,{library.parent}", "-o", tmp_path / name], check=True)
    done = subprocess.run([tmp_path / name], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_the_sparks_of_the_examples(root, build, tmp_path):
    """In at most 55 lines: balls are born and removed, and a knock is as loud as two springs of a ball that fell 2 m can be."""
    assert len((root / "examples/sparks.c").read_text().splitlines()) <= 55
    shutil.copy(root / "examples/sparks.ode", tmp_path)
    told = compiled(root, build, tmp_path, "sparks")
    knocks, loudest = re.match(r"(\d+) knocks, the loudest ([\d.]+) N; ball \d+ is [\d.]+ m away, ball \d+ [\d.]+ m ahead\n$", told).groups()
    assert 50 < int(knocks) < 500 and 5 < float(loudest) <= 0.2*400


def test_the_cloth_of_the_examples(root, build, tmp_path):
    """In at most 35 lines: it hangs, the corner that was farthest from the two held ones below their middle and its own row as low."""
    assert len((root / "examples/cloth.c").read_text().splitlines()) <= 35
    shutil.copy(root / "programs/world/cloth.ode", tmp_path)
    x, y, z = map(float, compiled(root, build, tmp_path, "cloth").split())
    assert 0.6 < x < 1.2 and -1.7 < y < -1.0 and abs(z) < 0.3  # 23 springs of 0.05 m long, from held corners at x 0 and 1.15
