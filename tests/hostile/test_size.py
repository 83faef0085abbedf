"""Scenes and groups of any size end soon: read in time and memory that grow with the file, or refused at once."""

import os
import subprocess

GROUP = '{ program = "none.s"; objects = 2; set = { m = 4.2e5; rm = "1/m"; T = 1.1e5; C = 1.9e4; v = 0.0; s = 0.0; }; }'


def cost(fp3, folder, text, message):
    """Seconds of the processor and bytes at most, of a scene that is refused with the message."""
    (folder / "x.scene").write_text(text)
    with subprocess.Popen([fp3, "run", "--engine", "isa", "--scene", "x.scene"], cwd=folder, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True) as started:
        error = started.stderr.read()
        _, status, usage = os.wait4(started.pid, 0)
        started.returncode = os.waitstatus_to_exitcode(status)
    assert started.returncode == 2 and message in error, error
    return usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def scene(groups):
    return 'config = "array";\ngroups = (\n' + ",\n".join(groups * [GROUP]) + ");\n"


def test_many_groups_are_refused_in_linear_time(fp3, tmp_path):
    def seconds(groups):
        return min(cost(fp3, tmp_path, scene(groups), f"x.scene:2: found {groups} groups")[0] for _ in range(3))

    assert seconds(40_000) < 15 * seconds(4_000)


def test_a_hundred_thousand_groups(fp3, tmp_path):
    seconds, size = cost(fp3, tmp_path, scene(100_000), "x.scene:2: found 100000 groups")
    assert seconds < 5 and size < 500e6


def test_a_million_objects_are_refused_at_once(fp3, tmp_path):
    text = scene(1).replace("objects = 2", "objects = 1000000")
    assert cost(fp3, tmp_path, text, "x.scene:3: objects: found 1000000, expected at most 512")[0] < 1


def test_many_lists_of_values(fp3, tmp_path):
    """A million numbers, and 1,000 names of one group."""
    text = 'config = "array";\ngroups = ({ program = "none.s"; objects = 2; spread = { T = [' + "1, " * 1_000_000 + "1]; }; });"
    assert cost(fp3, tmp_path, text, "none.s: cannot open")[0] < 5
    text = scene(1).replace("m = 4.2e5;", " ".join(f"p{i} = 1;" for i in range(1_000)))
    assert cost(fp3, tmp_path, text, "none.s: cannot open")[0] < 1
