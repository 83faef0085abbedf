"""Scenes and groups of any size are read in memory that grows with the file, or refused. `make bench-check` measures their time."""

import subprocess
import sys

GROUP = '{ program = "none.s"; objects = 2; set = { m = 4.2e5; rm = "1/m"; T = 1.1e5; C = 1.9e4; v = 0.0; s = 0.0; }; }'


# A process's peak begins with that of the one that it was forked from: here a small one.
MEASURE = """import resource, subprocess, sys
resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)"""


def refused(fp3, folder, text, message):
    """A scene that is refused with the message, and does not hang; the most memory that it takes, in bytes."""
    (folder / "x.scene").write_text(text)
    done = subprocess.run([sys.executable, "-c", MEASURE, fp3, "run", "--engine", "isa", "--scene", "x.scene"], cwd=folder,
                          capture_output=True, text=True)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    return 1024 * int(done.stdout)


def scene(groups):
    return 'config = "array";\ngroups = (\n' + ",\n".join(groups * [GROUP]) + ");\n"


def test_a_hundred_thousand_groups(fp3, tmp_path):
    assert refused(fp3, tmp_path, scene(100_000), "x.scene:2: found 100000 groups") < 500e6


def test_a_million_objects(fp3, tmp_path):
    text = scene(1).replace("objects = 2", "objects = 1000000")
    assert refused(fp3, tmp_path, text, "x.scene:3: objects: found 1000000, expected at most 512") < 100e6


def test_many_lists_of_values(fp3, tmp_path):
    """A million numbers, and 1,000 names of one group."""
    text = 'config = "array";\ngroups = ({ program = "none.s"; objects = 2; spread = { T = [' + "1, " * 1_000_000 + "1]; }; });"
    refused(fp3, tmp_path, text, "none.s: cannot open")
    text = scene(1).replace("m = 4.2e5;", " ".join(f"p{i} = 1;" for i in range(1_000)))
    refused(fp3, tmp_path, text, "none.s: cannot open")
