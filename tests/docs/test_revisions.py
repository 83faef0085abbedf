"""A page says of which revision its figures are: one of this history, so that a reader can go back to it."""

import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted(path for pattern in ("*.md", "docs/**/*.md", "tests/**/*.md") for path in ROOT.glob(pattern))
HASH = re.compile(r"`([0-9a-f]{7,12}|[0-9a-f]{40})(?:-dirty)?`|\brevisions? ([0-9a-f]{7,12})\b")


def revisions(text):
    """What stands as a revision in a paragraph that has that word."""
    return [found[1] or found[2] for part in text.split("\n\n") if re.search(r"\brevisions?\b", part) for found in HASH.finditer(part)]


@pytest.fixture(scope="module")
def history():
    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, timeout=60)

    if git("rev-parse", "--is-shallow-repository").stdout.strip() != "false":
        pytest.skip("needs the whole history")
    return git("rev-list", "HEAD").stdout.split()


def unknown(text, history):
    return [name for name in revisions(text) if not any(one.startswith(name) for one in history)]


def test_revisions_are_of_this_history(history):
    wrong = {path.relative_to(ROOT).as_posix(): names for path in PAGES if (names := unknown(path.read_text(encoding="utf-8"), history))}
    assert not wrong, "not in the history: measure again on a commit that is pushed, or say that the revision is gone"


def test_a_revision_that_is_not_there_is_seen(history):
    known = history[0][:8]
    text = f"Measured, revision `{known}`, `0123456`; speed `{known}-dirty`.\n\nrevision 0123abc: a hash `0123456`\n\nNo such word: `0123456`.\n"
    assert revisions(text) == [known, "0123456", known, "0123abc", "0123456"]
    assert unknown(text, history) == ["0123456", "0123abc", "0123456"]
