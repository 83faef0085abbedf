"""isa/registers.toml: its checks, and rows of names and numbers that C and Verilog share."""

from .check import NAME, bit_ranges, keys, named, need

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


def check_keys_named(regs, known):
    """known: the keys of configs.toml."""
    for row in regs["register"] + regs["window"] + regs["space"]:
        for name in (name for key in ("needs", "shows", "holds", "instead") for name in row.get(key, ())):
            need(name in known, "registers.toml", f"'{row['name']}' needs, shows or holds '{name}', which is no key of configs.toml")


def check_registers(regs, counted):
    """counted: the counters that instructions count in."""
    file = "registers.toml"
    keys(regs, file, "top level", {"address": dict, "register": list, "counter": list, "counters": dict,
                                   "window": list, "space": list})
    keys(regs["counters"], file, "[counters]", {"at": int})
    keys(regs["address"], file, "[address]", {"scheduler": list, "broadcast": int, "space": list, "word": list})
    parts = {name: pair for name, pair in regs["address"].items() if name != "broadcast"}
    bit_ranges(parts, file, "[address]")
    need(regs["address"]["broadcast"] == (2 << parts["scheduler"][0] - parts["scheduler"][1]) - 1, file,
         "[address]: broadcast must be the last scheduler that the address has room for")
    for row in regs["register"]:
        where = f"register '{row.get('name', '?')}'"
        keys(row, file, where, {"name": str, "at": int, "access": str, "doc": str},
             {"fields": dict, "needs": list, "shows": list, "reset": int, "interrupt": dict})
        bit_ranges(row.get("fields", {}), file, where)
        check_reset(row, file, where)
        for name in row.get("fields", {}):
            need(NAME.fullmatch(name), file, f"{where}: '{name}' is not a field name")
    for row in regs["counter"]:
        keys(row, file, f"counter '{row.get('name', '?')}'", {"name": str, "doc": str})
    for row in regs["window"]:
        keys(row, file, f"window '{row.get('name', '?')}'",
             {"name": str, "at": int, "words": int, "holds": list, "access": str, "doc": str}, {"needs": list})
    for row in regs["space"]:
        where = f"space '{row.get('name', '?')}'"
        keys(row, file, where, {"name": str, "at": int, "holds": list, "access": str, "doc": str},
             {"fields": dict, "needs": list, "instead": list})
        bit_ranges(row.get("fields", {}), file, where)
    for what in ("register", "counter", "window", "space"):
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
    need(regs["counters"]["at"] % 128 == 0 and len(counters) <= 16, file,
         "[counters]: at is to be a multiple of 128, for at most 16 counters: rtl/host/host_decode.v takes a counter's number from address bits 6 to 3")
    owner = {}
    for row in regs["register"] + counters + windows:
        at, name = row["at"], row["name"]
        need(row.get("access", "ro") in ACCESS, file,
             f"'{name}': access '{row.get('access')}' is not one of {', '.join(ACCESS)}")
        need(at % 4 == 0 and 0 <= at <= 0xfffc, file, f"'{name}': 0x{at:04x} is not the address of a word")
        need("words" in row or not windows or at + row.get("bytes", 4) <= windows[0]["at"], file,
             f"'{name}' at 0x{at:04x} lies in the windows")
        for word in range(at, at + row.get("bytes", 4), 4):
            need(word not in owner, file, f"'{owner.get(word)}' and '{name}' overlap at 0x{word:04x}")
            owner[word] = name


def show_keys(regs, config_keys):
    """The fields of register `features` are the keys of configs.toml that have a place in it."""
    for row in regs.get("register", []):
        if row.get("name") == "features":
            fields = {name: key["feature"] for name, key in config_keys.items() if "feature" in key}
            row["fields"] = dict(sorted(fields.items(), key=lambda item: item[1]))
            row["shows"] = list(row["fields"])


def exceptions(regs):
    """The exceptions, each with its bit of register `flags`, the lowest first."""
    fields = next((row.get("fields", {}) for row in regs["register"] if row["name"] == "flags"), {})
    return dict(sorted(fields.items(), key=lambda item: item[1]))


def counter_rows(regs):
    return [(row, regs["counters"]["at"] + 8 * i) for i, row in enumerate(regs["counter"])]


def field_rows(regs):
    return [(f"{reg['name'].upper()}_{name.upper()}_{end}", pair[i]) for reg in regs["register"] + regs["space"]
            for name, pair in reg.get("fields", {}).items() for i, end in enumerate(("HI", "LO"))]


def address_rows(regs):
    parts = [(f"ADDRESS_{name.upper()}_{end}", pair[i]) for name, pair in regs["address"].items()
             if name != "broadcast" for i, end in enumerate(("HI", "LO"))]
    return (parts + [("ADDRESS_BROADCAST", regs["address"]["broadcast"])]
            + [(f"SPACE_{row['name'].upper()}", row["at"]) for row in regs["space"]])
