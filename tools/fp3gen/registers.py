"""isa/registers.toml: its checks, and rows of names and numbers that C and Verilog share."""

from .check import NAME, bit_ranges, keys, named, need

FEATURE_WORDS = ("features", "features_more")  # the registers that keys of configs.toml have a place in, 32 bits each
TRANSFER_BYTES = 32
MOST_COUNTERS = 48                            # host_decode finds a counter's number from address bits 8 to 3
ACCESS = {"ro": "read only", "rw": "read and write", "wo": "write only"}


def check_reset(row, file, where):
    """What a register shows or is reset to, and its interrupt."""
    fields = row.get("fields", {})
    need("shows" not in row or len(row["shows"]) == max(len(fields), 1), file, f"{where}: 'shows' must have a key for each field")
    bits = sum(hi - lo + 1 for hi, lo in fields.values()) if fields else 32
    need("reset" not in row or (len(fields) < 2 and 0 <= row["reset"] < 1 << bits), file,
         f"{where}: 'reset' must be the value of its only field")
    for name in (name for pair in row.get("interrupt", {}).items() for name in pair):
        need(name in fields, file, f"{where}: 'interrupt' names '{name}', which is no field")


def check_range(row, known):
    """The range of a setting, which its field has room for and its value after a reset is in."""
    file, where = "registers.toml", f"register '{row['name']}'"
    need(is_setting(row), file, f"{where}: 'range' is for what is read and written and is no interrupt")
    ends = row["range"]
    need(len(ends) == 2 and type(ends[0]) is int and type(ends[1]) in (int, str), file, f"{where}: range must be [least, most], not {ends!r}")
    least, most = ends
    if isinstance(most, str):
        need(known.get(most, {}).get("power_of_two") and least == 0, file, f"{where}: range: '{most}' is no key that is a power of two, or the least is not 0")
    else:
        hi, lo = next(iter(row.get("fields", {"": [31, 0]}).values()))
        need(0 <= least < most < 2 << hi - lo, file, f"{where}: range {ends!r} is empty, or its field has no room for it")
        need(least <= row.get("reset", 0) <= most, file, f"{where}: it is reset to {row.get('reset', 0)}, which is not in its range")


def check_keys_named(regs, known):
    """known: the keys of configs.toml."""
    for row in regs["register"] + regs["transfer"] + regs["window"] + regs["space"]:
        for name in (name for key in ("needs", "shows", "holds", "instead") for name in row.get(key, ())):
            need(name in known or str(name).rpartition(" - ")[2] in known or name in ("revision", "more") or isinstance(name, int), "registers.toml",
                 f"'{row['name']}' needs, shows or holds '{name}', which is no key of configs.toml")
        if "range" in row:
            need(row in regs["register"], "registers.toml", f"'{row['name']}': 'range' is for settings of a run")
            check_range(row, known)


