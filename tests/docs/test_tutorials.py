"""Each page of docs/tutorials, and docs/one_line.md, runs from its first command to its last, and prints what the page prints.

A page runs in one folder, in the order of the page. An indented block that begins with a comment with the name of a file is that file.
In any other block `$ ` begins a command, and what follows is its output, with errors; `exit code N` at its end is what a command
ends with that fails. In the output a line `...` stands for any lines, and `<...>` for any text within a line. Commands without `$ ` are not
run: test_printed.py has the reason for each. A PNG on a page is one that its commands draw; an SVG shows times of one machine.
"""

import difflib
import os
import re
import struct
import subprocess
import zlib

import pytest
from test_printed import ROOT, blocks, commands, exception, files, is_session

PAGES = sorted(path.relative_to(ROOT).as_posix() for path in [ROOT / "docs/one_line.md", *ROOT.glob("docs/tutorials/*.md")])


def ended(lines):
    """Without blanks at the end of lines, and without empty lines at the end."""
    return "\n".join(line.rstrip() for line in lines).rstrip("\n").splitlines()


def session(block):
    """The commands of a block, each with the lines that it prints."""
    found = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif found and found[-1][0].endswith("\\") and not found[-1][1]:
            found[-1] = (f"{found[-1][0]}\n{line}", [])
        else:
            found[-1][1].append(line)
    return [(command, ended(lines)) for command, lines in found]


def steps(page):
    """What a reader does: a file to write, (name, text), or a command with what it prints, (command, lines)."""
    for block in blocks(page):
        assert is_session(block) or "\n$ " not in block, f"no text between a file and a command:\n{block}"
        found = session(block) if is_session(block) else files(block)
        known = found or [*map(exception, commands(block))]
        assert known and all(known), f"neither a file nor a command:\n{block}"
        yield from found


def pattern(line):
    return ".*".join(map(re.escape, re.split(r"<\.\.\.>", line)))


def difference(expected, lines):
    """None if the lines are what is expected, else both beside each other, without what `<...>` stands for."""
    whole = "".join(r"(?:.*\n)*?" if line == "..." else pattern(line) + "\n" for line in expected)
    if re.fullmatch(whole, "".join(line + "\n" for line in lines)):
        return None
    known = [next((one for one in expected if one != "..." and re.fullmatch(pattern(one), line)), line) for line in lines]
    return "\n".join(difflib.unified_diff(expected, known, "the page", "the command", lineterm="", n=2))


def run(command, folder, env):
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    return ended(done.stdout.splitlines()) + ([f"exit code {done.returncode}"] if done.returncode else [])


def pixels(picture):
    """The size of a PNG, and what is packed in it: how it is packed depends on the version of zlib."""
    data, at, packed = picture.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += 12 + size
    return data[16:24], zlib.decompress(packed)


@pytest.mark.parametrize("page", PAGES)
def test_a_tutorial_prints_what_it_says(folder, build, page, how):
    if build.name != "build":
        pytest.skip("a library with sanitizers cannot be loaded by the page's programs, which have none")
    env = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"} | how
    text = (ROOT / page).read_text(encoding="utf-8")
    for first, second in steps(text):
        if isinstance(second, str):
            (folder / first).write_text(second)
        else:
            differs = difference(second, run(first, folder, env))
            assert not differs, f"{page}: $ {first}\n{differs}"
    for picture in re.findall(r"!\[[^]]*\]\((.*\.png)\)", text):
        assert pixels(folder / picture) == pixels((ROOT / page).with_name(picture)), f"{page}: {picture} has other pixels: {folder / picture}"


def test_what_differs_is_found(tmp_path):
    """What is a file, what a command, what it prints; and that another output is seen."""
    page = "    # a.ode\n    step 1\n\nand\n\n    $ cat a.ode\n    # a.ode\n    ...\n\n    $ echo 1 \\\n        2; false\n    1 2\n    exit code 1\n"
    file, cat, echo = steps(page)
    assert file == ("a.ode", "# a.ode\nstep 1\n") and cat[0] == "cat a.ode" and echo == ("echo 1 \\\n    2; false", ["1 2", "exit code 1"])
    (tmp_path / file[0]).write_text(file[1])
    assert not difference(cat[1], run(cat[0], tmp_path, None)) and not difference(echo[1], run(echo[0], tmp_path, None))
    for wrong in ("    cat a.ode\n    # a.ode\n", "    just text\n", page.replace("and\n\n", "")):
        with pytest.raises(AssertionError):
            list(steps(wrong))
    assert difference(["a <...> c", "...", "d"], ["a b c", "e"]).splitlines()[-3:] == ["-...", "-d", "+e"]
    assert not difference(["a <...> c", "...", "d"], ["a b c", "x", "d"]) and not difference(["a", "..."], ["a"])
    assert difference([], ["x"]) and difference(["x"], []) and difference(["1.5", "..."], ["1x5"])
