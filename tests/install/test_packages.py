"""`make packages` as users get it: the .deb files and the wheel, where no file of the project is in sight.

They are installed over this machine's files, in a layer that is thrown away; with --long also in an empty Debian, which has nothing
but what they ask for.
"""

import io
import os
import pathlib
import re
import shutil
import subprocess
import tarfile
import zipfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMES = {"fp3", "libfp3-0", "libfp3-plugins", "libfp3-dev", "python3-fp3"}
KEPLER = "/usr/share/doc/fp3/examples/kepler.ode"
PYTHON_RUN = f"""
import fp3, numpy
print(fp3.__file__)
for how in ({{"engine": "fast", "config": "many_full"}}, {{"engine": "rtl", "config": "single_full"}}):
    print(*(f"{{word:#010x}}" for word in fp3.solve_ivp("{KEPLER}", (0, 1), **how).y[:, -1].astype(numpy.float32).view(numpy.uint32)))
"""


def lacking():
    done = subprocess.run(["tools/setup.sh", "--check", "packages"], cwd=ROOT, capture_output=True, text=True, timeout=60)
    return re.findall(r"^  (\S+) - ", done.stderr, re.M)


LACKING = lacking()
# They are built in the directory of make install.
pytestmark = [pytest.mark.xdist_group("install"), pytest.mark.skipif(bool(LACKING), reason=f"make setup-packages installs {', '.join(LACKING)}")]


def succeeds(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=3600, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def clean(**more):
    """Without the variables of the make that started the tests."""
    return {**{key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "FP3_BUILD")}, **more}


def listed(folder):
    """{name: file}: a Debian package by its name, others as "wheel" and "sources"."""
    return {{".whl": "wheel", ".gz": "sources"}.get(path.suffix) or path.name.split("_")[0]: path for path in folder.iterdir()}


@pytest.fixture(scope="module")
def packages(root, build):
    if build != root / "build":
        pytest.skip("packages are of the plain build")
    succeeds("make", "-C", root, "packages", env=clean())
    made = listed(build / "packages")
    assert set(made) == NAMES | {"wheel", "sources"} and len(list((build / "packages").iterdir())) == len(made)
    return made


@pytest.fixture(scope="module")
def epoch(root):
    return int(os.environ.get("SOURCE_DATE_EPOCH") or succeeds("git", "log", "-1", "--format=%ct", cwd=root))


# ---- the files --------------------------------------------------------------------------------------

