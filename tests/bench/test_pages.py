"""docs/benchmarks.md and docs/benchmarks.html: made from the same data, and the one shows what the other says."""

import html
import re

import pytest

SIZE_MOST = 3.5e6


@pytest.fixture(scope="module")
def pages(root):
    return (root / "docs/benchmarks.md").read_text(encoding="utf-8"), (root / "docs/benchmarks.html").read_text(encoding="utf-8")


def digest(page):
    return re.search(r"from data ([0-9a-f]{16})", page)[1]


def tables(page):
    """Of each model the rows: error, nanoseconds of fast with one thread, by what."""
    for part in re.split(r"^### ", page, flags=re.M)[1:]:
        rows = re.findall(r"^\| (1e-\d\d) \| ([\d.,]+) \| ([\w, ]+) \|", part, re.M)
        if rows:
            yield part.split("\n")[0], [(float(error), float(ns.replace(",", "")), how) for error, ns, how in rows]


def pictures(page):
    """Of each model what the pointer says of fp3 with one thread: by what, error, nanoseconds."""
    for name, part in re.findall(r"<h2 id='(\w+)'>(.*?)</svg>", page, re.S):
        found = re.findall(r"<title>fp3, one thread: (.*?), (?:h =|tolerance) .*?: error (\S+), (\S+) ns</title>", part)
        yield name, [(html.unescape(how), float(error), float(ns)) for how, error, ns in found]


def test_both_are_made_from_the_same_data(pages):
    assert digest(pages[0]) == digest(pages[1])


def test_what_a_table_says_is_a_point_of_the_picture(pages):
    shown = dict(pictures(pages[1]))
    rows = [(model, row) for model, rows in tables(pages[0]) for row in rows]
    assert len(rows) > 20
    for model, (error, ns, how) in rows:
        assert any(by == how and at <= error * 1.01 and time == pytest.approx(ns, rel=0.01) for by, at, time in shown[model]), (model, error, ns, how)


def test_the_pictures_load_nothing_and_are_small(pages):
    assert not any(word in pages[1] for word in ("http:", "https:", "src=", "<script", "@import", "<link", "url("))
    assert len(pages[1].encode()) <= SIZE_MOST and "(benchmarks.html)" in pages[0]
