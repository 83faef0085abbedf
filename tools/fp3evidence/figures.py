"""The figures of docs/evidence.toml, what docs/evidence.json has recorded of them, and whether that is out of date."""

import dataclasses
import json
import pathlib
import re
import tomllib

from bench import write
from fp3evidence import inputs, probes

ROOT = inputs.ROOT
DESCRIBED, RECORDED = ROOT / "docs/evidence.toml", ROOT / "docs/evidence.json"
KINDS = ("exact", "error", "time")
UNKNOWN, BUSY = "not recorded", "other work ran beside it"
IDLE = 0.3          # processors that others may keep busy while a time is measured


@dataclasses.dataclass(frozen=True)
class Figure:
    """One entry; `{name}` in it is filled in."""
    name: str
    page: str
    what: str
    kind: str
    command: str
    minutes: float
    inputs: tuple
    results: str
    named: dict = dataclasses.field(repr=False, compare=False)   # globs of each name in [inputs]
    report: str = ""
    peers: tuple = ()
    after: str = ""
    by_name: bool = False
    old: str = ""

    def globs(self, name):
        return tuple(self.named.get(name, (name,)))


def fill(value, name):
    """{name} in all texts of an entry. Other braces stay."""
    if isinstance(value, list):
        return tuple(fill(one, name) for one in value)
    return value.replace("{name}", name) if isinstance(value, str) else value


def stems(each):
    return each if isinstance(each, list) else [path.stem for path in inputs.matched(each)]


def read(text=None):
    """All of them by their names, or inputs.Wrong with what is wrong."""
    described, found = tomllib.loads(DESCRIBED.read_text(encoding="utf-8") if text is None else text), {}
    needed = {field.name for field in dataclasses.fields(Figure) if field.default is dataclasses.MISSING} - {"named"}
    known = {field.name for field in dataclasses.fields(Figure)} - {"named"} | {"each"}
    for entry in described["figure"]:
        name = entry.get("name", "without a name")
        for key in sorted(needed - entry.keys()) + sorted(entry.keys() - known):
            raise inputs.Wrong(f"figure {name}: {'unknown key' if key in entry else 'no key'} '{key}'")
        if entry["kind"] not in KINDS:
            raise inputs.Wrong(f"figure {name}: found kind '{entry['kind']}', expected {', '.join(KINDS)}")
        for one in stems(entry["each"]) if "each" in entry else [""]:
            figure = Figure(named=described["inputs"], **{key: fill(value, one) for key, value in entry.items() if key != "each"})
            for of in figure.inputs:
                if of not in probes.PROBES and not any(char in of for char in "/*") and of not in described["inputs"]:
                    raise inputs.Wrong(f"figure {name}: found input '{of}', expected a name in [inputs], a glob or a probe: {', '.join(probes.PROBES)}")
            if figure.name in found:
                raise inputs.Wrong(f"figure {figure.name} is there twice")
            found[figure.name] = figure
    return found


def prepare():
    """What is built first: commands that run at a time must find nothing to build."""
    return tomllib.loads(DESCRIBED.read_text(encoding="utf-8")).get("prepare")


def records():
    """By figure: revision, date, machine, of times the processors that others kept busy, seconds, and the hash of each input."""
    return json.loads(RECORDED.read_text(encoding="utf-8")) if RECORDED.exists() else {}


def record(found):
    """A line for each figure, so that a change shows which one it is."""
    lines = [f"{json.dumps(name)}: {json.dumps(found[name])}" for name in sorted(found)]
    write(RECORDED, "{\n" + ",\n".join(lines) + "\n}\n")


def drop_old(names):
    """Takes the lines `old` of figures out of the description that are fresh now."""
    entries = DESCRIBED.read_text(encoding="utf-8").split("\n[[figure]]\n")
    for number, entry in enumerate(entries):
        if any(f'name = "{name}"\n' in entry for name in names):
            entries[number] = re.sub(r"^old = .*\n", "", entry, flags=re.M)
    write(DESCRIBED, "\n[[figure]]\n".join(entries))


def differ(before, found):
    """Whether an input is not what it was. What another version of a tool has said cannot be compared."""
    *by, _ = (before or "").split(" ")
    return before != found and not (by and by != found.split(" ")[:-1])


def changed(figure, known, now):
    """The inputs that are not what they were. What cannot be asked here is not among them. Of times also that they were no idle machine's."""
    if not known or not known["inputs"]:
        return [UNKNOWN]
    before = known["inputs"]
    return [name for name, found in now.items() if found is not None and before.get(name, "") is not None and differ(before.get(name), found)] + \
           [BUSY] * (figure.kind == "time" and (known.get("load") or 0) > IDLE)


def states(figures, fp3):
    """Of each figure the inputs that have changed: none, and it is fresh."""
    known = records()
    return {name: changed(figure, known.get(name), inputs.now(figure, fp3)) for name, figure in figures.items()}


def anywhere(figures, found):
    """The same without versions of peers, which differ from machine to machine: what pages say is the same on all."""
    return {name: [one for one in why if one not in figures[name].peers] for name, why in found.items()}


def out_of_date(figures, found):
    """Lines on exact figures that are out of date and do not say so, or say so and are not."""
    for name, why in found.items():
        figure = figures[name]
        if figure.kind == "exact" and why and not figure.old:
            yield f"{name} is out of date ({', '.join(why)}): `make evidence ONLY={name}`, or `old` says in docs/evidence.toml why it is"
        if figure.old and not why:
            yield f"{name} is not out of date: `old` goes out of docs/evidence.toml"
        if figure.old and figure.kind != "exact":
            yield f"{name}: `old` is for exact figures; others may be out of date"
