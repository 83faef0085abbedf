"""What a figure depends on, each as a hash: the text of files, what probes say, versions of peers.

Comments and layout of Verilog, C and Python change no figure, so they are not in the hash; neither is the order of files.
"""

import functools
import hashlib
import importlib.metadata
import pathlib
import re
import subprocess

from fp3evidence import probes

ROOT = pathlib.Path(__file__).resolve().parents[2]
PEERS = ROOT / ".venv-bench/lib"
# A string, or a comment; a string is kept.
C = re.compile(r'("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\')|//[^\n]*|/\*.*?\*/', re.S)
SPACE = re.compile(r"(?<=[^\w\s\"'`#]) | (?=[^\w\s\"'`#])")     # beside an operator or a bracket
HASH = re.compile(r"^[ \t]*#.*$", re.M)         # a line of its own: elsewhere # may stand in a string
LIKE_C, LIKE_PYTHON = {".c", ".h", ".cpp", ".v", ".vh"}, {".py", ".toml", ".cfg", ".ode", ".s", ".scene"}


class Wrong(Exception):
    """An input that nothing answers to."""


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def kept(found):
    return found[1] or " "


def bare(name, text):
    """Without what changes nothing."""
    suffix = pathlib.PurePath(name).suffix
    if suffix in LIKE_C:
        # A line that begins with # or ` ends there; any other space is one space, and none beside a bracket or an operator.
        lines = (line.strip() for line in C.sub(kept, text.replace("\\\n", " ")).splitlines())
        text = "".join(f"\n{line}\n" if line[:1] in ("#", "`") else f" {line} " for line in lines if line)
        return SPACE.sub("", re.sub(r"[ \t]+", " ", re.sub(r"\s*\n\s*", "\n", text))).strip()
    if suffix in LIKE_PYTHON:
        return "\n".join(line.rstrip() for line in HASH.sub("", text).splitlines() if line.strip())
    return text


def of_texts(texts):
    """The hash of files: name and bare text of each."""
    return digest("".join(f"{name}\n{text}\n" for name, text in sorted(texts)))


@functools.cache
def bare_text(path):
    return bare(path.name, path.read_text(encoding="utf-8", errors="replace"))


@functools.cache
def matched(glob):
    found = [path for path in sorted(ROOT.glob(glob)) if path.is_file()]
    if not found:
        raise Wrong(f"no file is '{glob}'")
    return found


@functools.cache
def of_files(globs):
    """In this folder as it is now."""
    return of_texts((str(path.relative_to(ROOT)), bare_text(path)) for glob in globs for path in matched(glob))


@functools.cache
def of_probe(name, fp3):
    return probes.ask(name, fp3)


def forget():
    """What was read: it may have changed."""
    for cache in (bare_text, matched, of_files, of_probe, probes.made_of):
        cache.cache_clear()


def changed_files(globs, revision):
    """Yields their names, since a revision; none if it is not in the repository."""
    words = ["git", "diff", "--name-only", revision, "--", *(f":(glob){glob}" for glob in globs)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    yield from (name for name in (done.stdout.split() if done.returncode == 0 else ()) if not is_same(name, revision))


def is_same(name, revision):
    """But for its comments."""
    done = subprocess.run(["git", "show", f"{revision}:{name}"], cwd=ROOT, capture_output=True, text=True, errors="replace")
    return done.returncode == 0 and (ROOT / name).exists() and bare(name, done.stdout) == bare_text(ROOT / name)


@functools.cache
def version(peer):
    """Of a package beside which figures are measured; None where it is not installed."""
    folders = [str(path) for path in PEERS.glob("python3*/site-packages")]
    found = next(iter(importlib.metadata.distributions(name=peer, path=folders)), None)
    return found and found.version


def now(figure, fp3):
    """The hash of each input. None: there is nobody to ask here, so that it cannot be compared."""
    found = {}
    for name in figure.inputs:
        found[name] = of_probe(name, fp3) if name in probes.PROBES else of_files(figure.globs(name))
    return found | {name: version(name) for name in figure.peers}
