"""isa/isa.toml: the checks of its rows, what follows from them, and an instruction word."""

from .check import bit_ranges, keys, named, need

# What instructions go through, and the counter of those that begin with it.
PATHS = {
    ("adder",): "issued_add",
    ("multiplier",): "issued_mul",
    ("multiplier", "adder"): "issued_chain",
    ("value", "adder"): "issued_add",
    ("comparison",): "issued_sleep",
    ("store",): "issued_memory",
    ("store", "adder"): "issued_add",
    ("store", "multiplier"): "issued_mul",
    ("sequence",): "issued_memory",
}
UNITS = ("adder", "multiplier", "value", "comparison", "store", "sequence")
WRITES = ("always", "sometimes", "never")
GIVES = ("nothing", "word", "field")  # of a neighbour: nothing, a word of its record, a field of its entry
TAKES = ("field",)  # the object's register: a field of the entry
BITS = ("nan", "one", "minus_zero")
MORE = 128  # codes from here on: all ones in field op, and what is more than this in field c
FILE = "isa.toml"


def check_fields(isa):
    fields = isa["field"]
    need(sorted(fields) == sorted("op d a b c".split()), FILE, "[field] must define op, d, a, b, c")
    bit_ranges(fields, FILE, "[field]")
    return {name: hi - lo + 1 for name, (hi, lo) in fields.items()}


def check_banks(isa, width):
    owner = {}
    need(sorted(isa["bank"]) == ["object", "shared"], FILE, "[bank] must define object and shared")
    for name, bank in isa["bank"].items():
        keys(bank, FILE, f"bank '{name}'", {"prefix": str, "base": int, "count": int})
        need(bank["base"] >= 0 and bank["count"] >= 1
             and bank["base"] + bank["count"] <= 1 << width["a"], FILE,
             f"bank '{name}' does not fit the {width['a']} bits of an operand")
        for code in range(bank["base"], bank["base"] + bank["count"]):
            need(code not in owner, FILE, f"banks '{owner.get(code)}' and '{name}' overlap in code {code}")
            owner[code] = name
    # The destination field names object registers only, and so can be shorter than an operand.
    need(isa["bank"]["object"]["base"] == 0 and isa["bank"]["object"]["count"] <= 1 << width["d"],
         FILE, f"bank 'object' must start at 0 and fit the {width['d']} bits of field d")


def check_op(op, width, config_keys, flags):
    where = f"op '{op.get('name', '?')}'"
    keys(op, FILE, where, {"name": str, "code": int, "operands": list, "path": list, "meaning": str},
         {"needs": str, "note": str, "raises": list, "commutes": bool, "writes": str,
          "gives": str, "takes": str, "number": str, "computes": str, "stands": str})
    need(op["operands"] == list("dabc")[:len(op["operands"])], FILE,
         f"{where}: operands must be none, or d, or d, a, or d, a, b, or d, a, b, c, not {op['operands']!r}")
    last, most = (1 << width["op"]) - 2, MORE + (1 << width["c"]) - 1
    need(1 <= op["code"] <= last or MORE <= op["code"] <= most and "c" not in op["operands"], FILE,
         f"{where}: code {op['code']} is not in 1 .. {last}" + ("" if "c" in op["operands"] else f", nor in {MORE} .. {most}"))
    need(tuple(op["path"]) in PATHS, FILE, f"{where}: there is no path {op['path']!r} "
         f"(there are {', '.join(' and '.join(path) for path in PATHS)})")
    key = op.get("needs")
    need(key is None or "lack" in config_keys.get(key, ()), FILE,
         f"{where}: needs '{key}', which is no key of configs.toml that has a 'lack'")
    for flag in op.get("raises", []):
        need(flag in flags, FILE, f"{where}: there is no exception {flag!r} (there are {', '.join(flags)})")
    need(not op.get("commutes") or "b" in op["operands"], FILE, f"{where}: commutes, but has no operand b")
    need(op.get("writes", "always") in WRITES, FILE,
         f"{where}: writes '{op.get('writes')}' is not one of {', '.join(WRITES)}")


def check_given(op, ops):
    """What an instruction has of a neighbour, and what it makes of it."""
    where, base = f"op '{op['name']}'", next((row for row in ops if row["name"] == op.get("computes")), None)
    need(op.get("gives", "nothing") in GIVES, FILE, f"{where}: gives '{op.get('gives')}' is not one of {', '.join(GIVES)}")
    need(op.get("takes", TAKES[0]) in TAKES, FILE, f"{where}: takes '{op.get('takes')}' is not one of {', '.join(TAKES)}")
    need(not {"gives", "takes"} <= op.keys(), FILE, f"{where}: gives and takes exclude each other")
    counts = op["path"] == ["sequence"]                       # what is numbered is how often
    need({"gives", "takes"} & op.keys() or not {"computes", "stands"} & op.keys() and (counts or "number" not in op), FILE,
         f"{where}: gives nothing that it could number or compute with")
    need("takes" not in op or not {"computes", "stands"} & op.keys(), FILE, f"{where}: takes a field, and computes nothing with it")
    need("number" not in op or op["operands"][-1:] == [op["number"]], FILE,
         f"{where}: number must be the last operand")
    need(("computes" in op) == ("stands" in op), FILE, f"{where}: computes and stands go together")
    if "computes" in op:
        need(base and base["operands"] == list("dab") and "gives" not in base, FILE, f"{where}: computes must name an instruction of registers d, a, b")
        need(op["stands"] in ("a", "b") and op.get("number") == "b", FILE, f"{where}: stands must be a or b, and b the number")


def check_isa(isa, config_keys, flags):
    """flags: the exceptions that there are, by the lowest bit first."""
    keys(isa, FILE, "top level", {"revision": int, "field": dict, "bits": dict, "bank": dict, "op": list})
    need(1 <= isa["revision"] <= 255, FILE, "revision must fit a byte and not be 0")
    keys(isa["bits"], FILE, "[bits]", dict.fromkeys(BITS, int))
    for name, value in isa["bits"].items():
        need(0 <= value < 1 << 32, FILE, f"[bits]: {name} = {value:#x} is no pattern of 32 bits")
    width = check_fields(isa)
    check_banks(isa, width)
    taken = {}
    for op in isa["op"]:
        check_op(op, width, config_keys, flags)
        code = op["code"]
        need(code not in taken, FILE, f"op '{op['name']}': code {code} is already taken by '{taken.get(code)}'")
        taken[code] = op["name"]
    named(isa["op"], FILE, "op")
    for op in isa["op"]:
        check_given(op, isa["op"])
    for key in (key for key, row in config_keys.items() if "lack" in row):
        need(any(op.get("needs") == key for op in isa["op"]), "configs.toml",
             f"key '{key}': it has a 'lack', but no instruction needs it")


def code_bits(isa):
    """Bits of a code as hardware compares it: those of field op, unless an instruction has more."""
    hi, lo = isa["field"]["op"]
    return max(hi - lo + 1, max(op["code"] for op in isa["op"]).bit_length())


def counter_of(op):
    return PATHS[tuple(op["path"])]


def word(isa, op, operands):
    (hi, lo), c = isa["field"]["op"], isa["field"]["c"][1]
    more = (2 << hi - lo) - 1 << lo
    value = op["code"] << lo if op["code"] < MORE else more | op["code"] - MORE << c
    for letter in op["operands"]:
        value |= operands[letter] << isa["field"][letter][1]
    return value
