"""`make setup` and the checks before each target, on a machine that is only pretended.

The pretended machine has a PATH of its own: links to the plain commands the scripts need, and
commands written here that note how they were called.
"""

import os
import shutil
import subprocess

import pytest

PLAIN = "bash sh env dirname sed tr grep ls cat make awk find mkdir rm touch true nproc".split()


class Machine:
    def __init__(self, root, folder):
        self.root, self.bin, self.log = root, folder / "bin", folder / "log"
        self.bin.mkdir()
        self.log.write_text("")
        for name in PLAIN:
            (self.bin / name).symlink_to(shutil.which(name))

    def command(self, name, body=""):
        """A command that notes its call, then runs body."""
        path = self.bin / name
        path.write_text(f'#!/bin/sh\necho "{name} $*" >>"{self.log}"\n{body}\n')
        path.chmod(0o755)

    def run(self, *line, python="/nowhere/python3", timeout=60):
        environment = {"PATH": str(self.bin), "PYTHON": python, "LC_ALL": "C"}
        return subprocess.run([str(self.bin / "bash"), "-c", '"$@"', "bash", *line], cwd=self.root,
                              env=environment, capture_output=True, text=True, timeout=timeout,
                              stdin=subprocess.DEVNULL)

    def calls(self, name):
        return [call for call in self.log.read_text().splitlines() if call.startswith(name + " ")]


@pytest.fixture
def machine(root, tmp_path):
    return Machine(root, tmp_path)


def test_without_root_and_sudo_it_says_what_to_run(machine):
    machine.command("id", "echo 1000")
    machine.command("apt-get")
    done = machine.run("tools/setup.sh")
    assert done.returncode != 0
    assert "Neither root nor sudo" in done.stderr
    assert "apt-get install -y --no-install-recommends" in done.stderr and "verilator" in done.stderr
    assert machine.calls("apt-get") == []


def test_sudo_that_wants_a_password_is_not_asked(machine):
    machine.command("id", "echo 1000")
    machine.command("apt-get")
    machine.command("sudo", "exit 1")
    done = machine.run("tools/setup.sh")
    assert done.returncode != 0 and "Neither root nor sudo" in done.stderr
    assert machine.calls("sudo") == ["sudo -n true"] and machine.calls("apt-get") == []


@pytest.mark.parametrize("user", ["root", "sudo"])
def test_installs_without_a_question(machine, user):
    machine.command("id", "echo 0" if user == "root" else "echo 1000")
    machine.command("apt-get", f'echo "DEBIAN_FRONTEND=$DEBIAN_FRONTEND" >>"{machine.log}"')
    machine.command("sudo", 'shift; exec "$@"')
    done = machine.run("tools/setup.sh")
    update, install = machine.calls("apt-get")
    assert update == "apt-get update -qq"
    assert install.startswith("apt-get install -y -qq --no-install-recommends gcc g++ verilator")
    assert machine.log.read_text().splitlines().count("DEBIAN_FRONTEND=noninteractive") == 2
    assert bool(machine.calls("sudo")) == (user == "sudo")
    assert "verilator - " in done.stdout, "what is installed is printed, with its reason"
    # The pretended apt-get installed nothing, and that is noticed.
    assert done.returncode != 0 and "Still missing" in done.stderr


def test_without_apt_it_lists_the_packages(machine):
    machine.command("id", "echo 0")
    done = machine.run("tools/setup.sh")
    assert done.returncode != 0 and "no apt-get" in done.stderr and "libgsl-dev" in done.stderr


@pytest.mark.parametrize("target, lacks", [
    ("sim", ["verilator", "g++", "libgsl-dev", "zlib1g-dev"]),
    ("test", ["verilator", "iverilog", "python3-pytest"]),
    ("lint", ["cppcheck", "clang-format"]),
    ("prove", ["cadical"]),
])
def test_a_target_says_what_it_lacks_and_how_to_get_it(machine, tmp_path, target, lacks):
    done = machine.run("make", target, f"BUILD={tmp_path}/out", f"PYTHON=/nowhere/python3")
    assert done.returncode != 0
    assert f"make {target} needs what is not here:" in done.stderr
    for name in lacks:
        assert f"  {name} - " in done.stderr
    assert "Run: make setup\n" in done.stderr
    assert not list((tmp_path / "out").rglob("*.o")), "nothing is compiled first"


