"""The declarations of the C library for ctypes: python/fp3/_declarations.py, from sw/include/fp3/*.h.

This reads the form in which our headers are written, not C: definition structs, enumerations, X lists and prototypes.
tests/python/test_declarations.py holds every size, offset and constant against what the compiler says of the same
headers, so a form that this reader takes wrongly cannot pass.
"""

import re

from .check import Bad
from .text import MARK

HEADERS = ("status", "isa", "image", "model", "compile", "engine", "program", "scene", "recording", "batch", "bodies")
NUMBERS = {"int": "c_int", "unsigned": "c_uint", "char": "c_char", "float": "c_float", "double": "c_double",
           "size_t": "c_size_t", "uint8_t": "c_uint8", "uint32_t": "c_uint32", "uint64_t": "c_uint64"}
LONGEST = 118


class Reader:
    def __init__(self):
        self.version, self.constants, self.lists = None, {}, {}
        self.enums, self.functions, self.structs, self.prototypes = set(), {}, {}, {}
        self.order = []  # of functions and structs, as the headers have them

    # ---- text ----

    def header(self, text):
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S).replace("\\\n", " ")
        for name, value in re.findall(r"^#define (FP3_\w+) +(.+?) *$", text, re.M):
            if re.fullmatch(r"-?(0x[0-9a-fA-F]+|\d+)u?|UINT32_MAX", value):
                self.constants[name] = 0xffffffff if value == "UINT32_MAX" else int(value.rstrip("u"), 0)
        if at := re.search(r'^#define FP3_VERSION "(.*)"$', text, re.M):
            self.version = at[1]
        for name, body in re.findall(r"^#define (FP3_\w+)\(X\)(.*)$", text, re.M):
            self.lists[name] = [row.split(",")[0].strip() for row in re.findall(r"X\(([^()]*)\)", re.sub(r'"[^"]*"', '""', body))]
        text = re.sub(r"^#define X\((\w+)[^)]*\) (\w+)##\1,\n\s*(FP3_\w+)\(X\)\n#undef X$",
                      lambda at: " ".join(f"{at[2]}{name}," for name in self.lists[at[3]]), text, flags=re.M)
        text = re.sub(r"^#.*$", "", text, flags=re.M)
        text = re.sub(r"\b(FP3_API_BEGIN|FP3_API_END)\b|__attribute__\(\(.*?\)\)\)", " ", text)
        text = re.sub(r"^static inline [^;]*?\{.*?^\}", "", text, flags=re.M | re.S)
        for statement in self.statements(text):
            self.statement(" ".join(statement.split()))

    @staticmethod
    def statements(text):
        """The parts that end in a semicolon outside of braces."""
        depth, begin = 0, 0
        for i, sign in enumerate(text):
            depth += {"{": 1, "}": -1}.get(sign, 0)
            if sign == ";" and depth == 0:
                yield text[begin:i]
                begin = i + 1

    def statement(self, text):
        if at := re.fullmatch(r"(?:typedef )?enum(?: \w+)? ?\{(.*)\} ?(\w*)", text):
            self.enumeration(at[1])
            self.enums |= {at[2]}
        elif at := re.fullmatch(r"typedef struct \{(.*)\} (\w+)", text):
            self.order.append(at[2])
            self.structs[at[2]] = [field for member in at[1].split(";") if member.strip() for field in self.member(member.strip())]
        elif at := re.fullmatch(r"typedef struct (\w+) \1", text):
            return  # opaque: only its address is used
        elif at := re.fullmatch(r"typedef (.*?)(\w+) ?\((.*)\)", text):
            self.order.append(at[2])
            self.functions[at[2]] = f"CFUNCTYPE({', '.join([self.type(at[1].strip()), *self.arguments(at[3])])})"
        elif at := re.fullmatch(r"(.*?)(fp3_\w+) ?\((.*)\)", text):
            if "..." not in at[3]:
                self.prototypes[at[2]] = (self.type(at[1].strip()), self.arguments(at[3]))
        else:
            raise Bad(f"python.py: found '{text[:80]}' in a header, expected a declaration in one of our forms")

    def enumeration(self, body):
        value = -1
        for entry in filter(None, map(str.strip, body.split(","))):
            name, _, is_ = map(str.strip, entry.partition("="))
            value = self.number(is_) if is_ else value + 1
            self.constants[name] = value

    def number(self, text):
        """A number, a shifted one, or a constant that is known."""
        if at := re.fullmatch(r"(\w+) << (\w+)", text):
            return self.number(at[1]) << self.number(at[2])
        return self.constants[text] if text in self.constants else int(text.rstrip("u"), 0)

    # ---- types ----

    def member(self, text):
        """(name, type) of each name that the member declares."""
        if at := re.fullmatch(r"(.*?)\(\*(\w+)\)\((.*)\)", text):  # a pointer to a function
            return [(at[2], f"CFUNCTYPE({', '.join([self.type(at[1].strip()), *self.arguments(at[3])])})")]
        if at := re.fullmatch(r"(.*?)\(\*(\w+)\)\[(\w+)\]", text):  # a pointer to rows
            return [(at[2], "c_void_p")]
        at = re.fullmatch(r"((?:const )?(?:struct )?\w+)\b(.*)", text)
        return [self.declarator(at[1], part.strip()) for part in at[2].split(",")]

    def declarator(self, base, text):
        at = re.fullmatch(r"([*\s]|const\b)*(\w+)((?:\[\w+\])*)", text)
        if not at:
            raise Bad(f"python.py: found the declarator '{text}' of '{base}', expected a name with * and [N]")
        type_ = self.type(base + " " + "*" * text.partition(at[2])[0].count("*"))
        for size in reversed(re.findall(r"\[(\w+)\]", at[3])):
            type_ = f"{type_} * {self.number(size)}"
            type_ = f"({type_})" if at[3].count("[") > 1 else type_
        return at[2], type_

    def arguments(self, text):
        if text.strip() in ("", "void"):
            return []
        return [self.argument(part.strip()) for part in re.split(r",(?![^()]*\))", text)]

    def argument(self, text):
        text = re.sub(r"\[\w*\]$", "", text) + (" *" if text.endswith("]") else "")
        stars, words = text.count("*"), re.sub(r"\bconst\b|\bstruct\b|\*", " ", text).split()
        if stars and words[0] in NUMBERS and words[0] != "char":
            return "c_void_p" if stars == 1 else "POINTER(c_void_p)"  # an address: a NumPy array's, or byref(number)
        return self.type(words[0] + " " + "*" * stars)

    def type(self, text):
        stars, base = text.count("*"), re.sub(r"\bconst\b|\bstruct\b|\*", " ", text).split()
        if len(base) != 1:
            raise Bad(f"python.py: found the type '{text}', expected one word and *")
        base = base[0]
        if base == "void" and not stars:
            return "None"
        if base == "char" and stars:
            return "POINTER(" * (stars - 1) + "c_char_p" + ")" * (stars - 1)
        if base in self.functions:
            return base
        if base in self.structs:
            return "POINTER(" * stars + base + ")" * stars
        if base in self.enums or base in NUMBERS:
            base = NUMBERS.get(base, "c_int")
            return base if not stars else "POINTER(" * (stars - 1) + "c_void_p" + ")" * (stars - 1)
        if not stars:
            raise Bad(f"python.py: found '{text}', expected a type that a header declares")
        return "POINTER(" * (stars - 1) + "c_void_p" + ")" * (stars - 1)  # opaque


