#!/usr/bin/env python3
"""The pages of measurements, from what was measured: build/results/*.json to docs/.

    tools/pages.py                                  all pages of which something was measured here: `make report`
    tools/pages.py world bodies                     docs/world.md, docs/bodies_results.md and what belongs to them
    tools/pages.py bench --docs build/results       elsewhere

A section whose figures were not measured here stays as it is on the page, so that one figure can be measured again without the others. Nothing is
written if results are missing, or, into docs/, if they are of a quick form. Last, pages say how their figures stand (tools/evidence.py).
"""

import argparse
import json
import pathlib
import re
import sys

from bench import ROOT, write
from fp3evidence import told
from fp3gen.text import between
import measured

DOCS = ROOT / "docs"


class Wrong(Exception):
    """No page comes from it."""


class Results:
    """What was measured, read once."""

    def __init__(self, folder, docs):
        self.folder, self.docs = folder, docs

    def __call__(self, name, by):
        """by: the target that measures it."""
        path = self.folder / name
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise Wrong(f"{path} is missing: run `make {by}` first") from None
        about = found.get("about", {}) if isinstance(found, dict) else {}
        if self.docs == DOCS and (about.get("form") == "quick" or about.get("quick")):
            raise Wrong(f"{path} is of the quick form, the page is of the full one: run `make {by}`")
        return found

    def maybe(self, name):
        """None: it was not measured."""
        return self(name, "") if (self.folder / name).exists() else None

    def page(self, name):
        """As it is."""
        path = self.docs / name
        return (path if path.exists() else DOCS / name).read_text(encoding="utf-8")


# ---- one for each page: files beside docs/, each with its text; pictures, too ------------------------

def bench(results):
    import bench_report
    data = results("bench.json", "bench")
    return {"benchmarks.md": bench_report.completed(bench_report.markdown(data), results.page("benchmarks.md")), "benchmarks.html": bench_report.page_of(data)}


def results(found):
    import report
    sim, proved, rows = found.maybe("sim.json"), found.maybe("prove.json"), found.maybe("models.json")
    placed = measured.known()
    for name, part in (("sim.json", not sim or sim["runs"] and sim["scenes"]), ("synth.json", placed["trims"] and placed["rows"])):
        if not part:
            raise Wrong(f"{name} is not whole: run `make all sim synth` without CONFIG, PROGRAM and TOP")
    if not (sim or proved or rows):
        raise Wrong(f"{found.folder} has nothing of it: run `make all sim models prove` first")
    texts = {"results.md": report.page(sim, rows and rows["rows"], proved, placed)}
    return texts | ({"../README.md": report.readme(found.page("../README.md"), sim, placed)} if sim else {})


def sizes(found):
    import sizes
    return sizes.pages(measured.known()["rows"], found.page)


def skip(results):
    import skip
    return {"skipping.md": skip.page(results("skip.json", "skip"))}


def stress(results):
    from fp3bench import stress
    found = results("stress.json", "stress")
    return stress.pictures(found["curves"]) | {"stress.md": stress.page(found)}


def tune(results):
    import tune
    return {"tuning.md": tune.page(results("tune.json", "tune"))}


def scenes(results):
    import scenes
    return scenes.pages(results)


def world(results):
    from fp3world import combinations
    from fp3world import report
    data = results("world.json", "world")
    tried = data.get("combinations", [])
    tried = {"relations.md": combinations.page(results.page("relations.md"), tried)} if tried and combinations.are_whole(tried) else {}
    return tried | ({"world.md": report.page(data)} if {"hashes", "speed", "chip", "physics"} & data.keys() else {})


def bodies(results):
    from fp3bodies import report
    data = results("bodies.json", "bodies")
    return {"bodies_results.md": report.page(data)} | report.beside(data)


def cluster(results):
    from fp3cluster import report
    data = results("cluster.json", "cluster")
    return {"cluster_results.md": report.page(results.page("cluster_results.md"), data)} | report.beside(data)


def everywhere(results):
    import everywhere
    return {"everywhere.md": everywhere.page(results("everywhere.json", "everywhere"))}


