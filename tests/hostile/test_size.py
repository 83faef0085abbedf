"""Scenes and groups of any size are read in memory that grows with the file, or refused. `make bench-check` measures their time."""

import peak

GROUP = '{ program = "none.s"; objects = 2; set = { m = 4.2e5; rm = "1/m"; T = 1.1e5; C = 1.9e4; v = 0.0; s = 0.0; }; }'



def refused(fp3, folder, text, message):
    """A scene that is refused with the message, and does not hang; the most memory that it takes, in bytes."""
    (folder / "x.scene").write_text(text)
    done, most = peak.run([fp3, "run", "--engine", "isa", "--scene", "x.scene"], cwd=folder)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    return most


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
