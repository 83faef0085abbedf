"""isa/isa.toml: the checks of its rows, and an instruction word."""

from .check import bit_ranges, keys, named, need
from .configs import CONFIG_KEYS

UNITS = ("add", "mul", "chain", "sleep", "memory")


def check_isa(isa):
    file = "isa.toml"
    keys(isa, file, "top level", {"revision": int, "field": dict, "bank": dict, "op": list})
    need(1 <= isa["revision"] <= 255, file, "revision must fit a byte and not be 0")
    fields = isa["field"]
    need(sorted(fields) == sorted("op d a b c".split()), file, "[field] must define op, d, a, b, c")
    bit_ranges(fields, file, "[field]")
    width = {name: hi - lo + 1 for name, (hi, lo) in fields.items()}

    owner = {}
    need(sorted(isa["bank"]) == ["object", "shared"], file, "[bank] must define object and shared")
    for name, bank in isa["bank"].items():
        keys(bank, file, f"bank '{name}'", {"prefix": str, "base": int, "count": int})
        need(bank["base"] >= 0 and bank["count"] >= 1
             and bank["base"] + bank["count"] <= 1 << width["a"], file,
             f"bank '{name}' does not fit the {width['a']} bits of an operand")
        for code in range(bank["base"], bank["base"] + bank["count"]):
            need(code not in owner, file, f"banks '{owner.get(code)}' and '{name}' overlap in code {code}")
            owner[code] = name
    # The destination field names object registers only, and so can be shorter than an operand.
    need(isa["bank"]["object"]["base"] == 0 and isa["bank"]["object"]["count"] <= 1 << width["d"],
         file, f"bank 'object' must start at 0 and fit the {width['d']} bits of field d")

    taken = {}
    for op in isa["op"]:
        where = f"op '{op.get('name', '?')}'"
        keys(op, file, where, {"name": str, "code": int, "operands": list, "unit": str, "meaning": str},
             {"needs": str, "note": str})
        code = op["code"]
        need(code not in taken, file, f"{where}: code {code} is already taken by '{taken.get(code)}'")
        taken[code] = op["name"]
        need(1 <= code < 1 << width["op"], file,
             f"{where}: code {code} is not in 1 .. {(1 << width['op']) - 1}")
        need(op["unit"] in UNITS, file, f"{where}: unknown unit '{op['unit']}' (known: {', '.join(UNITS)})")
        need(CONFIG_KEYS.get(op.get("needs", "chain")) == (0, 1), file,
             f"{where}: needs '{op.get('needs')}', which is no key of configs.toml that is 0 or 1")
        operands = op["operands"]
        need(operands in (list("d"), list("da"), list("dab"), list("dabc")), file,
             f"{where}: operands must be d, or d, a, or d, a, b, or d, a, b, c, not {operands!r}")
    named(isa["op"], file, "op")


def word(isa, op, operands):
    value = op["code"] << isa["field"]["op"][1]
    for letter in op["operands"]:
        value |= operands[letter] << isa["field"][letter][1]
    return value
