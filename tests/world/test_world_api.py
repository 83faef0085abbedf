"""Links and reaches from C: promises of fp3/batch.h and fp3/program.h, and the example of a cloth."""

import shutil
import subprocess


def test_promises_are_kept(root, build):
    done = subprocess.run([build / "tests/world_links", root / "programs/world"], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_the_cloth_of_the_examples(root, build, tmp_path):
    """In at most 35 lines: it hangs, the corner that was farthest from the two held ones below their middle and its own row as low."""
    assert len((root / "examples/cloth.c").read_text().splitlines()) <= 35
    shutil.copy(root / "programs/world/cloth.ode", tmp_path)
    library = build / "lib/libfp3.so.0"
    sanitize = ["-fsanitize=address,undefined"] if build.name == "build-san" else []
    subprocess.run(["gcc", "-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", *sanitize, f"-I{root}/sw/include", root / "examples/cloth.c", library,
                    f"-Wl,-rpath,{library.parent}", "-o", tmp_path / "cloth"], check=True)
    done = subprocess.run([tmp_path / "cloth"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    x, y, z = map(float, done.stdout.split())
    assert 0.6 < x < 1.2 and -1.7 < y < -1.0 and abs(z) < 0.3  # 23 springs of 0.05 m long, from held corners at x 0 and 1.15