def check_registers(regs, counted):
    """counted: the counters that instructions count in."""
    file = "registers.toml"
    keys(regs, file, "top level", {"address": dict, "register": list, "transfer": list, "counter": list, "counters": dict,
                                   "window": list, "space": list})
    keys(regs["counters"], file, "[counters]", {"at": int})
    keys(regs["address"], file, "[address]", dict.fromkeys(("scheduler", "broadcast", "space", "word"), int))
    need(regs["address"]["broadcast"] == (1 << regs["address"]["scheduler"]) - 1, file,
         "[address]: broadcast must be the last scheduler that the address has room for")
    for row in regs["register"]:
        where = f"register '{row.get('name', '?')}'"
        keys(row, file, where, {"name": str, "at": int, "access": str, "doc": str},
             {"fields": dict, "needs": list, "shows": list, "range": list, "reset": int, "interrupt": dict})
        bit_ranges(row.get("fields", {}), file, where)
        check_reset(row, file, where)
        for name in row.get("fields", {}):
            need(NAME.fullmatch(name), file, f"{where}: '{name}' is not a field name")
    for row in regs["transfer"]:
        where = f"transfer '{row.get('name', '?')}'"
        keys(row, file, where, {"name": str, "at": int, "access": str, "needs": list, "doc": str}, {"fields": dict})
        bit_ranges(row.get("fields", {}), file, where)
        need(row["at"] // TRANSFER_BYTES == regs["transfer"][0]["at"] // TRANSFER_BYTES, file,
             f"{where}: 0x{row['at']:04x} is not within the {TRANSFER_BYTES} bytes of the others: rtl/bus/fp3_master.v looks at the bits above")
    for row in regs["counter"]:
        keys(row, file, f"counter '{row.get('name', '?')}'", {"name": str, "doc": str})
    for row in regs["window"]:
        keys(row, file, f"window '{row.get('name', '?')}'",
             {"name": str, "at": int, "words": int, "holds": list, "access": str, "doc": str}, {"needs": list, "stream": bool})
    for row in regs["space"]:
        where = f"space '{row.get('name', '?')}'"
        keys(row, file, where, {"name": str, "at": int, "holds": list, "access": str, "doc": str},
             {"fields": dict, "needs": list, "instead": list, "stream": bool})
        bit_ranges(row.get("fields", {}), file, where)
    for what in ("register", "transfer", "counter", "window", "space"):
        named(regs[what], file, what)
    for name in counted:
        need(any(row["name"] == name for row in regs["counter"]), file, f"there must be a counter '{name}'")
    need(all(hi == lo for hi, lo in exceptions(regs).values()) and exceptions(regs), file,
         "register 'flags' must have a bit for each exception")

    # A window ends before the next one, the last before the end of the 16-bit addresses.
    windows = sorted(regs["window"], key=lambda row: row["at"])
    for row, above in zip(windows, windows[1:] + [{"at": 0x10000}]):
        need(0 < row["words"] <= (above["at"] - row["at"]) // 4, file,
             f"window '{row['name']}' has no room: the next starts at 0x{above['at']:04x}")
    counters = [{"name": "counter " + row["name"], "at": regs["counters"]["at"] + 8 * i, "bytes": 8}
                for i, row in enumerate(regs["counter"])]
    need(regs["counters"]["at"] == 128 and len(counters) <= MOST_COUNTERS, file,
         f"[counters]: at must be 128, for at most {MOST_COUNTERS} counters: rtl/host/fp3_host_decode.v takes a counter's number from address bits 8 to 3")
    owner = {}
    for row in regs["register"] + counters + windows + regs["transfer"]:
        at, name = row["at"], row["name"]
        need(row.get("access", "ro") in ACCESS, file,
             f"'{name}': access '{row.get('access')}' is not one of {', '.join(ACCESS)}")
        need(at % 4 == 0 and 0 <= at <= 0xfffc, file, f"'{name}': 0x{at:04x} is not the address of a word")
        need("words" in row or row in regs["transfer"] or not windows or at + row.get("bytes", 4) <= windows[0]["at"], file,
             f"'{name}' at 0x{at:04x} lies in the windows")
        for word in range(at, at + row.get("bytes", 4), 4):
            need(word not in owner, file, f"'{owner.get(word)}' and '{name}' overlap at 0x{word:04x}")
            owner[word] = name
    for row in regs["register"]:
        need(row["at"] < regs["counters"]["at"], file, f"'{row['name']}' at 0x{row['at']:04x} is not below the counters")