def test_lintian_finds_nothing(packages):
    done = subprocess.run(["lintian", "--allow-root", "--fail-on", "error,warning", *(packages[name] for name in NAMES)],
                          capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout


def test_what_is_needed_to_build_is_what_setup_installs(root):
    """Besides the compilers of C, which every Debian that builds packages has."""
    control = (root / "tools/debian/control").read_text()
    needed = {word.split(" ")[0] for word in re.split(r",\s*", re.search(r"^Build-Depends: (.*(?:\n .*)*)", control, re.M)[1])}
    rows = re.findall(r"^(\S+) *\|[^|]*\| (\S+) *\|", (root / "tools/setup.sh").read_text(), re.M)
    assert {name for name, group in rows if group == "sim"} <= needed
    assert needed - {"debhelper-compat"} <= {name for name, group in rows if group in ("sim", "packages")}


def test_each_package_has_the_version_of_the_headers(packages, root):
    version = re.search(r'FP3_VERSION "(.*)"', (root / "sw/include/fp3/status.h").read_text())[1]
    assert packages["wheel"].name.startswith(f"fp3-{version}-py3-none-manylinux_")
    for name in NAMES:
        assert succeeds("dpkg-deb", "--field", packages[name], "Version").split("-")[0] == version


def test_dates_are_those_of_the_sources(packages, epoch):
    """So a second build writes the same ones."""
    for name in NAMES:
        data = subprocess.run(["dpkg-deb", "--fsys-tarfile", packages[name]], capture_output=True, check=True, timeout=60).stdout
        assert {member.mtime for member in tarfile.open(fileobj=io.BytesIO(data))} == {epoch}, name
    assert {member.mtime for member in tarfile.open(packages["sources"])} == {epoch}
    assert len({member.date_time for member in zipfile.ZipFile(packages["wheel"]).infolist()}) == 1


def test_the_wheel_carries_what_it_is_linked_with_and_its_licences(packages):
    names = zipfile.ZipFile(packages["wheel"]).namelist()
    carried = {re.match(r"fp3\.libs/(\w+)-", name)[1] for name in names if name.startswith("fp3.libs/")}
    licences = {pathlib.PurePath(name).name.rstrip("0123456789") for name in names if "/licenses/" in name}
    assert carried == licences == {"libgsl", "libgslcblas", "libconfig", "libjansson"}


@pytest.mark.long
def test_its_sources_make_the_same_bytes(packages, root, epoch, tmp_path):
    """The source distribution, in another directory: all is compiled again."""
    succeeds("tar", "xf", packages["sources"], "-C", tmp_path)
    tree, = tmp_path.iterdir()
    (tree / "PKG-INFO").unlink()
    succeeds("git", "init", "-q", cwd=tree)
    succeeds("git", "add", "-A", cwd=tree)
    (tree / ".venv").symlink_to(root / ".venv")
    succeeds("make", "-C", tree, "packages", env=clean(SOURCE_DATE_EPOCH=str(epoch), CCACHE_DISABLE="1"))
    again = listed(tree / "build/packages")
    assert set(again) == set(packages)
    assert [name for name in again if again[name].read_bytes() != packages[name].read_bytes()] == []


@pytest.mark.parametrize("lacks, says", [(["git"], "a git checkout"), (["dpkg-buildpackage"], "dpkg-buildpackage"), (["pip"], "No module named pip")])
def test_a_failure_leaves_no_package(root, tmp_path, lacks, says):
    tools = tmp_path / "bin"
    tools.mkdir()
    for name in lacks:
        (tools / name).write_text(f'#!/bin/sh\necho "{name}: No module named {name}" >&2\nexit 1\n')
        (tools / name).chmod(0o755)
    if lacks == ["pip"]:
        (tools / "dpkg-buildpackage").write_text("#!/bin/sh\ntouch ../x.deb\n")
        (tools / "dpkg-buildpackage").chmod(0o755)
    done = subprocess.run([root / "tools/packages.sh", tmp_path / "out"], capture_output=True, text=True, timeout=60,
                          env=clean(PATH=f"{tools}:{os.environ['PATH']}", PYTHON=str(tools / "pip")))
    assert done.returncode == 1 and says in done.stderr, done.stderr
    assert [path for path in (tmp_path / "out").glob("*.*")] == []


# ---- installed --------------------------------------------------------------------------------------

class Place:
    """A Debian of its own: mounts that end with the process that holds them. /srv is the folder of the packages."""

    def __init__(self, mounts, top, shared):
        self.top = top
        mounts += ["mount --bind {shared} {top}/srv", "mount --rbind /proc {top}/proc", "mount --rbind /dev {top}/dev", "echo ready", "cat"]
        script = "\n".join(["set -e", *mounts]).format(top=top, shared=shared, over=top.parent, root=ROOT)
        self.holder = subprocess.Popen(["unshare", "--mount", "bash", "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
        if self.holder.stdout.readline() != "ready\n":
            pytest.skip(f"an installation needs a layer over this machine's files, as root: {self.holder.communicate()[1].strip()}")

    def run(self, command):
        return succeeds("nsenter", f"--mount=/proc/{self.holder.pid}/ns/mnt", "chroot", self.top, "env", "-i", "HOME=/root", "LC_ALL=C.UTF-8",
                        "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND=noninteractive", "sh", "-ec", f"cd /root\n{command}", cwd="/")

    def files(self):
        return set(self.run("find /usr /var /etc -path '*fp3*'").split())

    def close(self):
        self.holder.communicate()


class Layer(Place):
    """This machine, without the project and without what `make install` may have put there."""

    def __init__(self, folder, shared):
        super().__init__(["mount -t tmpfs none {over}", "mkdir {over}/up {over}/work {top}",
                          "mount -t overlay none -o lowerdir=/,upperdir={over}/up,workdir={over}/work {top}",
                          "mount -t tmpfs none {top}/usr/local", "mkdir -p {top}{root}", "mount -t tmpfs none {top}{root}"], folder / "top", shared)

    def install(self):
        self.run("dpkg --path-include '/usr/share/*' -i /srv/*.deb")


class Empty(Place):
    """A Debian with nothing but Python, a compiler and man, by the sources of this one."""

    def __init__(self, folder, shared):
        sources = [path for path in [pathlib.Path("/etc/apt/sources.list"), *pathlib.Path("/etc/apt/sources.list.d").glob("*")]
                   if path.is_file() and "/debian" in path.read_text()]
        release = re.search(r"^VERSION_CODENAME=(\w+)", pathlib.Path("/etc/os-release").read_text(), re.M)[1]
        succeeds("mmdebstrap", "--variant=apt", "--include=ca-certificates,gcc,libc6-dev,man-db,pkg-config,python3-numpy,python3-venv", release,
                 folder / "top", *sources)
        shutil.copy("/etc/resolv.conf", folder / "top/etc")
        super().__init__([], folder / "top", shared)
        assert "libgsl" not in self.run("/sbin/ldconfig -p")

    def install(self):
        self.run("apt-get update && apt-get install -y --no-install-recommends /srv/*.deb")


@pytest.fixture(scope="module", params=[Layer, pytest.param(Empty, marks=pytest.mark.long)])
def place(request, packages, root, tmp_path_factory):
    shared = tmp_path_factory.mktemp("shared")
    for file in (*packages.values(), root / "tests/install/ship.c", root / "programs/kepler.ode"):
        shutil.copy(file, shared)
    place = request.param(tmp_path_factory.mktemp("place"), shared)
    yield place
    place.close()


@pytest.fixture(scope="module")
def expected(fp3, root):
    """The words of Kepler's states after t = 1, by the command of the tree."""
    out = succeeds(fp3, "run", root / "programs/kepler.ode", "-n", 64, "-e", "isa")
    return re.findall(r"^[vr]_[xy] .*(0x\w{8})", out, re.M)


def test_the_wheel_runs_in_an_empty_environment(place, expected):
    """Before any package is installed."""
    assert place.files() == set() or "fp3" not in place.run("ls /usr/bin")
    place.run("python3 -m venv --system-site-packages own && own/bin/pip install --quiet --no-index --no-deps /srv/*.whl")
    where, *words = place.run(f"own/bin/python - <<'END'{PYTHON_RUN.replace(KEPLER, '/srv/kepler.ode')}END").splitlines()
    assert where.startswith("/root/own/") and words == [" ".join(expected)] * 2
    native = f"{os.path.dirname(where)}/_native"
    for binary, carried in (("lib/libfp3.so.0", {"config"}), ("bin/fp3", {"gsl", "gslcblas", "config", "jansson"})):
        found = place.run(f"ldd {native}/{binary}")
        assert set(re.findall(r"/fp3\.libs/lib(gsl|gslcblas|config|jansson)-", found)) == carried and "not found" not in found, found
    told = place.run(f"{native}/bin/fp3 run /srv/kepler.ode -n 8 --every 4 --output kepler.h5 2>&1 || echo refused")
    assert ("libhdf5" in place.run("/sbin/ldconfig -p")) != ("libhdf5_serial.so" in told and "refused" in told), told


@pytest.fixture(scope="module")
def installed(place):
    place.run("rm -rf own")
    place.before = place.files()
    place.install()
    return place


def test_the_command_runs_with_all_that_it_loads(installed, expected):
    for engine in ("isa", "fast", "rtl"):
        out = installed.run(f"fp3 run {KEPLER} --steps 64 --config many_full --objects 1 --engine {engine}")
        assert re.findall(r"^[vr]_[xy] .*(0x\w{8})", out, re.M) == expected, engine
    installed.run(f"fp3 run {KEPLER} --steps 64 --every 8 --output kepler.h5 && fp3 view kepler.h5 && test -s kepler.html")
    installed.run("cp -r /usr/share/doc/fp3/examples own && cd own && fp3 run --scene mixed.scene")


def test_man_shows_the_page(installed):
    page = installed.run("MANWIDTH=120 man fp3")
    assert "--integrator" in page and "fp3 run" in page


@pytest.mark.parametrize("how", ["$(pkg-config --cflags --libs fp3)", "$(pkg-config --static --cflags --libs fp3 | sed s/-lfp3/-l:libfp3.a/)"])
def test_a_program_in_c_is_built_and_runs(installed, how, root, fp3):
    out = succeeds(fp3, "run", root / "programs/ship.ode", "-n", 100, "-e", "isa")
    states = [re.search(rf"^{name} +(\S+)", out, re.M)[1] for name in "sv"]
    installed.run(f"cc -Wall -Wextra -Werror -o ship /srv/ship.c {how}")
    assert ("libfp3.so.0" in installed.run("ldd ship")) != ("--static" in how)
    for engine in ("isa", "rtl"):
        assert installed.run(f"./ship /usr/share/doc/fp3/examples/ship.ode {engine}").split() == ["s", states[0], "v", states[1]]


def test_the_example_of_the_headers_runs(installed):
    installed.run("cp /usr/share/doc/libfp3-dev/examples/* . && cc -o game_loop game_loop.c $(pkg-config --cflags --libs fp3) && ./game_loop")


def test_python_has_the_package(installed, expected):
    where, *words = installed.run(f"/usr/bin/python3 - <<'END'{PYTHON_RUN}END").splitlines()
    assert where.startswith("/usr/lib/python3/dist-packages/") and words == [" ".join(expected)] * 2
    assert installed.run("/usr/bin/python3 -c 'import importlib.metadata; print(importlib.metadata.version(\"fp3\"))'").strip()
    assert "True" in installed.run(f"/usr/bin/python3 -c 'import fp3; print(len(fp3.tune(\"{KEPLER}\", 1e-2).rows) > 1)'")


def test_removed_nothing_is_left(installed):
    assert len(installed.files() - installed.before) > 100
    installed.run(f"dpkg --purge {' '.join(sorted(NAMES))}")
    assert installed.files() - installed.before == set()
