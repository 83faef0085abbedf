"""Links between pages, and into them: what they point to is there. Links to the web are not followed."""

import pathlib
import re
import unicodedata

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted(path.relative_to(ROOT).as_posix() for pattern in ("*.md", "docs/**/*.md", "tests/**/*.md", "examples/**/*.md", "python/**/*.md") for path in ROOT.glob(pattern))
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^()\s]*(?:\([^()\s]*\))?)\)")


def prose(text):
    """A page without its code."""
    return re.sub(r"^```.*?^```|`[^`\n]+`", "", text, flags=re.M | re.S)


def slug(heading):
    """As GitHub makes it: lower case, no punctuation, a dash for each blank."""
    text = re.sub(r"[`*]|!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return "".join("-" if c == " " else c for c in text if c in " -_" or unicodedata.category(c)[0] in "LN")


def anchors(path):
    found, seen = set(), {}
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", text, re.M):
        name = slug(heading)
        found.add(name if name not in seen else f"{name}-{seen[name]}")
        seen[name] = seen.get(name, 0) + 1
    return found | set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))


def dead(page, text):
    for target in LINK.findall(prose(text)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (ROOT / page).parent / name if name else ROOT / page
        if not path.exists():
            yield f"{target}: there is no such file"
        elif anchor and path.suffix == ".md" and anchor not in anchors(path):
            yield f"{target}: there is no such heading"


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    assert not list(dead(page, (ROOT / page).read_text(encoding="utf-8")))


def linked(page):
    """The pages that a page points to."""
    targets = (target.partition("#")[0] for target in LINK.findall(prose((ROOT / page).read_text(encoding="utf-8"))))
    paths = (((ROOT / page).parent / target).resolve() for target in targets if target.endswith(".md") and not re.match(r"[a-z]+:", target))
    return {path.relative_to(ROOT).as_posix() for path in paths if path.exists()}


def test_every_page_is_two_clicks_from_the_readme():
    near = linked("README.md")
    there = near | {page for one in near for page in linked(one)}
    assert [page for page in PAGES if page.startswith("docs/") and page not in there] == []


def test_dead_links_are_seen():
    text = "[a](docs/nonesuch.md) [b](docs/models.md#nonesuch) [c](#nonesuch) [`x[1]`](docs/models.md#expressions) [d](https://x.y/z)\n"
    assert len(list(dead("README.md", text))) == 3
