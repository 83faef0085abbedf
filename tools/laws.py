#!/usr/bin/env python3
"""The laws of bodies as C: programs/bodies/*.ode, compiled by fp3, instruction by instruction to sw/bodies/laws.h.

    tools/laws.py              writes the header
    tools/laws.py --check      writes nothing; fails if the header is stale

So the text is the only source of a law, and the engine that is built in has the bits of all others.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = ROOT / "sw/bodies/laws.h"
# Laws, and the rows that they work on: those of a law have all its words but the bodies'.
LAWS = {"contact2": "contact2", "warm2": "contact2", "bounce2": "contact2"}
# The words of a body in a plane, as they stand side by side (sw/bodies/state.h).
BODY = ["v_x", "v_y", "w", "d_x", "d_y", "q", "m", "i"]
OPERATIONS = {"add": "{0} + {1}", "sub": "{0} - {1}", "mul": "{0} * {1}", "madd": "{2} + {0} * {1}", "msub": "{2} - {0} * {1}",
              "min": "fp3_wide_min({0}, {1})", "max": "fp3_wide_max({0}, {1})", "lt": "fp3_wide_lt({0}, {1})",
              "le": "fp3_wide_le({0}, {1})", "sel": "fp3_wide_sel({0}, {1}, {2})", "abs": "fp3_wide_abs({0})"}
HEAD = """/* SPDX-License-Identifier: Apache-2.0 */
/* laws.h - the laws of contacts and joints (programs/bodies/), instruction by instruction.
 *
 * Made by tools/laws.py; do not edit. a and b are the words of the two bodies (state.h), for eight
 * contacts at a time.
 */
#ifndef FP3_BODIES_LAWS_H
#define FP3_BODIES_LAWS_H

#include "wide.h"

#define FP3_BODY2_WORDS %s
""" % ", ".join(f'"{word}"' for word in BODY)


class Law:
    """A law's words and instructions, as the compiler has them."""

    def __init__(self, fp3, name):
        path = ROOT / f"programs/bodies/{name}.ode"
        done = subprocess.run([fp3, "compile", path, "-i", "euler", "--config", "world"], capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(done.stderr)
        self.name, text = name, done.stdout
        self.declared = re.findall(r"^(?:state|shared) +(\w+)(?:\[(\d)\])?", path.read_text(), re.M)
        self.shared = re.findall(r"^\.shared +(\w+)", text, re.M)
        self.code = re.findall(r"^    (\w+) +([^#\n]+?) *(?:# (.*))?$", text[text.index("step:"):], re.M)
        if re.search(r"^\.param", text, re.M):
            sys.exit(f"{name}: the law has params, or values that the host would compute: expected states and shared numbers alone")

    def words(self):
        for name, size in self.declared:
            for part in [""] if not size else [f"_{'xyzw'[i]}" for i in range(int(size))]:
                if name + part not in self.shared:
                    yield name + part


def body_word(word):
    """Which body, and which of its words; None: a word of the contact."""
    found = re.fullmatch(r"([vwdqmi])([ab])(_[xyz])?", word)
    if not found or found[1] + (found[3] or "") not in BODY:
        return None
    return f"{found[2]}[{BODY.index(found[1] + (found[3] or ''))}]"


def function(law, row):
    shared = "".join(f", fp3_wide {name}" for name in law.shared)
    yield f"FP3_WIDELY void fp3_{law.name}(fp3_{row}_row *row, fp3_wide *a, fp3_wide *b{shared}) {{"
    known = set()

    def operand(name):
        if re.match(r"[-\d.]", name):
            return f"fp3_wide_all({float(name)!r}f)"
        if name in law.shared or re.fullmatch(r"t\d+", name):
            return name
        return body_word(name) or f"row->{name}"

    for op, operands, _ in law.code:
        to, *given = [x.strip() for x in operands.split(",")]
        declared = "" if to in known or not re.fullmatch(r"t\d+", to) else "fp3_wide "
        known.add(to)
        if op not in OPERATIONS:
            sys.exit(f"{law.name}: '{op}' is not one of the operations {', '.join(OPERATIONS)}")
        yield f"    {declared}{operand(to)} = {OPERATIONS[op].format(*map(operand, given))};"
    yield "}"


def header(fp3):
    lines = [HEAD]
    for name, row in LAWS.items():
        law = Law(fp3, name)
        if name == row:
            words = [word for word in law.words() if not body_word(word)]
            lines += ["typedef struct {", *[f"    fp3_wide {word};" for word in words], f"}} fp3_{row}_row;",
                      f"#define FP3_{row.upper()}_WORDS " + ", ".join(f'"{word}"' for word in words), ""]
        lines += [*function(law, row), ""]
    return "\n".join(lines + ["#endif", ""])


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--check", action="store_true", help="compare only")
    chosen = options.parse_args()
    fp3 = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build")) / "bin/fp3"
    text = header(fp3)
    text = subprocess.run(["clang-format", "--assume-filename", HEADER], input=text, capture_output=True, text=True, check=True).stdout
    if not chosen.check:
        HEADER.write_text(text)
    elif not HEADER.exists() or HEADER.read_text() != text:
        sys.exit(f"{HEADER.relative_to(ROOT)} is stale: run tools/laws.py")


main()
