"""What drawings say of the project: `@{...}` in a source becomes a number or a name of isa/*.toml, of the tree, or of the glossary.

    @{config.many.contexts}  a key of a configuration          @{module.fetch}  fetch, if rtl/ has the module
    @{timing.list}           cycles                            @{bundle.issue}  ISSUE, if rtl/ has the bundle
    @{register.status}       an address on the bus             @{room.lab}      lab, if sw/ has the room
    @{window.program}        likewise                          @{path.isa}      isa, if there is such a path
    @{top.program}           the last byte of a window         @{word.visit}    visit, if the glossary explains it
    @{space.objects}         the number of a space             @{name.steps}    steps, if it is on the bus
    @{access.program}        whether it is read, written       @{op.madd}       madd, if it is an instruction
    @{bits.address.word}     21:2, where a field is            @{pass.chain}    chain, if the compiler has the pass
    @{counters.first}        the first address of counters     @{counters.last} the last byte of theirs
    @{code.madd}             the code of an instruction        @{blue}          a colour, as the drawing tool writes it

A name that is not there ends the drawing.
"""

import re

from fp3gen.pages import bit_text
from fp3gen.read import load
from fp3gen.registers import counter_rows

from .svg import PALETTE

MEANT = {"ro": "read", "wo": "write", "rw": "read, write"}


class Wrong(Exception):
    """A source names what is not there."""


class Facts:
    def __init__(self, root):
        self.root = root
        self.isa, self.registers, _, configs, self.timing = load(root)
        self.configs = {row["name"]: row for row in configs}
        self.rows = {row["name"]: row for table in ("register", "window", "space") for row in self.registers[table]}
        self.counters = [at for _, at in counter_rows(self.registers)]
        self.words = self.read("docs/glossary.md")
        self.passes = re.findall(r'^ *X\([A-Z_]+, "([\w-]+)",', self.read("sw/include/fp3/compile.h"), re.M)

    def read(self, path):
        return (self.root / path).read_text(encoding="utf-8")

    def only(self, pattern, name):
        """The name, if exactly one file or folder is called so; a device's own form of a module does not count."""
        found = [path for path in self.root.glob(pattern) if "fpga" not in path.parts]
        return name if len(found) == 1 else None

    def macro(self, name):
        """The name, if exactly one header defines a bundle that is called so."""
        found = [path for path in self.root.glob("rtl/**/*.vh") if f"`define FP3_{name}_FIELDS" in path.read_text(encoding="utf-8")]
        return name if len(found) == 1 else None

    def bits(self, table, name):
        fields = self.isa["field"] if table == "instruction" else self.rows[table]["fields"]
        return bit_text(fields[name])

    def look_up(self, kind, name):
        ops = {op["name"]: op["code"] for op in self.isa["op"]}
        return {
            "config": lambda: self.configs[name.split(".")[0]][name.split(".")[1]],
            "timing": lambda: self.timing[name]["cycles"],
            "name": lambda: self.rows[name]["name"],
            "register": lambda: f"0x{self.rows[name]['at']:04x}",
            "window": lambda: f"0x{self.rows[name]['at']:04x}",
            "top": lambda: f"0x{self.rows[name]['at'] + 4 * self.rows[name]['words'] - 1:04x}",
            "counters": lambda: f"0x{self.counters[0 if name == 'first' else -1] + (7 if name == 'last' else 0):04x}",
            "space": lambda: self.rows[name]["at"],
            "access": lambda: MEANT[self.rows[name]["access"]],
            "bits": lambda: self.bits(*name.split(".")),
            "code": lambda: ops[name],
            "op": lambda: name if name in ops else None,
            "module": lambda: self.only(f"rtl/**/fp3_{name}.v", name),
            "bundle": lambda: self.macro(name.upper()),
            "room": lambda: self.only(f"sw/{name}/", name),
            "path": lambda: self.only(name, name),
            "word": lambda: name if re.search(rf"^\| [^|]*\b{re.escape(name)}\b[^|]*\|", self.words, re.M) else None,
            "pass": lambda: name if name in self.passes else None,
        }[kind]()

    def fill(self, text, colour):
        """The source with its facts. colour: how the tool writes that of a hexadecimal number."""
        def fact(match):
            key = match[1]
            if key in PALETTE:
                return colour(PALETTE[key][0])
            try:
                found = self.look_up(*key.split(".", 1))
            except (KeyError, IndexError, TypeError):
                found = None
            if found is None:
                raise Wrong(f"@{{{key}}}: there is nothing of this name")
            return str(found)

        return re.sub(r"@\{([^}]*)\}", fact, text)
