"""Each page of docs says below its title what it is, and for whom. The site's navigation comes from this line."""

import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").glob("**/*.md"))
KIND = re.compile(r"\*(Guide|Reference|Measured), for (everyone|games|numerics|FPGAs|developers of FP3)\.\*")


def kind(text):
    """What the first line below the title says."""
    _, _, rest = re.sub(r"<!--.*?-->\n*", "", text, count=1).partition("\n")
    found = KIND.fullmatch(rest.lstrip("\n").partition("\n")[0])
    return found and found[1]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_a_page_says_what_it_is(path):
    said = kind(path.read_text(encoding="utf-8"))
    assert said, "expected *Guide, for games.* or the like below the title"
    if said == "Measured":
        assert re.search(r"20\d\d-\d\d-\d\d|docs/synth\.json|gallery\.json|`make (?:all sim|sizes|report)", path.read_text(encoding="utf-8")), "expected when it was measured"


@pytest.mark.parametrize("text, said", [("# A\n\n*Guide, for games.*\n\nText", "Guide"), ("<!-- x -->\n# A\n\n*Measured, for everyone.*\n", "Measured"),
                                        ("# A\n\nText\n\n*Guide, for games.*\n", None), ("# A\n\n*Story, for games.*\n", None)])
def test_what_is_no_such_line_is_seen(text, said):
    assert kind(text) == said
