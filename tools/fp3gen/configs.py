"""isa/configs.toml: the keys of a configuration, and the checks of every row."""

import re

from .check import NAME, Bad, keys, named, need

MASK_BITS = 7  # positions in a cut mask, as the parameters of rtl/fp3.v count them
FILE = "configs.toml"
# What the checks below speak of. Every other key is checked by what its own table says.
EXPECTED = ("interleave", "tiles", "schedulers", "lanes", "registers", "contexts", "store_words", "storage", "keep", "dual", "logarithmic", "mixed",
            "add_latency", "mul_latency", "add_cuts", "mul_cuts")


def cut_positions(root, core):
    """How many cuts a core has, as its source says."""
    try:
        found = re.search(r"parameter *\[(\d+):0\] *CUTS\b", (root / f"rtl/fp/fp3_{core}.v").read_text(encoding="utf-8"))
    except OSError as error:
        raise Bad(f"rtl/fp/fp3_{core}.v: {error.strerror}") from None
    if not found:
        raise Bad(f"rtl/fp/fp3_{core}.v: there is no 'parameter [N:0] CUTS'")
    return int(found[1]) + 1


def most_of(text, where, root, regs):
    """What a word stands for as the upper end of a range."""
    what, _, name = text.partition(" ")
    if what == "window":
        for row in regs["window"]:
            if row["name"] == name:
                return row["words"]
    if what == "address" and name in regs["address"]:
        return 1 << regs["address"][name]
    if what == "cuts" and NAME.fullmatch(name):
        return (1 << cut_positions(root, name)) - 1
    raise Bad(f"isa/{FILE}: {where}: '{text}' is neither a window nor a field of an address nor the cuts of a core")


def check_keys(tables, regs, root):
    """The [key.NAME] tables, their ranges as two numbers."""
    known = {}
    for name, given in tables.items():
        where = f"key '{name}'"
        need(NAME.fullmatch(name), FILE, f"{where}: a name is lower-case letters, digits, _")
        choices = given.get("choices")
        keys(given, FILE, where, {"choices" if choices else "range": list, "meaning": str},
             {"default": str if choices else int, "lack": str, "needs": list, "excludes": list, "because": str, "power_of_two": bool,
              "feature": list, "full": int, "is": str})
        key = known[name] = {"name": name, **given}
        if choices:
            need(key.get("default") in choices, FILE, f"{where}: its default must be one of {', '.join(choices)}")
            key |= {"range": [0, len(choices) - 1], "default": choices.index(key["default"])}
        if len(key["range"]) == 2 and isinstance(key["range"][1], str):
            key["range"] = [key["range"][0], most_of(key["range"][1], where, root, regs)]
        need(len(key["range"]) == 2 and all(type(n) is int for n in key["range"])
             and 0 <= key["range"][0] < key["range"][1] < 1 << 32, FILE,
             f"{where}: range must be [least, most], not {given.get('range')!r}")
        need("lack" not in key or key["range"] == [0, 1], FILE, f"{where}: with a 'lack' its range is [0, 1]")
    for name in EXPECTED:
        need(name in known, FILE, f"there must be a key '{name}'")
    follows = ["is" in key for key in known.values()]
    need(follows == sorted(follows), FILE, "keys with 'is' come last")
    for name, key in known.items():
        for other in [word for words in key.get("needs", []) for word in either(words)] + key.get("excludes", []):
            need(other in known, FILE, f"key '{name}': needs or excludes {other!r}, which is no key")
        low, high = key["range"]
        need(low <= key.get("default", low) <= high, FILE,
             f"key '{name}': its default {key.get('default')} is not in {low} .. {high}")
        need("is" not in key or "default" not in key, FILE, f"key '{name}': with 'is' nothing else decides")
        need(key.get("full", high) == high, FILE, f"key '{name}': full is the most, {high}, or left out")
    return known


def given(known):
    """The keys that can be set."""
    return [name for name, key in known.items() if "is" not in key]