def show_keys(regs, config_keys):
    """The registers FEATURE_WORDS have fields for the keys of configs.toml that have a place in them."""
    places = {name: key["feature"] for name, key in config_keys.items() if "feature" in key}
    for name, pair in places.items():
        need(len(pair) == 2 and 0 <= pair[1] <= pair[0] < 32 * len(FEATURE_WORDS) and pair[1] // 32 == pair[0] // 32, "configs.toml",
             f"key '{name}': feature must be [high, low] within one of {len(FEATURE_WORDS)} words of 32 bits, not {pair!r}")
    for i, word in enumerate(FEATURE_WORDS):
        for row in regs.get("register", []):
            if row.get("name") == word:
                fields = {name: [hi % 32, lo % 32] for name, (hi, lo) in places.items() if lo // 32 == i}
                shows = dict(zip(row.get("fields", {}), row.get("shows", [])))
                if row.get("fields", {}) | fields:
                    row["fields"] = dict(sorted((row.get("fields", {}) | fields).items(), key=lambda item: item[1]))
                    row["shows"] = [shows.get(name, less_than_full(config_keys, name)) for name in row["fields"]]


def show_version(regs, version):
    """Register `version` has a field for each number of it, the last one lowest."""
    for row in regs.get("register", []):
        if row.get("name") == "version":
            need(len(row.get("fields", {})) == len(version), "registers.toml", "register 'version' must have a field for each number of the version")
            row["shows"] = version[::-1]


def less_than_full(config_keys, name):
    """What a field shows of a key: of one with `full` how much less it is."""
    full = config_keys[name].get("full") if name in config_keys else None
    return name if full is None else f"{full} - {name}"


def is_setting(row):
    """Whether the host port keeps it for the runs to come."""
    return row["access"] == "rw" and "interrupt" not in row


def settings(regs):
    return [row for row in regs["register"] if is_setting(row)]


def number(row):
    return row["at"] // 4


def shown(row, regs, revision, key, choose, literal="{}"):
    """What the fields of a register show, of one without fields its word: expressions of a language. key: a key's name there;
    choose: 1 or 0, by whether an expression is not 0; literal: a number."""
    def value(what):
        if what == "more":
            more = next(reg for reg in regs["register"] if reg["name"] == FEATURE_WORDS[1])
            return choose.format(" | ".join(map(value, more["shows"]))) if "fields" in more else literal.format(0)
        if isinstance(what, str) and " - " in what:
            full, name = what.split(" - ")
            return f"({literal.format(full)} - {key(name)})"
        return literal.format(what if isinstance(what, int) else revision) if what == "revision" or isinstance(what, int) else key(what)

    return [value(what) for what in row["shows"]]


def shown_word(row, values):
    """The whole word of such a register, as an expression that C and Verilog read."""
    if "fields" not in row:
        return values[0]
    return " | ".join(f"({value} & {(2 << hi - lo) - 1}) << {lo}" for value, (hi, lo) in zip(values, row["fields"].values()))


def stream_mask(regs):
    """Address bits of which each address of a window that streams has one, and no other address of space 0 any. All of the
    other spaces streams."""
    memories = [(row["at"], row["words"], row) for row in regs["window"]]
    need(all(row.get("stream") for row in regs["space"]), "registers.toml", "a space must stream: rtl/fp3.v tells it by the bits of the space alone")
    ends = regs["counters"]["at"] + 8 * len(regs["counter"])
    alone = [(at, words) for at, words, row in memories if not row.get("stream")] + [(0, ends // 4)] + [(row["at"], 1) for row in regs["transfer"]]
    taken = 0
    for at, words in alone:
        for offset in range(words):
            taken |= at + 4 * offset
    bits = 0
    for at, words, row in memories:
        if row.get("stream"):
            free = at & ~taken
            need(free, "registers.toml", f"'{row['name']}' has no address bit that says that it streams: those that do not have all of them, too")
            bits |= 1 << free.bit_length() - 1
    return bits


def exceptions(regs):
    """The exceptions, each with its bit of register `flags`, the lowest first."""
    fields = next((row.get("fields", {}) for row in regs["register"] if row["name"] == "flags"), {})
    return dict(sorted(fields.items(), key=lambda item: item[1]))


def counter_rows(regs):
    return [(row, regs["counters"]["at"] + 8 * i) for i, row in enumerate(regs["counter"])]


def field_rows(regs):
    return [(f"{reg['name'].upper()}_{name.upper()}_{end}", pair[i]) for reg in regs["register"] + regs["transfer"] + regs["space"]
            for name, pair in reg.get("fields", {}).items() for i, end in enumerate(("HI", "LO"))]


def address_rows(regs):
    parts = [(f"ADDRESS_{name.upper()}_BITS", bits) for name, bits in regs["address"].items() if name != "broadcast"]
    return (parts + [("ADDRESS_BROADCAST", regs["address"]["broadcast"])]
            + [(f"SPACE_{row['name'].upper()}", row["at"]) for row in regs["space"]])
