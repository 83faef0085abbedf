"""A module whose promises a specification beside this file states: how it is proved by induction, and how its seeded bugs are found."""

import sys
from pathlib import Path
from typing import NamedTuple

from induction import Machine, Refuted, Unproved
from mutants import Bug

HERE = Path(__file__).parent
ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tools"), str(ROOT / "tests")]

from fp3gen.parameters import config_word
from fp3gen.read import load

MACHINE = load(ROOT)
TIMING = MACHINE.timing


class Subject(NamedTuple):
    spec: str                            # the specification's module and file, which instantiates ours
    sources: tuple                       # files of ours: that of the seeded bugs first, and what is included
    title: str                           # of a shape, by its parameters; none: its configuration, and what differs
    shapes: list                         # parameter sets to prove (parameters below)
    bugs: list                           # (name, right, wrong, parameters)
    depth: int = 1                       # of the induction
    models: tuple = ()                   # files beside the specification, in place of modules of ours
    cycles: int = 24                     # a seeded bug must show within so many of reset; 0: such runs take minutes to find, it must break the induction

    def machine(self, yosys, files, shape, lemmas):
        texts = {name: files[name] for name in self.sources}
        if "CONFIG" in shape:
            texts |= {name: text for name, text in files.items() if name.endswith(".vh")}
        texts |= {name: (HERE / name).read_text() for name in (f"{self.spec}.v", *self.models)}
        chosen = " ".join(f"-set {name} {value}" for name, value in {**parameters(shape), "LEMMAS": lemmas}.items())
        read = " ".join(name for name in texts if name.endswith(".v"))
        return Machine(yosys, f"read_verilog -formal {read}; chparam {chosen} {self.spec}; "
                       f"hierarchy -top {self.spec}; proc; memory_collect; memory_map", self.spec, texts)

    def prove(self, yosys, files, shape):
        return self.machine(yosys, files, shape, 1).prove(self.depth)

    def find(self, yosys, files, bug, shape):
        """A seeded bug must break a promise in a run from reset, where lemmas about registers do not count, or the induction."""
        try:
            if self.cycles:
                self.machine(yosys, bug.patch(files), shape, 0).refute(self.cycles)
            else:
                self.prove(yosys, bug.patch(files), shape)
        except (Refuted, Unproved) as found:
            return f"found: {found}"
        raise RuntimeError("the bug was not found")

    def cases(self):
        module = self.sources[0].removeprefix("fp3_").removesuffix(".v")
        for shape in self.shapes:
            yield (f"{module}, {title(self.title, shape)}",
                   lambda yosys, files, shape=shape: self.prove(yosys, files, shape))
        for name, right, wrong, shape in self.bugs:
            bug = Bug(module, name, self.sources[0], right, wrong)
            yield f"seeded: {name}", lambda yosys, files, bug=bug, shape=shape: self.find(yosys, files, bug, shape)


def configurations(**wanted):
    """The rows of isa/configs.toml with these values."""
    return [row for row in MACHINE.configs if all(row[key] == value for key, value in wanted.items())]


def latency(row, core):
    return row.get(f"{core}_latency", row[f"{core}_cuts"].bit_count() + 1)


def title(text, shape):
    return text.format(**shape) if text else ", ".join([shape["CONFIG"], *(f"{name.lower()} {value}" for name, value in shape.items() if name != "CONFIG")])


def parameters(shape):
    """What a shape sets. CONFIG names a configuration; names in small letters are keys of it with other values."""
    if "CONFIG" not in shape:
        return shape
    row, = configurations(name=shape["CONFIG"])
    row = row | {name: value for name, value in shape.items() if name.islower()}
    return {name: value for name, value in shape.items() if name.isupper()} | {"CONFIG": config_word(row, MACHINE.keys)}
