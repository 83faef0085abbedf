"""What every test shares: where things are, and the closing line of `make test`."""

import os
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[1]


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


def pytest_make_parametrize_id(val):
    """A test's name stays a name, however long its input."""
    return ascii(val[:40])[1:-1] + "..." if isinstance(val, (str, bytes)) and len(val) > 60 else None


def pytest_unconfigure(config):
    """The last line of all, `N passed, N failed`; an error in a fixture or a file is a failure."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if hasattr(config, "workerinput") or reporter is None or config.option.collectonly:
        return
    count = {key: len(reporter.stats.get(key, ())) for key in ("passed", "failed", "error")}
    print(f"{count['passed']} passed, {count['failed'] + count['error']} failed", flush=True)
