"""The synthesised netlist gives the bits and the cycles of the source: a recorded session, replayed on both."""

import subprocess


def test_the_netlist_agrees_with_verilator(root, fp3, build, tmp_path):
    image, session, bench = tmp_path / "x.fp3", tmp_path / "x.session", build / "netlist/single.vvp"
    subprocess.run([root / "tools/netlist.sh", "single", bench], cwd=root, check=True)
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", image], check=True)
    subprocess.run([fp3, "run", image, "-c", "single", "--steps", "3", "--params", root / "programs/ship.cfg",
                    "--bus-log", session], check=True, capture_output=True)
    done = subprocess.run(["vvp", "-n", bench, f"+session={session}"], capture_output=True, text=True)
    assert done.returncode == 0 and "PASS" in done.stdout, done.stdout
