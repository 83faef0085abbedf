"""What every test shares: where things are, and the closing line of `make test`."""

import collections
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[1]
# With SAN=1 what is lost in a library is no failure.
os.environ.setdefault("LSAN_OPTIONS", f"suppressions={ROOT / 'tests/leaks.txt'}:print_suppressions=0")
# Tests are compiled once, not in each process that runs some; the tools and tests that they start as programs write nothing.
sys.dont_write_bytecode, sys.pycache_prefix = False, str(pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build")) / "pycache")
# Where the tests run in the background, or under nohup, these are ignored. Programs that they start would ignore them, too; a handler is no
# handler there.
for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):
    if signal.getsignal(number) == signal.SIG_IGN:
        signal.signal(number, signal.default_int_handler)


def pytest_addoption(parser):
    parser.addoption("--long", action="store_true", help="everything at its full length, an hour or so: tests/README.md")


# What takes longest begins first, or one processor would wait at the end for another one's.
FIRST = ("docs/test_evidence.py", "world/test_world_tool.py", "replay/test_netlist.py", "lint/test_lint.py::test_this_tree_is_clean", "formal/test_prove.py", "docs/test_tutorials.py",
         "cluster/test_cluster_tool.py", "bench/test_bench.py", "cluster/test_ranks.py", "tune/", "fpga/test_ecp5.py", "fast/test_fast.py::test_random")


def pytest_collection_modifyitems(config, items):
    """What only runs with --long is left out without it."""
    items.sort(key=lambda item: not item.nodeid.startswith(FIRST))
    if not config.getoption("--long"):
        out = [item for item in items if item.get_closest_marker("long")]
        items[:] = [item for item in items if item not in out]
        config.hook.pytest_deselected(items=out)


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Remembers what failed, for `tmp_path`."""
    report = (yield).get_result()
    item.fp3_failed = getattr(item, "fp3_failed", False) or report.failed


@pytest.fixture
def tmp_path(tmp_path, request):
    """A directory of the test's own. It is emptied after a test that passes: all of a run together are 100,000 files, and pytest keeps three runs.
    It stays there, so that no other test has one of the same name."""
    yield tmp_path
    if not getattr(request.node, "fp3_failed", False):
        shutil.rmtree(tmp_path, ignore_errors=True)
        tmp_path.mkdir(exist_ok=True)


@pytest.fixture(scope="session")
def long(request):
    """Whether tests run at their full length."""
    return request.config.getoption("--long")


@pytest.fixture(scope="session")
def root():
    """The project's directory."""
    return ROOT


@pytest.fixture(scope="session")
def build():
    """The directory of what `make` has built: build/, or build-san/ with SAN=1."""
    return pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))


@pytest.fixture(scope="session")
def fp3(build):
    """The command."""
    return build / "fp3"


FAST_CLOCK = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <poll.h>
#include <time.h>
int poll(struct pollfd *files, nfds_t count, int timeout) {
    int (*next)(struct pollfd *, nfds_t, int) = (int (*)(struct pollfd *, nfds_t, int))dlsym(RTLD_NEXT, "poll");
    return next(files, count, timeout > 0 ? (timeout + 199) / 200 : timeout);
}
int nanosleep(const struct timespec *time, struct timespec *left) {
    int (*next)(const struct timespec *, struct timespec *) = (int (*)(const struct timespec *, struct timespec *))dlsym(RTLD_NEXT, "nanosleep");
    const struct timespec part = {time->tv_sec / 200, (time->tv_sec % 200 * 1000000000 + time->tv_nsec) / 200};
    return next(&part, left);
}
int clock_gettime(clockid_t id, struct timespec *time) {
    int (*next)(clockid_t, struct timespec *) = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
    const int failed = next(id, time);
    time->tv_sec *= 200;
    time->tv_sec += time->tv_nsec / 5000000;
    time->tv_nsec = time->tv_nsec % 5000000 * 200;
    return failed;
}
"""


@pytest.fixture
def fast_clock(tmp_path_factory):
    """An environment with a clock that runs 200 times as fast, and with it poll and nanosleep, so that two minutes are over in a moment."""
    library = tmp_path_factory.mktemp("clock") / "clock.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-x", "c", "-", "-o", library, "-ldl"], input=FAST_CLOCK, text=True, check=True)
    return {"LD_PRELOAD": str(library)}


def pytest_make_parametrize_id(val):
    """A test's name stays a name, however long its input."""
    return ascii(val[:40])[1:-1] + "..." if isinstance(val, (str, bytes)) and len(val) > 60 else None


def wanted(reasons):
    """What would run skipped tests: each `make setup-…` that the reasons name, with how many name it; and how many name none."""
    found = [re.findall(r"\bsetup(?:-\w+)?\b", " ".join(re.findall(r"\bmake ([\w -]+)", reason))) for reason in reasons]
    count = collections.Counter(setup for setups in found for setup in set(setups))
    parts = [f"make {setup} ({count[setup]})" for setup in sorted(count)] + [f"other reasons ({found.count([])})"] * ([] in found)
    return f"{len(reasons)} skipped, with their reasons above: " + ", ".join(parts)


def pytest_unconfigure(config):
    """The last lines: what was skipped, and `N passed, N failed`; an error in a fixture or a file is a failure."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if hasattr(config, "workerinput") or reporter is None or config.option.collectonly:
        return
    skipped = [report.longrepr[2] for report in reporter.stats.get("skipped", ())]
    if skipped:
        print(wanted(skipped))
    count = {key: len(reporter.stats.get(key, ())) for key in ("passed", "failed", "error")}
    print(f"{count['passed']} passed, {count['failed'] + count['error']} failed", flush=True)
