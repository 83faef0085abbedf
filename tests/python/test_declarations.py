"""Declarations of the library for ctypes: every size, offset, constant and function is what the compiler makes of the headers."""

import ctypes
import json
import re
import subprocess

import pytest

from fp3 import _declarations as d

HEADERS = ("status", "isa", "image", "model", "compile", "engine", "program", "scene", "recording", "batch", "bodies")
STRUCTS = [value for value in vars(d).values() if isinstance(value, type) and issubclass(value, ctypes.Structure) and value is not ctypes.Structure]
CONSTANTS = {name: value for name, value in vars(d).items() if name.startswith("FP3_")}


@pytest.fixture(scope="module")
def compiled(root, tmp_path_factory):
    """What a C program prints that has the same names."""
    where = tmp_path_factory.mktemp("table")
    lines = [f"#include <fp3/{name}.h>" for name in HEADERS] + ["#include <stdio.h>", "#include <stddef.h>", "int main(void) {", 'printf("{");']
    for struct in STRUCTS:
        lines.append(f'printf("\\"{struct.__name__}\\": %zu,\\n", sizeof({struct.__name__}));')
        lines += [f'printf("\\"{struct.__name__}.{field}\\": [%zu, %zu],\\n", offsetof({struct.__name__}, {field}), sizeof((({struct.__name__} *)0)->{field}));'
                  for field, _ in struct._fields_]
    lines += [f'printf("\\"{name}\\": %lld,\\n", (long long)({name}));' for name in CONSTANTS]
    lines += ['printf("\\"end\\": 0}\\n");', "return 0; }"]
    (where / "table.c").write_text("\n".join(lines))
    subprocess.run(["gcc", "-std=c11", "-Wall", "-Werror", "-I", root / "sw/include", where / "table.c", "-o", where / "table"], check=True)
    return json.loads(subprocess.run([where / "table"], capture_output=True, text=True, check=True).stdout)


def test_structs_lie_in_memory_as_the_compiler_lays_them(compiled):
    assert len(STRUCTS) > 40
    for struct in STRUCTS:
        assert compiled[struct.__name__] == ctypes.sizeof(struct), struct
        for field, _ in struct._fields_:
            at = getattr(struct, field)
            assert compiled[f"{struct.__name__}.{field}"] == [at.offset, at.size], (struct, field)


def test_constants_are_those_of_the_headers(compiled):
    assert len(CONSTANTS) > 150
    assert {name: compiled[name] for name in CONSTANTS} == CONSTANTS


def test_numbers_that_share_a_size_are_of_the_same_kind(root):
    """A float and an int have one size: the words of the headers decide."""
    text = re.sub(r"/\*.*?\*/", " ", "".join((root / f"sw/include/fp3/{name}.h").read_text() for name in HEADERS), flags=re.S)
    reals = {"float": ctypes.c_float, "double": ctypes.c_double}
    seen = 0
    for body, name in re.findall(r"typedef struct \{([^{}]*)\} (\w+);", text):
        fields = dict(getattr(d, name)._fields_)
        for member in body.split(";"):
            for word in re.findall(r"^\s*(float|double)\s+([\w\s,]+)$", member):
                for field in word[1].split(","):
                    assert fields.pop(field.strip()) is reals[word[0]], (name, field)
                    seen += 1
        assert not [field for field, kind in fields.items() if kind in reals.values()], name
    assert seen > 25


def test_every_function_is_in_the_library(build):
    library = ctypes.CDLL(str(build / "lib/libfp3.so.0"))
    assert len(d.PROTOTYPES) > 100
    for name in d.PROTOTYPES:
        assert getattr(library, name), name


def test_prototypes_are_what_the_compiler_takes(root, tmp_path):
    """Each function is called with as many arguments as the table says, and returns what it says, or this does not compile."""
    words = {ctypes.c_int: "int", ctypes.c_uint: "unsigned", ctypes.c_float: "float", ctypes.c_double: "double", ctypes.c_size_t: "size_t",
             ctypes.c_uint32: "uint32_t", ctypes.c_uint64: "uint64_t", None: "void"}
    enums = "int: 1, unsigned: 1"
    lines = [f"#include <fp3/{name}.h>" for name in HEADERS]
    for name, (returns, arguments) in d.PROTOTYPES.items():
        call = f"{name}({', '.join('0' for _ in arguments)})"
        if returns is None:
            lines.append(f"void try_{name}(void); void try_{name}(void) {{ {call}; }}")
        elif returns in (ctypes.c_float, ctypes.c_double, ctypes.c_size_t, ctypes.c_uint64):
            lines.append(f'_Static_assert(_Generic({call}, {words[returns]}: 1, default: 0), "{name}");')
        elif returns in (ctypes.c_int, ctypes.c_uint, ctypes.c_uint32):
            lines.append(f'_Static_assert(_Generic({call}, {enums}, default: 0), "{name}");')
        elif issubclass(returns, ctypes.Structure):
            lines.append(f'_Static_assert(_Generic({call}, {returns.__name__}: 1, default: 0), "{name}");')
        else:
            lines.append(f'_Static_assert(sizeof({call}) == sizeof(void *), "{name}");')
    (tmp_path / "calls.c").write_text("\n".join(lines) + "\n")
    said = subprocess.run(["gcc", "-std=c11", "-w", "-c", "-I", root / "sw/include", tmp_path / "calls.c", "-o", tmp_path / "calls.o"], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr[:2000]
