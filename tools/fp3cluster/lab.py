"""Runs of fp3 on ranks: by mpirun on this machine, or on two nodes that are network namespaces with a wire between them."""

import contextlib
import os
import re
import shutil
import subprocess
import sys

ROOT_TOO = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
NODES = {f"fp3-{os.getpid()}-a": "10.77.0.1", f"fp3-{os.getpid()}-b": "10.77.0.2"}
HERE, THERE = NODES
# mpirun is in the first node. Its agent starts what it wants on the other one, whose first argument is a host.
AGENT = f"""#!/bin/sh
shift
exec ip netns exec {THERE} unshare --uts sh -c "hostname {THERE}; $*"
"""


def environment(ranks, nodes=1):
    """Of mpirun, also for root. Ranks that wait leave the processor to others only where they share it: with each other, or with the wire."""
    return os.environ | ROOT_TOO | {"OMPI_MCA_mpi_yield_when_idle": str(int(ranks > os.cpu_count() or nodes > 1))}


class Failed(Exception):
    """A run that fails, or a figure that is wrong."""


class Said:
    """What a run printed."""

    def __init__(self, text):
        self.text = text
        self.hash = (re.findall(r"^hash +(\w{64})$", text, re.M) or [None])[0]
        self.seconds = float((re.findall(r"^time +(\S+) s", text, re.M) or ["nan"])[0])
        found = re.search(r"^exchange +(\S+) s of (\S+) s, (\d+) times, (\d+) bytes", text, re.M)
        self.exchange, self.times, self.bytes = (float(found[1]), int(found[3]), int(found[4])) if found else (0.0, 0, 0)
        if found:
            self.seconds = float(found[2])  # without the division of objects


class Lab:
    def __init__(self, fp3, folder, quick, is_first=False):
        """is_first: runs that are timed come before all other work of the machine."""
        self.fp3, self.folder, self.quick, self.is_first = fp3.resolve(), folder, quick, is_first
        if not shutil.which("mpirun") or not (self.fp3.parent.parent / "lib/fp3/fp3_mpi.so").exists():
            raise Failed("no mpirun, or no fp3_mpi.so: make setup-cluster all")
        version = subprocess.run(["mpirun", "--version"], capture_output=True, text=True).stdout
        self.is_open_mpi = "Open MPI" in version or "OpenRTE" in version
        self.agent = folder / "agent"
        self.agent.write_text(AGENT, encoding="utf-8")
        self.agent.chmod(0o755)

    def scene(self, name, text):
        path = self.folder / f"{name}.scene"
        path.write_text(text, encoding="utf-8")
        return path

    def words(self, ranks, *command, nodes=1):
        """The words that start a command."""
        command = [str(word) for word in command]
        if nodes == 2:
            hosts = f"{HERE}:{(ranks + 1) // 2},{NODES[THERE]}:{ranks // 2}"
            inside = ["mpirun", "--mca", "plm_rsh_agent", str(self.agent), "-H", hosts, "--mca", "pml", "ob1", "--mca", "btl", "tcp,vader,self",
                      "--mca", "btl_tcp_if_include", "wire", "--mca", "oob_tcp_if_include", "wire", "-n", str(ranks), *command]
            return ["ip", "netns", "exec", HERE, "unshare", "--uts", "sh", "-c", f"hostname {HERE}; exec \"$@\"", "sh", *inside]
        more = ["--oversubscribe"] if self.is_open_mpi else []
        return command if ranks == 1 else ["mpirun", *more, "-n", str(ranks), *command]

    def run(self, ranks, *options, nodes=1, is_timed=False, timeout=300):
        # Between nodes the kernel carries packets, too, and would wait for ranks that wait for it.
        first = ["chrt", "-r", "1"] if is_timed and self.is_first and nodes == 1 else []
        done = subprocess.run([*first, *self.words(ranks, self.fp3, "run", *options, nodes=nodes)], cwd=self.folder, env=environment(ranks, nodes), capture_output=True,
                              text=True, timeout=timeout)
        if done.returncode:
            raise Failed(f"{ranks} ranks, {' '.join(map(str, options))}: " + ((done.stderr.strip() or done.stdout).splitlines() or ["no word"])[0])
        return Said(done.stdout)


# ---- two nodes ----

def why_no_nodes(wire):
    """None: two nodes can be made here."""
    if os.geteuid() != 0:
        return "root alone makes network namespaces"
    if not os.path.exists("/dev/net/tun"):
        return "no /dev/net/tun"
    missing = [name for name in ("ip", "unshare", str(wire)) if not shutil.which(name)]
    return f"no {missing[0]}" if missing else None


@contextlib.contextmanager
def two_nodes(wire, delay_us):
    """Network namespaces, with a wire that delays each packet by this much."""
    def ip(*words):
        subprocess.run(["ip", *words], check=True, capture_output=True)
    carrier = None
    try:
        for node in NODES:
            ip("netns", "add", node)
        carrier = subprocess.Popen([str(wire), *NODES, str(delay_us)], stdout=subprocess.PIPE, text=True)
        if carrier.stdout.readline() != "ready\n":
            raise Failed("the wire does not begin")
        for node, address in NODES.items():
            ip("-n", node, "addr", "add", f"{address}/30", "dev", "wire")
            ip("-n", node, "link", "set", "wire", "up")
            ip("-n", node, "link", "set", "lo", "up")
        yield
    finally:
        if carrier:
            carrier.kill()
            carrier.wait()
        for node in NODES:
            subprocess.run(["ip", "netns", "del", node], capture_output=True)


ECHO = """import socket, sys, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
if sys.argv[1] == "serve":
    s.bind(("10.77.0.2", 7777))
    print("ready", flush=True)
    while True:
        s.sendto(*s.recvfrom(64))
s.settimeout(2)
found = []
for _ in range(200):
    begin = time.perf_counter()
    s.sendto(b"x", ("10.77.0.2", 7777))
    s.recvfrom(64)
    found.append(time.perf_counter() - begin)
print(min(found))
"""


def round_trip_us():
    """The shortest of 200 packets there and back between two nodes."""
    server = subprocess.Popen(["ip", "netns", "exec", THERE, sys.executable, "-c", ECHO, "serve"], stdout=subprocess.PIPE, text=True)
    try:
        server.stdout.readline()
        ask = ["ip", "netns", "exec", HERE, sys.executable, "-c", ECHO, "ask"]
        return 1e6 * float(subprocess.run(ask, capture_output=True, text=True, timeout=30, check=True).stdout)
    finally:
        server.kill()
        server.wait()
