"""make cluster in its quick form: every part has its figures, and a wrong one ends it."""

import importlib
import json
import os
import subprocess
import sys
import types

import pytest

pytestmark = pytest.mark.xdist_group("cluster_tool")  # measured once, and its nodes have one name


@pytest.fixture(scope="module")
def tool(root):
    sys.path.insert(0, str(root / "tools"))
    yield importlib.import_module
    sys.path.remove(str(root / "tools"))


@pytest.fixture(scope="module")
def measured(mpirun, root, build, tmp_path_factory):
    path = tmp_path_factory.mktemp("tool") / "cluster.json"
    done = subprocess.run([sys.executable, root / "tools/cluster.py", "--quick", "--fp3", build / "bin/fp3", "--wire", build / "bench/wire", "--output", path],
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return json.loads(path.read_text())


def test_each_scene_has_one_hash(measured):
    rows = measured["hashes"]
    assert {row["scene"] for row in rows} == {"cloth", "balls", "stars", "sleep", "mixed"}
    for scene in {row["scene"] for row in rows}:
        same = [row for row in rows if row["scene"] == scene]
        assert {row["ranks"] for row in same} == {1, 2, 3} and len({row["hash"] for row in same}) == 1


def test_kills_end_well(measured):
    assert measured["kills"]["tried"] == measured["kills"]["right"] >= 3


def test_the_exchange_has_its_times(measured):
    rows = measured["exchange"]
    assert rows[0]["nodes"] == 1 and all(row["us_per_step"] > 0 and row["bytes_per_step"] == 1920 for row in rows)
    if measured["no_nodes"]:
        pytest.skip(measured["no_nodes"])
    near, far = (next(row for row in rows if row["nodes"] == 2 and row["delay_us"] == delay) for delay in (0, 200))
    assert far["us_per_step"] > 200 and far["round_trip_us"] > near["round_trip_us"] + 350


def test_bytes_are_those_of_guests(measured):
    assert [row["sent"] == row["needed"] for row in measured["ghosts"] if row["needed_is"] == "exact"] == [True, True]
    assert [len(row["memory_mb"]["2"]) for row in measured["million"]] == [2, 2]


def test_the_model_has_its_rows(measured):
    assert {row["ranks"] for row in measured["model"]} == {1, 2} and all(row["predicted"] > 0 and row["measured"] > 0 for row in measured["model"])


# ---- what is wrong is found ----

class Pretended:
    """A lab whose runs are numbers: of more than two ranks another hash."""
    quick = True
    folder = fp3 = None

    def scene(self, name, text):
        assert text
        return name

    def run(self, ranks, *_, **__):
        return types.SimpleNamespace(hash="one" if ranks < 3 else "another", times=1, bytes=2 * 300 * 12, seconds=1.0)


def test_another_hash_is_found(tool):
    with pytest.raises(tool("fp3cluster.lab").Failed, match="cloth has 2 hashes: .*fast on 3 another"):
        tool("cluster").hashes(Pretended(), print)


def test_other_bytes_are_found(tool):
    with pytest.raises(tool("fp3cluster.lab").Failed, match="2 ranks send 7200 bytes a step, and 3600 are needed"):
        list(tool("fp3cluster.costs").everybody(Pretended()))


def test_the_model_finds_its_constants(tool):
    model = tool("fp3cluster.model")
    constants = {"step_us": 3.0, "object_us": 0.02, "near_latency_us": 1.5, "near_us_per_byte": 1e-4, "far_latency_us": 40.0, "far_us_per_byte": 2e-3,
                 "switch_us": 9.0}
    rows = [{"side": side, "ranks": ranks, "nodes": nodes, "delay_us": 0, "bytes": 96.0 * side * (ranks - 1), "is_fitted": True}
            for side in (20, 64, 256) for ranks, nodes in ((1, 1), (2, 1), (4, 1), (8, 1), (2, 2))]
    for row in rows:
        row["measured"] = model.step(constants, row)
    assert model.fit(rows) == pytest.approx(constants, rel=1e-6)
    assert model.step(constants, rows[4] | {"delay_us": 200}) == pytest.approx(rows[4]["measured"] + 200)


def test_the_page_is_made_of_it(tool, measured, root):
    text = tool("fp3cluster.report").page((root / "docs/cluster_results.md").read_text(encoding="utf-8"), measured)
    assert f"| cloth | links | 8 | `{measured['hashes'][0]['hash'][:12]}` | – | 1, 2, 3 | – |\n" in text
    noisy = tool("fp3cluster.report").page(text, measured | {"constants": measured["constants"] | {"object_us": 0}})
    assert "cloth, 1,000,000, nodes" not in noisy and "cloth, 256 a board" in noisy
    with pytest.raises(SystemExit, match="the page has no <!-- kills -->"):
        tool("fp3cluster.report").page(text.replace("<!-- kills -->", ""), measured)


# ---- the wire ----

def test_the_wire_delays(tool, build):
    lab = tool("fp3cluster.lab")
    if why := lab.why_no_nodes(build / "bench/wire"):
        pytest.skip(why)
    with lab.two_nodes(build / "bench/wire", 3000):
        assert 6000 < lab.round_trip_us() < 9000
    assert not any(node in os.listdir("/run/netns") for node in lab.NODES)
