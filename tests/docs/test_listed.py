"""Pages that list what the project has list all of it: commands, functions, boards."""

import pathlib
import re
import subprocess
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def first_cells(page, heading):
    """The names in the first column of the table that begins with this line."""
    text = (ROOT / page).read_text(encoding="utf-8")
    assert text.count(heading) == 1, f"{page}: no table {heading}"
    table = text.split(heading)[1].split("\n\n")[0]
    return re.findall(r"^\| (`.*?) \|", table, re.M)


def names(cells):
    return [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]


def test_every_command_has_its_row(fp3):
    said = subprocess.run([fp3, "--help"], capture_output=True, text=True, check=True, timeout=60).stdout
    listed = names(first_cells("docs/command.md", "| command | reads | writes |\n"))
    assert sorted(listed) == sorted(re.findall(r"^  (\w+)\t", said, re.M))


def test_every_function_is_listed():
    rows = re.findall(r"^    X\(\w+, (\w+), ", (ROOT / "sw/language/function_rows.h").read_text(encoding="utf-8"), re.M)
    listed = names(first_cells("docs/models.md", "| functions | notes |\n"))
    assert "sqrt" in rows and set(rows) - {"select"} <= set(listed)            # select is in the table of operators


def test_every_board_has_its_row():
    boards = tomllib.loads((ROOT / "boards/boards.toml").read_text(encoding="utf-8"))["board"]
    assert names(first_cells("docs/board.md", "| board | device | oscillator, clock | configuration | light | load it with |\n")) == [*boards]


def test_the_citation_has_the_version_and_the_licence():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    version = re.search(r'FP3_VERSION "(.*?)"', (ROOT / "sw/include/fp3/status.h").read_text(encoding="utf-8"))[1]
    assert f"\nversion: {version}\n" in text and "\nlicense: Apache-2.0\n" in text and text.startswith("cff-version: 1.2.0\n")
    assert all(f"\n{key}:" in text for key in ("message", "title", "authors", "references"))
