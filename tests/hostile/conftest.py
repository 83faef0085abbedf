"""What every table of hostile inputs shares: files, a command, and what the refusal must say."""

import re
import resource
import subprocess

import pytest

SECONDS = 20
BYTES = 4 << 30


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    resource.setrlimit(resource.RLIMIT_FSIZE, (BYTES, BYTES))


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def hostile(fp3, tmp_path):
    """hostile(files, arguments): writes the files (text or bytes by name) into an empty folder, and runs `fp3` there."""
    def start(files, arguments):
        for name, text in files.items():
            (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return subprocess.run([fp3, *arguments], cwd=tmp_path, capture_output=True, timeout=20 * SECONDS,
                              stdin=subprocess.DEVNULL, preexec_fn=limits)

    return start


@pytest.fixture
def refused(hostile, tmp_path):
    """refused(files, arguments, message): exit code 2, the message (a regular expression) and nothing else; no file is
    written, changed or lost."""
    def check(files, arguments, message, code=2):
        before = {}
        for name, text in files.items():
            (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        before = contents(tmp_path)
        done = hostile({}, arguments)
        error = done.stderr.decode(errors="replace")
        assert done.returncode == code, f"{done.returncode}: {done.stdout!r} {error}"
        assert re.search(message, error), error
        assert done.stdout == b"" and not re.search(r"[^\x20-\x7e\n\x80-\U0010ffff]", error), error
        assert contents(tmp_path) == before

    return check
