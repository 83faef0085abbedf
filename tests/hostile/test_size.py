"""Scenes and groups of any size are read in memory that grows with the file, or refused. `make bench-check` measures their time."""

import os
import resource
import subprocess

GROUP = '{ program = "none.s"; objects = 2; set = { m = 4.2e5; rm = "1/m"; T = 1.1e5; C = 1.9e4; v = 0.0; s = 0.0; }; }'


def refused(fp3, folder, text, message):
    """A scene that is refused with the message, and does not hang; the most memory that it takes, in bytes."""
    (folder / "x.scene").write_text(text)
    with subprocess.Popen([fp3, "run", "--engine", "isa", "--scene", "x.scene"], cwd=folder, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (20, 20))) as started:
        error = started.stderr.read()
        _, status, usage = os.wait4(started.pid, 0)
        started.returncode = os.waitstatus_to_exitcode(status)
    assert started.returncode == 2 and message in error, error
    return 1024 * usage.ru_maxrss


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