def arithmetic(results):
    import arithmetic
    import storage
    text, found, records = results.page("arithmetic_results.md"), results.maybe("arithmetic.json"), results.maybe("storage.json")
    if not (found or records):
        raise Wrong(f"{results.folder} has nothing of it: run `make arithmetic storage` first")
    if found:
        text = between(text, "measured", "".join(arithmetic.page(found)).splitlines())
    if records:
        text = between(text, "records", storage.table(records["rows"]))
    return {"arithmetic_results.md": text} | ({"arithmetic.svg": arithmetic.draw(found)} if found else {})


def memory(results):
    import alone
    return {"memory.md": alone.page(results.page("memory.md"), results("alone.json", "alone"))}


def mutation(results):
    from fp3mutate import page
    return {"mutation.md": page.page(results("mutation.json", "mutate"))}


def mutation_c(results):
    import mutate_c
    return {"mutation_c.md": mutate_c.page(results.page("mutation_c.md"), results("mutation_c.json", "mutate-c"))}


PAGES = {page.__name__: page for page in (results, sizes, memory, bench, skip, stress, tune, scenes, world, bodies, cluster, everywhere, arithmetic, mutation, mutation_c)}


def text_of(made):
    return made if isinstance(made, str) else "\n".join(made).rstrip("\n") + "\n"


# ---- what was not measured here ----------------------------------------------------------------------

HEADS = {".md": re.compile(r"^(?=###? )", re.M), ".html": re.compile(r"^(?=<h2 id='\w+'>)", re.M)}


def sections(text, suffix):
    """Heading, figures, text of each; the figures of one without a mark are those of the section before it."""
    owners = []
    for part in HEADS[suffix].split(text):
        own = told.marked(part) if suffix == ".md" else [f"bench.{name}" for name in re.findall(r"^<h2 id='(\w+)'>", part)]
        owners = own or owners
        yield part.partition("\n")[0], owners, part


def joined(new, old, suffix):
    """The new text, and of the old one the sections of figures that the new one does not have. A section without a mark that both have is the new one."""
    out = list(sections(new, suffix))
    measured, before = {name for _, owners, _ in out for name in owners}, None
    for head, owners, part in sections(old, suffix):
        is_there = suffix == ".md" and not told.marked(part) and any(one[0] == head for one in out)
        if owners and not measured & set(owners) and not is_there:
            at = next((number for number, one in enumerate(out, 1) if one[0] == before), 1)
            out.insert(at, (head, owners, part))
        before = head if any(one[0] == head for one in out) else before
    text = ("\n\n" if suffix == ".md" else "\n").join(part.rstrip("\n") for _, _, part in out if part) + "\n"
    if suffix == ".html":       # a list of its sections
        links = "".join(f"<a href='#{name}'>{name}</a>" for name in re.findall(r"^<h2 id='(\w+)'>", text, re.M))
        text = re.sub(r"<nav>.*?</nav>", f"<nav>{links}</nav>", text).replace("\n</html>", "").replace("</html>", "").rstrip("\n") + "</html>\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", metavar="PAGE", help=f"{', '.join(PAGES)} (default: all that were measured)")
    parser.add_argument("--results", type=pathlib.Path, default=ROOT / "build/results", help="where the measurements are")
    parser.add_argument("--docs", type=pathlib.Path, default=DOCS, help="where the pages go")
    options = parser.parse_args()
    for name in options.pages:
        if name not in PAGES:
            parser.error(f"no page '{name}': there are {', '.join(PAGES)}")
    texts, found = {}, Results(options.results, options.docs.resolve())
    for name in options.pages or PAGES:
        try:
            texts |= {options.docs / file: text_of(made) for file, made in PAGES[name](found).items()}
        except Wrong as why:
            print(f"pages: {why}" if options.pages else f"pages: {name} stays as it is: {why}", file=sys.stderr)
            if options.pages:
                return 1
        except ModuleNotFoundError as why:
            print(f"pages: {name} needs the package '{why.name}': make setup-bench", file=sys.stderr)
            return 1
    for path, text in texts.items():
        if path.suffix in HEADS and path.exists():
            text = joined(text, path.read_text(encoding="utf-8"), path.suffix)
        write(path, text)
        print(f"wrote {path}")
    if {"results", "sizes"} & set(options.pages or PAGES):
        measured.keep()
    return 0


if __name__ == "__main__":
    sys.exit(main())