@pytest.mark.parametrize("target, setup, lacks", [("synth", "setup-fpga", "verilator"), ("sizes", "setup-fpga", "verilator"), ("soc", "setup-soc", "lld"), ("fuzz", "setup-fuzz", "clang"), ("packages", "setup-packages", "debhelper")])
def test_some_targets_point_to_their_own_setup(machine, target, setup, lacks):
    done = machine.run("tools/setup.sh", "--check", target)
    assert done.returncode != 0 and f"Run: make {setup}\n" in done.stderr and f"  {lacks} - " in done.stderr


@pytest.mark.parametrize("user, says", [("1000", "fresh.sh: a bare Debian is mounted and entered as root"), ("0", "  mmdebstrap - a bare Debian")])
def test_a_bare_debian_needs_root_and_mmdebstrap(machine, user, says):
    machine.command("id", f"echo {user}")
    done = machine.run("tools/fresh.sh")
    assert done.returncode == 1 and says in done.stderr and done.stdout == "", done.stderr


def test_a_bare_debian_gets_the_commands_of_readme(root, tmp_path):
    """What makes and enters it is pretended; the end of what runs there is the end of all. One that was cut off is made again."""
    tree = tmp_path / "tree"
    (tree / "tools").mkdir(parents=True)
    for name in ("README.md", "tools/fresh.sh", "tools/setup.sh"):
        shutil.copy(root / name, tree / name)
    machine = Machine(tree, tmp_path)
    for name in ("xargs", "tee", "cp", "mv"):
        (machine.bin / name).symlink_to(shutil.which(name))
    machine.command("id", "echo 0")
    machine.command("apt-config")
    machine.command("mmdebstrap", 'while [ "$1" != bookworm ]; do shift; done; mkdir -p "$2/etc" "$2/root" "$2/usr/local/share"')
    machine.command("git", f'[ "$1" != clone ] || {{ while [ $# -gt 1 ]; do shift; done; mkdir "$1"; [ -d "{tmp_path}/cut" ] || kill -9 $PPID; }}')
    machine.command("unshare", 'while [ "$1" != run ]; do shift; done; shift; for one; do echo "in it: $one"; done; exit 5')
    assert machine.run("tools/fresh.sh", "--root", str(tmp_path / "bare")).returncode == -9
    (tmp_path / "cut").mkdir()
    for _ in range(2):
        done = machine.run("tools/fresh.sh", "--root", str(tmp_path / "bare"))
        assert done.returncode == 5, done.stderr
    assert len(machine.calls("mmdebstrap")) == 2 and (tmp_path / "bare/root/fp3").is_dir() and not (tmp_path / "bare.tmp").exists()
    assert machine.run("tools/fresh.sh", "--root", str(tmp_path)).returncode == 1  # somebody's folder
    said = [line.removeprefix("in it: ").partition("#")[0].strip() for line in done.stdout.splitlines()]
    assert said == ["apt-get update && apt-get install -y git make", "make setup all", "build/fp3 run programs/ship.ode --steps 60", "make setup test"]
    assert (tree / "build/fresh.log").read_text() == done.stdout


@pytest.mark.parametrize("given, told", [([], "tools/fresh.sh "), (["ROOT=/x", "RUN=make waves"], 'tools/fresh.sh --root "/x" --command "make waves"')])
def test_make_fresh_hands_on_what_it_is_given(root, given, told):
    done = subprocess.run(["make", "-n", "fresh", *given], cwd=root, capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == told.strip(), done.stderr


def test_list_gives_each_package_a_reason(root):
    done = subprocess.run(["tools/setup.sh", "--list"], cwd=root, capture_output=True, text=True, timeout=60)
    rows = [line.split(": ", 1) for line in done.stdout.splitlines()]
    assert len(rows) > 10 and all(len(row) == 2 and len(row[1]) > 10 for row in rows)


def test_unknown_arguments_are_refused(root):
    for arguments in (["--chekc"], ["--check", "nothing"]):
        done = subprocess.run(["tools/setup.sh", *arguments], cwd=root, capture_output=True, timeout=60)
        assert done.returncode == 2, arguments


def test_the_table_of_packages_starts_no_command(root):
    text = (root / "tools/setup.sh").read_text()
    table = text[text.index('\npackages="'):text.index('\n"\n')]
    assert "libgsl-dev" in table and "`" not in table and "$(" not in table


def test_no_word_of_a_table_is_a_command(root):
    """The shell executes what stands in backticks within double quotes."""
    text = (root / "tools/setup.sh").read_text()
    tables = [part.split('\n"\n')[0] for part in text.split('="\n')[1:]]
    assert len(tables) >= 3
    assert [line for table in tables for line in table.splitlines() if "`" in line or "$(" in line] == []
