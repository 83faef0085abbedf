"""decode against isa/isa.toml: what is legal in this build, and what a legal word asks for.

FP3_ISA: that file. FP3_KEYS: the configuration, as JSON. FP3_WORDS: how many words, at random.
"""

import json
import os
import random
import tomllib
from pathlib import Path

import cocotb
from cocotb.triggers import Timer

ISA = tomllib.loads(Path(os.environ["FP3_ISA"]).read_text())
KEYS = {"interleave": 0, "dual": 0, "chain": 0, "fused": 0, "scale": 0, "select": 0, "estimate": 0, "round": 0, "sleep": 0, "neighbours": 0, "keep": 0,
        **json.loads(os.environ["FP3_KEYS"])}
ROWS = {row["code"]: row for row in ISA["op"]}
SINGLE = ("legal", "to_add", "to_mul", "to_chain", "to_sleep", "to_memory", "subtract", "st", "lds", "each", "next", "ldn", "ldl", "stl", "takes",
          "flips", "phase", "repeats", "returns", "keeps", "raises", "holds", "twice", "halve")
MORE = 31                                                  # as op: the code is 128 and field c


def field(word, name):
    high, low = ISA["field"][name]
    return word >> low & (2 << high - low) - 1


def code_of(word):
    return 128 + field(word, "c") if field(word, "op") == MORE else field(word, "op")


def mixes(row, d, a, b):
    """Whether the instruction breaks the rule of `dual`: sums in registers of even number, products and estimates of sums in those of odd number."""
    even, odd = (lambda x: x < 64 and x % 2 == 0), (lambda x: x < 64 and x % 2 == 1)
    operands = [x for x, name in ((a, "a"), (b, "b")) if name in row["operands"]]
    scales = row.get("needs") == "scale"
    valued = "value" in row["path"]
    return (d % 2 == 0) != (row["path"] == ["adder"]) or valued and odd(a) or sum(map(even, operands)) > 1 or sum(map(odd, operands)) > 1 or \
        scales and (even(b) or odd(a))


def expected(word):
    """What a word asks for; None: it is illegal."""
    row = ROWS.get(code_of(word))
    d, a, b, c = (field(word, name) for name in "dabc")
    c = 0 if field(word, "op") == MORE else c
    if row is None or "needs" in row and not KEYS[row["needs"]]:
        return None
    if any(value and name not in row["operands"] for name, value in zip("abc", (a, b, c))) or \
            any(value % 64 >= KEYS["registers"] for value in (d, a, b, c)):
        return None
    if KEYS["dual"] and row["path"] != ["store"] and mixes(row, d, a, b):
        return None
    repeats = KEYS["fused"] and not KEYS["interleave"] and "c" not in row["operands"]         # a, as c: what a sum alone adds to
    name, path, gives, takes = row["name"], row["path"], row.get("gives"), row.get("computes")
    path = ["multiplier"] if KEYS["dual"] and path == ["value", "adder"] else path         # made in a product's place
    return {"legal": 1, "to_add": int(path in (["adder"], ["value", "adder"], ["store", "adder"])), "to_mul": int(path in (["multiplier"], ["store", "multiplier"])),
            "to_chain": int(path == ["multiplier", "adder"]), "to_sleep": int(path == ["comparison"]), "to_memory": int(path == ["store"] or name in ("each", "next", "raise")),
            "subtract": int(name in ("sub", "msub", "fmsub", "subh", "subt", "subn", "subl")), "st": int(name in ("st", "stl")), "lds": int(name == "lds"),
            **{other: int(name == other) for other in ("each", "next", "stl")},
            "phase": int(name in ("phase", "repeat", "again", "hold")), "repeats": int(name == "repeat"), "returns": int(name == "again"),
            "keeps": int(name == "keep"), "raises": int(name == "raise"), "holds": int(name == "hold"),
            "ldn": int(gives == "word" or name == "keep"), "ldl": int(gives == "field"), "takes": int(takes is not None), "flips": int(name in ("rsbn", "rsbl")),
            "twice": int(name in ("addt", "subt")), "halve": int(name in ("addh", "subh")), "d": d,
            **({"a": a, "b": b, "c": c} if name == "sel" else {x: value for x, value in zip("abc", (a, b, c)) if x in row["operands"] and
                                                                path[0] != "value"}), **({"c": a} if repeats else {})}


def said(dut, sel):
    bits = dut.decoded_o.value.binstr
    width = KEYS["registers"].bit_length() - 1
    got = {name: int(bits[i]) for i, name in enumerate(SINGLE)}
    ends = bits[len(bits) - 4 * width - 3:]
    got["d"] = int(ends[:width], 2)
    operands = [ends[width + i * (width + 1):][:width + 1] for i in range(3)]
    values = [int(text[0], 2) * 64 + int(text[1:], 2) for text in operands]
    got.update(zip("abc", values))
    return {**got, "a": values[2], "c": values[0]} if sel else got     # sel: a is what it chooses by, c the first it chooses from


@cocotb.test()
async def decode_says_what_is_legal(dut):
    chance = random.Random(1)
    legal = set()
    for _ in range(int(os.environ["FP3_WORDS"])):
        code = chance.choice((chance.randrange(MORE),) * 3 + (128 + chance.randrange(20),) * 3 + (128 + chance.randrange(128),))
        row, word = ROWS.get(code), min(code, MORE) << ISA["field"]["op"][1]
        for name in "dabc":
            if row and name not in row["operands"] and chance.random() < 0.95:
                continue
            register = chance.randrange(64 if chance.random() < 0.05 else KEYS["registers"])
            word |= (register | (64 if name != "d" and chance.random() < 0.4 else 0)) << ISA["field"][name][1]
        if code >= 128:
            word = word & ~127 | code - 128
        dut.word_i.value = word
        await Timer(1, "ns")
        want = expected(word)
        got = said(dut, row is not None and row["name"] == "sel")
        if want is None:
            assert not got["legal"], f"{word:#010x} ({row and row['name']}) is legal"
        else:
            legal.add(row["name"])
            assert {name: got[name] for name in want} == want, f"{word:#010x} ({row['name']})"
    assert legal == {row["name"] for row in ROWS.values() if not ("needs" in row and not KEYS[row["needs"]])}
