"""A build with all mutants of some files in it, and the tests that are run against each, cheapest first."""

import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import time

from fp3cmutants import sites

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
ROUNDS = 40                     # of the compiler, each without the lines that it refused
PATIENCE = 4                    # times what a rung takes without a mutant, after which a mutant hangs
LEAST = 10.0                    # seconds
ROOM = 8 << 30                  # bytes of address space
LINKED = {"bin/fp3", "lib/libfp3.so.0"}     # what tests in Python start


class Failed(Exception):
    """No mutant can be judged."""


def commands(targets):
    """What make runs for targets, by what each command makes."""
    done = subprocess.run(["make", "-n", "-B", *targets], cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise Failed(f"make -n: {done.stderr.strip()}")
    found = {}
    for line in done.stdout.splitlines():
        made = re.search(r"(?:^| )-o (\S+)", line) if line.startswith(("gcc ", "g++ ", "ccache ", "cc ", "clang ")) else None
        if made:
            found[made[1]] = line
    return found


def name_of(path):
    """As make calls what it builds."""
    return os.path.relpath(BUILD / path, ROOT) if BUILD.is_relative_to(ROOT) else str(BUILD / path)


class Tree:
    """A build whose chosen programs have the mutants, beside links to everything else."""

    def __init__(self, folder, files, programs):
        self.folder, self.files = pathlib.Path(folder), files
        self.texts, self.mutants, self.options = {path: (ROOT / path).read_bytes() for path in files}, [], {}
        self.programs = sorted(programs)
        self.commands = commands([name_of(program) for program in self.programs])
        self.farm()
        self.objects = {path: self.compiled(path) for path in files}
        self.beside()
        for program in self.programs:
            self.link(program)

    def farm(self):
        parts = {pathlib.PurePath(program).parts[0] for program in self.programs}
        for entry in BUILD.iterdir():
            if entry.name in parts:
                (self.folder / entry.name).mkdir(parents=True)
                for inner in entry.iterdir():
                    if f"{entry.name}/{inner.name}" not in self.programs:
                        (self.folder / entry.name / inner.name).symlink_to(inner.resolve())
            elif entry.is_symlink():
                (self.folder / entry.name).symlink_to(os.readlink(entry))
            elif not self.folder.is_relative_to(entry):
                (self.folder / entry.name).symlink_to(entry)

    def run(self, words):
        return subprocess.run(words, cwd=ROOT, capture_output=True, text=True)

    def compiler(self, path, text, output):
        """The command of make for a file, of another text; warnings are not asked for."""
        made = name_of(f"obj/{pathlib.PurePath(path).with_suffix('.o')}")
        if made not in self.commands:
            raise Failed(f"{path} is not in {', '.join(self.programs)}")
        words = [word for word in shlex.split(self.commands[made]) if word not in ("-Werror", "-Wall", "-Wextra", "-Wpedantic", "-MMD", "-MP", "-g", "-c", path)]
        at = words.index("-o")
        del words[at:at + 2]
        text_file = self.folder / (pathlib.PurePath(output).name + ".c")
        text_file.write_bytes(f'#line 1 "{path}"\n'.encode() + text)
        return [*words, "-w", "-iquote", str(pathlib.PurePath(path).parent), str(text_file), "-o", str(output)]

    def compiled(self, path):
        """An object with all mutants of a file that compile."""
        without, first, output = set(), len(self.mutants), self.folder / f"{path.replace('/', '_')}.o"
        for _ in range(ROUNDS):
            changed = sites.Changed(path, self.texts[path], first, without)
            done = self.run([*self.compiler(path, sites.BEFORE.encode() + f'#line 1 "{path}"\n'.encode() + changed.out, output), "-c"])
            if not done.returncode:
                self.mutants += changed.mutants
                return output
            errors = [(int(line), text) for line, text in re.findall(rf"^{re.escape(path)}:(\d+):\d+: error: (.*)$", done.stderr, re.M)]
            refused = {line for line, text in errors[:1] + [one for one in errors if "undeclared" not in one[1]]}
            if not refused - without:
                break
            without |= refused
        raise Failed(f"{path}: {done.stderr.strip()[:500]}")

    def beside(self):
        text = self.folder / "beside.c"
        text.write_text(sites.BESIDE.replace("COUNT", str(max(1, len(self.mutants)))))
        done = self.run(["gcc", "-O1", "-fPIC", "-c", str(text), "-o", str(self.folder / "beside.o")])
        if done.returncode:
            raise Failed(done.stderr)

    def link(self, program):
        """The mutated objects are given before the archives, so those in the archives are not taken."""
        words = shlex.split(self.commands[name_of(program)])
        words[words.index("-o") + 1] = str(self.folder / program)
        ours = {name_of(f"obj/{pathlib.PurePath(path).with_suffix('.o')}"): str(made) for path, made in self.objects.items()}
        taken = [ours.pop(word) if word in ours else word for word in words]
        at = next((number for number, word in enumerate(taken) if word.endswith(".a")), len(taken))
        taken[at:at] = [*ours.values(), str(self.folder / "beside.o")]
        done = self.run(taken)
        if done.returncode:
            raise Failed(f"{program}: {done.stderr.strip()[:500]}")


class Rung:
    """A test: a program of the build, or a file of pytest, with arguments."""

    def __init__(self, text):
        self.text, words = text, shlex.split(text)
        self.is_pytest = words[0] == "pytest"
        self.program = None if self.is_pytest else words[0]
        self.words = words[1:]
        self.seconds, self.seen = 0.0, set()

    def command(self, tree):
        if self.is_pytest:
            return [os.environ.get("PYTHON", "/usr/bin/python3"), "-m", "pytest", "-q", "-x", *self.words]
        return [str(tree.folder / self.program), *self.words]

    def run(self, tree, limit, **environment):
        """Whether it passed. None: it took too long."""
        with tempfile.TemporaryDirectory() as scratch:
            words = self.command(tree) + (["--basetemp", f"{scratch}/t", "-o", f"cache_dir={scratch}/cache"] if self.is_pytest else [])
            process = subprocess.Popen(["prlimit", f"--as={ROOM}", *words], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
                                       start_new_session=True, env=os.environ | {"FP3_BUILD": str(tree.folder), "TMPDIR": scratch} | environment)
            try:
                return process.wait(limit) == 0
            except subprocess.TimeoutExpired:
                return None
            finally:
                try:
                    os.killpg(process.pid, 9)
                except ProcessLookupError:
                    pass
                process.wait()

    def begin(self, tree):
        """Without a mutant: it passes, so long it takes, and these mutants it reaches."""
        with tempfile.TemporaryDirectory() as seen:
            begin = time.monotonic()
            if not self.run(tree, None, FP3_MUTANTS_SEEN=seen):
                raise Failed(f"'{self.text}' fails without a mutant")
            self.seconds = time.monotonic() - begin
            for path in pathlib.Path(seen).iterdir():
                self.seen |= {number for number, is_seen in enumerate(path.read_bytes()) if is_seen}

    def kills(self, tree, mutant):
        return not self.run(tree, max(LEAST, PATIENCE * self.seconds), FP3_MUTANT=str(mutant.number))


def programs(rungs):
    """What has to have the mutants."""
    return {rung.program for rung in rungs if not rung.is_pytest} | (LINKED if any(rung.is_pytest for rung in rungs) else set())


def is_equivalent(tree, mutant):
    """The compiler makes the same of the file with and without it."""
    def made(text):
        output = tree.folder / f"same{mutant.number}.s"
        done = tree.run([*tree.compiler(mutant.file, text, output), "-S"])
        try:
            return None if done.returncode else re.sub(r"^\s*\.(file|ident|loc).*$", "", output.read_text(), flags=re.M)
        finally:
            for path in (output, tree.folder / (output.name + ".c")):
                path.unlink(missing_ok=True)
    text = tree.texts[mutant.file]
    return made(text) == made(sites.alone(text, mutant))
