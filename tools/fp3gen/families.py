"""programs/integrators/families.toml: which methods belong together, and the colour of each family in the pictures of tools/."""

import re
import tomllib

from .check import Bad

FILE = "programs/integrators/families.toml"
KINDS = ("integrators", "solvers")


def need(condition, message):
    if not condition:
        raise Bad(f"{FILE}: {message}")


def check_family(family, kind, seen):
    need(isinstance(family, dict) and set(family) == {"name", "colour", "members"}, f"{kind}: a family has name, colour and members")
    name, members = family["name"], family["members"]
    need(isinstance(name, str) and name, f"{kind}: a family has a name")
    need(re.fullmatch("#[0-9a-f]{6}", str(family["colour"])), f"'{name}': found colour {family['colour']!r}, expected one like \"#0072b2\"")
    need(isinstance(members, list) and members and all(isinstance(member, str) for member in members), f"'{name}': members are names")
    for member in members:
        need(member not in seen, f"'{member}' is in '{seen.get(member)}' and in '{name}'")
        seen[member] = name


def families(root):
    """Of each kind the families: name, colour, members."""
    try:
        found = tomllib.loads((root / FILE).read_text(encoding="utf-8"))
    except OSError as error:
        raise Bad(f"{FILE}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Bad(f"{FILE}: {error}") from None
    need(set(found) == set(KINDS), f"there are {', '.join(found)}, expected {' and '.join(KINDS)}")
    for kind in KINDS:
        seen = {}
        for family in found[kind]:
            check_family(family, kind, seen)
        colours = [family["colour"] for family in found[kind]]
        need(len(set(colours)) == len(colours), f"{kind}: two families have one colour")
        if kind == "integrators":
            known = {path.stem for path in (root / FILE).parent.glob("*.cfg")}
            need(not known - set(seen), f"{', '.join(sorted(known - set(seen)))}: in no family")
            need(not set(seen) - known, f"{', '.join(sorted(set(seen) - known))}: no such integrator")
    return found
