#!/usr/bin/env python3
"""Draws docs/drawings/*.svg from the text beside them: graphs (.dot, by Graphviz), pictures with places (.pikchr, by the pikchr in
Fossil) and waves (.wave, WaveDrom's JSON with lines of comments).

    tools/draw.py              draws what is stale
    tools/draw.py --check      draws nothing; fails and names each drawing that is stale. Needs none of the tools
    tools/draw.py --again DIR  draws all into a folder

Numbers and names in a source come from the project: tools/fp3draw/facts.py. A drawing begins with a hash of its source with these, and
of what draws it, so it is stale when any of them has changed. `make setup-docs` installs the tools.
"""

import argparse
import hashlib
import pathlib
import re
import subprocess
import sys

sys.dont_write_bytecode = True

from fp3draw.facts import Facts, Wrong
from fp3draw.svg import themed

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDER = "docs/drawings"
WAVEDROM = "import sys, wavedrom; sys.stdout.write(wavedrom.render(sys.stdin.read()).tostring())"
FONT, FONT_FILE = "DejaVu Sans", pathlib.Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
LOOK = ["-Gbgcolor=transparent", "-Gnodesep=0.25", "-Granksep=0.4", *[f"-{part}fontname={FONT}" for part in "GNE"], "-Gfontsize=13", "-Nfontsize=13",
        "-Efontsize=12", "-Nshape=box", "-Nstyle=rounded,filled", "-Nfillcolor=#e6e6e6", "-Nmargin=0.14,0.06", "-Nheight=0.4", "-Earrowsize=0.7"]
# Of each kind of source: its tool, how the tool tells its version, and the version that drew what is in the tree.
TOOLS = {".dot": (["dot", "-Tsvg", *LOOK], ["dot", "-V"], "graphviz version 2.43.0 (0)"),
         ".pikchr": (["fossil", "pikchr", "-", "-"], ["fossil", "version"], "fossil version 2.21 [3c53b6364e] 2023-02-26 19:24:24 UTC"),
         ".wave": ([".venv/bin/python", "-c", WAVEDROM], [".venv/bin/python", "-c", "from wavedrom.version import version; print('wavedrom', version)"],
                   "wavedrom 2.0.3.post3")}
PIKCHR = "charwid = 0.074; charht = 0.125; fontscale = 1; linewid = 0.4; thickness = 0.009; arrowht = 0.06; arrowwid = 0.045; boxrad = 0.03\n"


def run(line, text=None):
    return subprocess.run(line, cwd=ROOT, input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT if text is None else subprocess.PIPE, text=True, timeout=60)


def version(kind):
    """The version of a kind's tool, or None if it or its font is not there."""
    if kind == ".dot" and not FONT_FILE.exists():
        return None
    try:
        done = run(TOOLS[kind][1])
    except OSError:
        return None
    return re.sub(r"^.*?(graphviz|fossil)", r"\1", done.stdout).strip() if done.returncode == 0 else None


def sources(root):
    return sorted(path for path in (root / FOLDER).iterdir() if path.suffix in TOOLS)


def filled(path, facts):
    colour = {".pikchr": lambda value: "0x" + value[1:]}.get(path.suffix, str)
    try:
        text = facts.fill(path.read_text(encoding="utf-8"), colour)
    except Wrong as wrong:
        raise Wrong(f"{path.name}: {wrong}") from None
    if path.suffix == ".wave":
        text = re.sub(r"^\s*//.*\n", "", text, flags=re.M)
    return (PIKCHR if path.suffix == ".pikchr" else "") + text


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def stamp(path, text):
    line, _, tool = TOOLS[path.suffix]
    look = (pathlib.Path(__file__).parent / "fp3draw/svg.py").read_text(encoding="utf-8")
    return digest("\0".join([*line, tool, look, text]))


def head(path, text, body):
    """The first line of a drawing: what it was drawn from, and that nobody has changed it."""
    return f"<!-- Drawn by tools/draw.py from {path.name}: do not edit. {stamp(path, text)} {digest(body)} -->"


def is_stale(path, text):
    drawn = path.with_suffix(".svg")
    if not drawn.exists():
        return True
    first, _, body = drawn.read_text(encoding="utf-8").partition("\n")
    return first != head(path, text, body)


def draw(path, text):
    done = run(TOOLS[path.suffix][0], text)
    if done.returncode or "<svg" not in done.stdout:
        sys.exit(f"draw.py: {path.name}: {done.stdout}{done.stderr}")
    try:
        body = themed(done.stdout[done.stdout.index("<svg"):])
    except ValueError as error:
        sys.exit(f"draw.py: {path.name}: {error}")
    return f"{head(path, text, body)}\n{body}"


def main():
    parser = argparse.ArgumentParser(description="docs/drawings/*.svg from their sources")
    parser.add_argument("--check", action="store_true", help="draw nothing; fail if a drawing is stale")
    parser.add_argument("--again", type=pathlib.Path, metavar="DIR", help="draw all into a folder")
    parser.add_argument("--root", type=pathlib.Path, default=ROOT, help="the project's directory")
    args = parser.parse_args()
    try:
        facts = Facts(args.root)
        texts = {path: filled(path, facts) for path in sources(args.root)}
    except Wrong as wrong:
        sys.exit(f"draw.py: {wrong}")
    stale = [path for path, text in texts.items() if args.again or is_stale(path, text)]
    orphans = [path for path in (args.root / FOLDER).glob("*.svg") if not any(path.stem == source.stem for source in texts)]
    if args.check:
        sys.exit("".join(f"draw.py: {path.name}: stale\n" for path in stale) + "".join(f"draw.py: {path.name}: has no source\n" for path in orphans) + "Run make docs."
                 if stale or orphans else 0)
    for kind in sorted({path.suffix for path in stale}):
        if version(kind) != TOOLS[kind][2]:
            sys.exit(f"draw.py: {TOOLS[kind][2]} draws {kind} files; here is {version(kind) or 'none'}. Run: make setup-docs")
    for path in stale:
        target = (args.again or path.parent) / f"{path.stem}.svg"
        target.write_text(draw(path, texts[path]), encoding="utf-8")
        print(f"drew {target.name}")
    for path in orphans if not args.again else []:
        path.unlink()
        print(f"removed {path.name}")


if __name__ == "__main__":
    main()
