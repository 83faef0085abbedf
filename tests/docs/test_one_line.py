"""The words that docs/one_line.md tells of a wave are those of the wave. (test_tutorials.py compares what its commands print.)"""

import re
import subprocess

PAGE = "docs/one_line.md"
SOLO = "replay.dut.u_fp3.g_one.u_solo."


def cycles(path):
    """Of each rising edge of the clock the values in front of it, by the signals' names; and the time."""
    keys, scope, values, before, out = {}, [], {}, {}, []
    for line in path.read_text().splitlines():
        word = line.split()
        if not word:
            continue
        if word[0] == "$scope":
            scope.append(word[2])
        elif word[0] == "$upscope":
            scope.pop()
        elif word[0] == "$var":
            keys[".".join([*scope, word[4]])] = word[3]
        elif word[0].startswith("#"):
            before, time = dict(values), int(word[0][1:])
        elif word[0][0] in "01xzb":
            key, value = (word[1], word[0][1:]) if word[0][0] == "b" else (word[0][1:], word[0][0])
            if key == keys.get("replay.clk") and value == "1" and values.get(key) == "0":
                out.append((time, {name: before.get(key, "x") for name, key in keys.items()}))
            values[key] = value
    return out


def test_the_table_is_that_of_the_wave(root, fp3, build, tmp_path):
    page = (root / PAGE).read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| `([\w.]+)` \| `([0-9a-f]{8})` \|", page, re.M)
    assert len(rows) >= 15
    for line in ([fp3, "compile", "programs/ship.ode", "-i", "euler", "-c", "single", "--image", tmp_path / "ship.fp3", "--params", tmp_path / "ship.cfg"],
                 [fp3, "run", tmp_path / "ship.fp3", "-c", "single", "--steps", "2", "--params", tmp_path / "ship.cfg", "--bus-log", tmp_path / "session"],
                 ["vvp", "-n", build / "icarus/replay_single.vvp", f"+session={tmp_path}/session", f"+waves={tmp_path}/wave.vcd"]):
        done = subprocess.run(line, cwd=root, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr
    wave = cycles(tmp_path / "wave.vcd")
    begins = [i for i, (_, at) in enumerate(wave) if at["replay.issue_valid"] == "1" and int(at["replay.issue_pc"], 2) == 0]
    assert len(begins) == 2
    assert f"at {wave[begins[1]][0] // 1000:,} ns in the wave" in page
    for cycle, signal, word in rows:
        at = wave[begins[1] + int(cycle)][1]
        name = ("replay." if signal.startswith(("issue", "retire")) else SOLO) + signal
        assert f"{int(at[name], 2):08x}" == word, (cycle, signal)
        if signal in ("issue_word", "retire_value"):
            assert at["replay." + signal.split("_")[0] + "_valid"] == "1", (cycle, signal)