def settable(row, known):
    """The row without the keys that follow from others."""
    return {name: value for name, value in row.items() if "is" not in known.get(name, ())}


def derive(row, known):
    """The row with the keys that follow from others."""
    row = dict(row)
    for name, key in known.items():
        if "is" in key:
            row[name] = int(eval(key["is"], {"__builtins__": {}, "log2": lambda n: max(n - 1, 0).bit_length()}, row))
    return row


def verilog_of(key):
    """The value of a key that follows from others, in Verilog."""
    words = {"and": "&&", "or": "||", "log2": "$clog2"}
    value = re.sub(r"[a-z]\w*", lambda word: words.get(word[0], word[0].upper()), key["is"])
    return f"({value}) ? 1 : 0" if re.search(r" (>|<|==) ", value) else value


def condition(name, known):
    """What a key asks for, in words of keys that can be set: "multiply_add = chain" for "multiply_add == 1"."""
    def spelled(found):
        choices = known[found[1]].get("choices", ())
        fit = [choice for number, choice in enumerate(choices) if eval(f"{number} {found[2]} {found[3]}")]
        return f"{found[1]} = {' or '.join(fit)}" if fit else found[0]

    return re.sub(r"(\w+) (==|<|>) (\d+)", spelled, known[name].get("is", name))


def plain(key):
    """The value of a key that asks for nothing."""
    return key.get("full", key["range"][0])


def either(words):
    """The keys of "A or B", of which one must be 1."""
    return words.split(" or ")


def check_value(row, key, known, where):
    """A value alone, and what it asks for."""
    name, (low, high) = key["name"], key["range"]
    need(name in row, FILE, f"{where}: '{name}' is missing, and has no default")
    value = row[name]
    said = f"{where}: {condition(name, known)}" + ("" if "is" in key else f" = {spoken(key, value)}")
    need("is" in key or low <= value <= high, FILE, f"{said} is not in {config_value(name, low)} .. {config_value(name, high)}")
    need(not key.get("power_of_two") or value & (value - 1) == 0, FILE, f"{said} is not a power of two")
    because = f": {key['because']}" if "because" in key else ""
    if value != plain(key):
        for others in key.get("needs", []):
            need(any(row[other] for other in either(others)), FILE, f"{said} needs {' or '.join(condition(other, known) for other in either(others))}")
        for other in key.get("excludes", []):
            need(not row[other], FILE, f"{said} excludes {condition(other, known)}{because}" if "is" in known[other]
                 else f"{said} needs {other} = {spoken(known[other], 0)}{because}")


def by_number(said, known, where):
    """A row with the numbers of its choices."""
    row = dict(said)
    for name, choices in ((name, known[name]["choices"]) for name in row if "choices" in known.get(name, ())):
        if isinstance(row[name], str):
            need(row[name] in choices, FILE, f"{where}: {name} = '{row[name]}' is not one of {', '.join(choices)}")
            row[name] = choices.index(row[name])
    return row


def check_configs(rows, known):
    """Each row with all its keys, in the order of the tables."""
    done = []
    for said in rows:
        where = f"config '{said.get('name', '?')}'"
        said = by_number(said, known, where)
        keys(said, FILE, where, {"name": str, "doc": str}, {"take": str} | dict.fromkeys(known, int))
        row = {name: said.get(name, known[name].get("default")) for name in given(known)}
        row = {"name": said["name"], "doc": said["doc"], "take": said.get("take", "")} | {name: v for name, v in row.items() if v is not None}
        for unit in ("add", "mul"):
            need(f"{unit}_cuts" in row, FILE, f"{where}: '{unit}_cuts' is missing, and has no default")
            least = row[f"{unit}_cuts"].bit_count() + 1
            row.setdefault(f"{unit}_latency", least)
            need(row[f"{unit}_latency"] >= least, FILE,
                 f"{where}: {unit}_latency {row[f'{unit}_latency']} is less than the {least} of its cuts")
        row = derive(row, known)
        for name in known.keys() - given(known):
            need(said.get(name, row[name]) == row[name], FILE, f"{where}: {name} = {said.get(name)}, but {known[name]['is']} says {row[name]}")
        for key in known.values():
            check_value(row, key, known, where)
        need(row["interleave"] or not row["fused"] or row["mul_latency"] >= 2 or not any(row[key] for key in ("select", "estimate", "round")), FILE,
             f"{where}: for one object, multiply_add = fused with select, reciprocal or round needs mul_latency of at least 2")
        if row["interleave"]:
            check_interleaved(row, where, known["store_words"]["range"][1])
        done.append({name: row[name] for name in ("name", "doc", "take", *known)})
    named(done, FILE, "config")
    return done