def struct_lines(name, fields):
    yield from ("", "", f"class {name}(Structure):", "    _fields_ = [")
    yield from (f'        ("{field}", {type_}),' for field, type_ in fields)
    yield "    ]"


def declarations_python(root, isa_h):
    """isa_h: the lines of fp3/isa.h, which is generated, too."""
    reader = Reader()
    for header in HEADERS:
        reader.header("\n".join(isa_h) if header == "isa" else (root / f"sw/include/fp3/{header}.h").read_text(encoding="utf-8"))
    lines = [f'"""{MARK.format(source="sw/include/fp3/*.h")}"""', "",
             "from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int, c_size_t,",
             "                    c_uint, c_uint8, c_uint32, c_uint64, c_void_p)", "", f'VERSION = "{reader.version}"', ""]
    lines += [f"{name} = {value}" for name, value in sorted(reader.constants.items())]
    for name in reader.order:
        lines += struct_lines(name, reader.structs[name]) if name in reader.structs else ["", "", f"{name} = {reader.functions[name]}"]
    lines += ["", "", "# Of each function: what it returns, and what it takes.", "PROTOTYPES = {"]
    for name, (returns, arguments) in reader.prototypes.items():
        tail = "," if len(arguments) == 1 else ""
        line = f'    "{name}": ({returns}, ({", ".join(arguments)}{tail})),'
        lines += [line] if len(line) <= LONGEST else [f'    "{name}": ({returns},', f'        ({", ".join(arguments)}{tail})),']
    lines += ["}"]
    if not {"fp3_batch_def", "fp3_error", "fp3_compiled", "fp3_model"} <= reader.structs.keys() or len(reader.prototypes) < 80:
        raise Bad("python.py: the headers lack a struct or most functions: this reader has lost its way")
    return lines