def check_interleaved(row, where, words):
    """What goes with what; rtl/config/fp3_config_rules.v checks the same."""
    need(row["lanes"] == 1 or row["schedulers"] == 1, FILE,
         f"{where}: lanes share one scheduler, or schedulers share one arithmetic unit, not both")
    need(not row["fused"] or row["schedulers"] == 1, FILE, f"{where}: multiply_add = fused needs schedulers = 1, as these share an adder and a multiplier")
    need(not row["neighbours"] or row["schedulers"] == 1, FILE, f"{where}: with neighbours a tile has one scheduler")
    need(row["tiles"] * row["schedulers"] <= 64, FILE, f"{where}: at most 64 schedulers have an address")
    need(row["store_words"] >= max(16, row["registers"]), FILE,
         f"{where}: store_words = {row['store_words']} holds no object of {row['registers']} registers, or less than two")
    need(row["add_latency"] + row["mul_latency"] >= 3, FILE,
         f"{where}: add_latency + mul_latency must be at least 3 where contexts are interleaved")
    need(not row["storage"] or row["add_latency"] + row["mul_latency"] >= 8, FILE,
         f"{where}: with storage add_latency + mul_latency must be at least 8, so that a word is rounded before its store ends")
    need(not row["keep"] or row["add_latency"] + row["mul_latency"] >= 4, FILE,
         f"{where}: with keep add_latency + mul_latency must be at least 4")
    if row["dual"]:
        need(row["schedulers"] == 1, FILE, f"{where}: with multiply_add = dual a tile has one scheduler")
        need(row["registers"] >= 4, FILE, f"{where}: with multiply_add = dual there are at least 4 registers")
        need(max(row["add_latency"], row["mul_latency"]) >= 2, FILE, f"{where}: with multiply_add = dual one latency is at least 2")
    if row["logarithmic"]:
        need(row["schedulers"] == 1, FILE, f"{where}: with arithmetic = logarithmic a tile has one scheduler")
        need(row["mul_latency"] >= 2 and row["add_latency"] >= 10, FILE, f"{where}: with arithmetic = logarithmic mul_latency is at least 2, add_latency 10")
    if row["mixed"]:
        need(row["schedulers"] == 1, FILE, f"{where}: with reciprocal = mixed a tile has one scheduler")
        need(row["add_latency"] + row["mul_latency"] >= 14, FILE, f"{where}: with reciprocal = mixed add_latency + mul_latency is at least 14")
    need(row["store_words"] >= 8 * row["contexts"], FILE,
         f"{where}: store_words = {row['store_words']} has no room for an object in each of {row['contexts']} contexts")
    need(row["store_words"] * row["lanes"] <= words, FILE,
         f"{where}: store_words * lanes = {row['store_words'] * row['lanes']} is more than the {words} that have an address")


def keys_of(row):
    """The keys of a row that check_configs() gave, in the order of the tables."""
    return [key for key in row if key not in ("name", "doc", "take")]


def spoken(key, value):
    """A value as a row has it."""
    return key["choices"][value] if 0 <= value < len(key.get("choices", ())) else config_value(key["name"], value)


def config_value(key, value):
    return f"0x{value:04x}" if key.endswith("_cuts") else str(value)
