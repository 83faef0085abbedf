"""`make install` as others use it: programs outside the tree, in C and C++, with the shared and the static library."""

import os
import pathlib
import re
import shutil
import subprocess

import pytest

# One installation for all.
pytestmark = pytest.mark.xdist_group("install")

PREFIX = "usr/local"
HEADERS = sorted(path.name for path in (pathlib.Path(__file__).parents[2] / "sw/include/fp3").glob("*.h"))
LAB = {"convergence.h", "scene_truth.h", "scene_tune.h", "truth.h", "tune.h"}  # of libfp3_lab
STANDARD = {"math.h", "stddef.h", "stdint.h", "stdio.h"}


def run(*command, **options):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300, **options)


def succeeds(*command, **options):
    done = run(*command, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def make(root, build, goal, where, *more):
    """Without the variables of the make that started the tests."""
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    san = ["SAN=1"] if build.name.endswith("-san") else []
    succeeds("make", "-C", root, *san, goal, f"DESTDIR={where}", *more, env=env)


@pytest.fixture(scope="module")
def sanitize(build):
    """What a program that is linked with a library with sanitizers needs."""
    return ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []


@pytest.fixture(scope="module")
def installed(root, build, tmp_path_factory):
    where = tmp_path_factory.mktemp("install")
    make(root, build, "install", where)
    return where / PREFIX


@pytest.fixture
def flags(installed):
    """What pkg-config says of a library below the temporary directory, where no loader looks by itself."""
    env = {**os.environ, "PKG_CONFIG_PATH": str(installed / "lib/pkgconfig")}
    return lambda *options: succeeds("pkg-config", f"--define-variable=prefix={installed}", *options, "fp3", env=env).split()


@pytest.fixture
def start(root):
    """Runs a program that was linked with these flags, with no more help."""
    env = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    return lambda program, engine, **more: run(program, root / "programs/ship.ode", engine, cwd="/", env={**env, **more})


@pytest.fixture(scope="module")
def expected(root, fp3):
    """The same run with the command in the build tree, from another directory."""
    out = succeeds(fp3, "run", root / "programs/ship.ode", "-n", "100", "-e", "isa", cwd="/")
    return "".join(f"{name} {re.search(rf'^{name} +(?:= *)?([-+.0-9e]+)', out, re.M)[1]} " for name in "sv").strip()


def needed(binary):
    """The libraries that a binary names itself."""
    return re.findall(r"\(NEEDED\).*\[(.*)\]", succeeds("readelf", "-d", binary))


# How a program is built: the compiler, and where the library's code comes from.
BUILDS = {
    "C": ("gcc", ["-std=c11", "-Wpedantic"], False),
    "C++": ("g++", ["-x", "c++", "-std=c++17", "-Wpedantic"], False),
    "C, libfp3.a": ("gcc", ["-std=c11"], True),
    "C++, libfp3.a": ("g++", ["-x", "c++", "-std=c++17"], True),
}


@pytest.fixture(params=BUILDS)
def ship(request, root, flags, sanitize, tmp_path):
    compiler, options, is_static = BUILDS[request.param]
    shutil.copy(root / "tests/install/ship.c", tmp_path)
    libraries = flags("--libs", *["--static"] if is_static else [])
    if is_static:  # -lfp3 takes the shared one where both are there
        libraries = ["-l:libfp3.a" if flag == "-lfp3" else flag for flag in libraries]
    succeeds(compiler, "-Wall", "-Wextra", "-Werror", *sanitize, *flags("--cflags"), *options, "ship.c", "-x", "none",
             *libraries, "-o", "ship", cwd=tmp_path)
    assert is_static != ("libfp3.so.0" in needed(tmp_path / "ship"))
    return tmp_path / "ship", is_static


def test_a_program_outside_the_tree_runs_on_both_engines(ship, start, installed, expected):
    program, is_static = ship
    # The static library is in the program, which is not beside what is loaded.
    place = {"FP3_RTL_DIR": str(installed / "lib/fp3")} if is_static else {}
    for engine in ("isa", "rtl"):
        done = start(program, engine, **place)
        assert (done.returncode, done.stdout.strip(), done.stderr) == (0, expected, ""), engine


def test_a_game_loop(root, flags, sanitize, tmp_path):
    """10,000 objects, forces in and positions out in each frame: the example, in at most 25 lines, beside the same body in double."""
    assert len((root / "examples/game_loop.c").read_text().splitlines()) <= 25
    succeeds("gcc", "-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", *sanitize, root / "examples/game_loop.c", *flags("--cflags", "--libs"), "-o",
             tmp_path / "game_loop")
    shutil.copy(root / "examples/drone.ode", tmp_path)
    x, v, h = [0.0, 0.0], [0.0, 0.0], 1 / 64
    for _ in range(600):
        for i, target in enumerate((1.0, 100.0)):
            force = target - x[i]
            k1 = (force - 0.5 * v[i]) / 2
            k2 = (force - 0.5 * (v[i] + h / 2 * k1)) / 2
            k3 = (force - 0.5 * (v[i] + h / 2 * k2)) / 2
            k4 = (force - 0.5 * (v[i] + h * k3)) / 2
            x[i] += h * (v[i] + h * (k1 + k2 + k3) / 6)
            v[i] += h * (k1 + 2 * k2 + 2 * k3 + k4) / 6
    out = [float(word) for word in succeeds(tmp_path / "game_loop", cwd=tmp_path).split()]
    assert out == pytest.approx(x, rel=1e-4)


def test_without_the_hardware_the_isa_engine_runs_and_rtl_says_what_it_lacks(ship, start, tmp_path):
    program, _ = ship
    assert start(program, "isa", FP3_RTL_DIR=str(tmp_path)).returncode == 0
    done = start(program, "rtl", FP3_RTL_DIR=str(tmp_path))
    assert done.returncode == 1 and f"looked in {tmp_path}\n" in done.stderr and "fp3_single_full.so" in done.stderr


@pytest.mark.parametrize("libdir, says", [("/usr/local/lib", "-L${libdir} -Wl,-rpath,${libdir} -lfp3"), ("/opt/x/lib", "-L${libdir} -Wl,-rpath,${libdir} -lfp3"),
                                          ("/usr/lib", "-L${libdir} -lfp3"), ("/usr/lib/x86_64-linux-gnu", "-L${libdir} -lfp3")])
def test_a_program_carries_the_place_where_the_loader_does_not_look(root, libdir, says):
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    out = succeeds("make", "-n", "-C", root, "show", f"LIBDIR={libdir}", "--eval=show:; $(info $(FP3_PC)) @:", env=env)
    assert f"\nLibs: {says}\n" in out


def test_all_static_it_runs_on_the_isa_engine(root, flags, start, sanitize, expected, tmp_path):
    if sanitize:
        pytest.skip("sanitizers are shared libraries")
    succeeds("gcc", root / "tests/install/ship.c", "-static", *flags("--static", "--cflags", "--libs"), "-o",
             tmp_path / "ship")
    assert needed(tmp_path / "ship") == []
    assert start(tmp_path / "ship", "isa").stdout.strip() == expected


def test_neither_verilator_nor_cxx_is_needed(installed, sanitize):
    library = installed / "lib/libfp3.so.0"
    assert not [name for name in needed(library) if "stdc++" in name]
    assert sanitize or "stdc++" not in succeeds("ldd", library)
    unresolved = succeeds("nm", "-D", "--undefined-only", library) + succeeds("nm", "-u", installed / "lib/libfp3.a")
    assert not re.search(r"_Z|[Vv]erilated", unresolved)


@pytest.mark.parametrize("wrong, message", [
    ("garbage", "fp3_single_full.so"), ("other", "has configuration 'single'"), ("old", "both must come from one build")])
def test_hardware_that_does_not_fit_is_refused(installed, start, flags, root, sanitize, tmp_path, wrong, message):
    succeeds("gcc", root / "tests/install/ship.c", *sanitize, *flags("--cflags", "--libs"), "-o", tmp_path / "ship")
    target = tmp_path / "fp3_single_full.so"
    if wrong == "garbage":
        target.write_text("no library")
    elif wrong == "other":
        shutil.copy(installed / "lib/fp3/fp3_single.so", target)
    else:
        (tmp_path / "old.c").write_text("const unsigned fp3_rtl_table[16] = {0, 8};")
        succeeds("gcc", "-shared", "-fPIC", tmp_path / "old.c", "-o", target)
    done = start(tmp_path / "ship", "rtl", FP3_RTL_DIR=str(tmp_path))
    assert done.returncode == 1 and message in done.stderr and done.stdout == "", done.stderr


def test_the_driver_compiles_from_its_folder_alone(installed, tmp_path):
    """As somebody's firmware takes it: no other header of ours, no libc."""
    for name in ("fp3_bare", "fp3_bare_moves", "fp3_bare_neighbours"):
        succeeds("gcc", "-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffreestanding", "-nostdlib", "-I", ".", "-c", f"{name}.c",
                 "-o", tmp_path / f"{name}.o", cwd=installed / "share/fp3/bare")
        assert not re.findall(r"U (?!_GLOBAL_OFFSET_TABLE_|fp3_bare_)", succeeds("nm", "-u", tmp_path / f"{name}.o"))


@pytest.mark.parametrize("options", [["gcc", "-std=c11", "-x", "c"], ["g++", "-std=c++17", "-x", "c++"]],
                         ids=["C11", "C++17"])
def test_each_header_compiles_alone(installed, options):
    for name in HEADERS:
        succeeds(*options, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-I", installed / "include", "-",
                 input=f"#include <fp3/{name}>\nint main(void);\n")


def test_headers_include_each_other_and_the_standard_library_alone(installed):
    there = sorted(path.name for path in (installed / "include/fp3").iterdir())
    assert there == HEADERS
    for name in there:
        for included in re.findall(r'^ *# *include *([<"].*[>"])', (installed / "include/fp3" / name).read_text(), re.M):
            inner = included[1:-1]
            assert included[0] == "<" and (inner in STANDARD or inner.removeprefix("fp3/") in there), (name, included)


def declared(text):
    """The functions that a header declares."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"^ *#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.M)
    text = re.sub(r"^static inline [^;]*?\{", "{", text, flags=re.M)
    while "{" in text:
        text = re.sub(r"\{[^{}]*\}", "", text)
    statements = [statement for statement in text.split(";") if "typedef" not in statement]
    return {name for statement in statements for name in re.findall(r"\b(fp3_\w+)\s*\(", statement)[:1]}


def test_what_is_exported_is_what_the_headers_declare(installed):
    text = succeeds("nm", "-D", "--defined-only", installed / "lib/libfp3.so.0")
    exported = {line.split()[2] for line in text.splitlines()}
    expected = set().union(*(declared((installed / "include/fp3" / name).read_text()) for name in HEADERS if name not in LAB))
    assert len(expected) > 50 and exported == expected


def test_a_game_does_not_link_gsl(installed, root, flags, sanitize, tmp_path):
    """Nor does any plugin that the library loads. What measures against the truth is libfp3_lab, which a program takes in its place."""
    assert not re.search("gsl", succeeds("nm", "-D", "--undefined-only", installed / "lib/libfp3.so.0") + succeeds("nm", "-u", installed / "lib/libfp3.a"))
    for library in [installed / "lib/libfp3.so.0", *(installed / "lib/fp3").iterdir()]:
        assert not [name for name in needed(library) if "gsl" in name], library
    assert "gsl" not in " ".join(flags("--static", "--cflags", "--libs"))
    game = [root / "tests/install/ship.c", *sanitize, "-o", tmp_path / "game"]
    succeeds("gcc", *game, *["-l:libfp3.a" if flag == "-lfp3" else flag for flag in flags("--static", "--cflags", "--libs")])
    (tmp_path / "lab.c").write_text("#include <fp3/truth.h>\n#include <fp3/tune.h>\nint main(void) {\n"
                                    "    fp3_tuning_free(&(fp3_tuning *){0});\n    fp3_tune_def def = fp3_tune_default();\n"
                                    "    return !(def.safety == 1.25 && fp3_model_truth);\n}\n")
    env = {**os.environ, "PKG_CONFIG_PATH": str(installed / "lib/pkgconfig")}
    lab = succeeds("pkg-config", f"--define-variable=prefix={installed}", "--cflags", "--libs", "fp3_lab", env=env).split()
    assert run("gcc", tmp_path / "lab.c", *sanitize, *flags("--cflags", "--libs"), "-o", tmp_path / "lab").returncode != 0
    succeeds("gcc", tmp_path / "lab.c", *sanitize, *lab, "-o", tmp_path / "lab")
    succeeds(tmp_path / "lab")


def test_a_contradiction_ends_a_program(installed):
    """Asserts are in what is installed, too."""
    assert "__assert_fail" in succeeds("nm", "-D", installed / "lib/libfp3.so.0")


def test_nothing_tells_in_which_directory_it_was_compiled(installed, root):
    """So the same sources give the same bytes: tests/install/test_packages.py."""
    files = [path for path in installed.rglob("*") if path.is_file()]
    place = re.compile(rb"(?<![\w./-])" + re.escape(bytes(root)) + rb"[/\0]")
    assert len(files) > 30 and [path for path in files if place.search(path.read_bytes())] == []


def test_every_global_name_begins_with_fp3(installed):
    text = succeeds("nm", "-g", "--defined-only", installed / "lib/libfp3.a")
    names = {words[2] for words in map(str.split, text.splitlines()) if len(words) == 3}
    assert len(names) > 100 and not [name for name in names if not name.startswith("fp3_")]
    assert not [name for name in names if name.startswith(("fp3_bench", "fp3_lab", "fp3_measure", "fp3_ship", "fp3_stress"))], "what only measures"


def test_a_library_exports_its_table_alone(installed):
    for library in sorted((installed / "lib/fp3").iterdir()):
        names = {line.split()[2] for line in succeeds("nm", "-D", "--defined-only", library).splitlines()}
        table = "fp3_board_table" if library.name.startswith("fp3_board_") else "fp3_rtl_table"
        assert names == {{"fp3_hdf5.so": "fp3_hdf5_calls", "fp3_mpi.so": "fp3_mpi_calls"}.get(library.name, table)}, library


def test_the_installed_command_runs_the_installed_hardware(installed, root, expected, tmp_path):
    out = {engine: succeeds(installed / "bin/fp3", "run", root / "programs/ship.ode", "-n", "100", "-e", engine,
                            cwd=tmp_path) for engine in ("isa", "rtl")}
    assert out["isa"].splitlines()[:2] == out["rtl"].splitlines()[:2]
    (installed / "lib/fp3").rename(installed / "lib/away")
    try:
        done = run(installed / "bin/fp3", "run", root / "programs/ship.ode")
    finally:
        (installed / "lib/away").rename(installed / "lib/fp3")
    assert done.returncode == 1 and str(installed / "lib/fp3") in done.stderr


def test_the_working_directory_is_no_place_for_hardware(installed, root, tmp_path):
    """The command is found through PATH, so its own name has no directory."""
    (tmp_path / "fp3").mkdir()
    (tmp_path / "fp3/fp3_single.so").write_text("not for loading")
    succeeds("fp3", "run", root / "programs/ship.ode", "-n", "1", "-c", "single", "-i", "rk4_paper", cwd=tmp_path,
             env={**os.environ, "PATH": f"{installed / 'bin'}:{os.environ['PATH']}"})


def test_the_man_page_says_what_help_says(installed):
    page = installed / "share/man/man1/fp3.1"
    done = run("groff", "-man", "-ww", "-Tascii", "-P-cbou", page)
    assert done.returncode == 0 and done.stderr == ""
    shown = " ".join(done.stdout.split())
    commands = re.findall(r"^  (\w+)\t", succeeds(installed / "bin/fp3", "--help"), re.M)
    assert len(commands) > 5
    for command in commands:
        text = succeeds(installed / "bin/fp3", command, "--help")
        for option in set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", text, re.M)):
            assert option in shown, (command, option)


def test_shells_find_the_completion(installed):
    script = f"source {installed}/share/bash-completion/completions/fp3; COMP_WORDS=(fp3 doc); COMP_CWORD=1; _fp3; echo ${{COMPREPLY[*]}}"
    assert succeeds("bash", "-c", script) == "doctor\n"
    assert (installed / "share/zsh/site-functions/_fp3").read_text().startswith("#compdef fp3\n")


def test_uninstall_leaves_no_file(root, build, tmp_path):
    make(root, build, "install", tmp_path)
    assert (tmp_path / PREFIX / "lib/libfp3.so").resolve().name == "libfp3.so.0"
    make(root, build, "uninstall", tmp_path)
    assert [path for path in tmp_path.rglob("*") if not path.is_dir()] == []
    assert [path.name for path in tmp_path.rglob("*fp3*")] == []


def test_an_installation_for_another_place_changes_nothing_beside_it(root, build, tmp_path):
    """Tests and other installations use what build/ has. Only the installed library and command know the other place."""
    def files():
        return {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (*build.glob("lib/libfp3*"), build / "bin/fp3", build / "obj/sw/engine/common/install.o")}
    before = files()
    make(root, build, "install", tmp_path, "PREFIX=/opt/x")
    assert files() == before
    for name in ("libfp3.a", "libfp3_lab.a", "libfp3.so.0", "../bin/fp3"):
        assert b"/opt/x/lib/fp3\0" in (tmp_path / "opt/x/lib" / name).read_bytes(), name
        assert b"/usr/local/lib/fp3\0" not in (tmp_path / "opt/x/lib" / name).read_bytes(), name


@pytest.mark.parametrize("variable, value", [("PREFIX", "/tmp/a b"), ("PREFIX", "here"), ("PREFIX", ""), ("PREFIX", "/it's"),
                                             ("LIBDIR", "lib"), ("LIBDIR", "/a b"), ("DESTDIR", "/a b"), ("DESTDIR", "/a$b;c")])
@pytest.mark.parametrize("goal", ["install", "uninstall"])
def test_a_place_that_cannot_be_named_is_refused(root, variable, value, goal):
    env = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = run("make", "-n", "-C", root, goal, f"{variable}={value.replace('$', '$$')}", env=env)
    assert done.returncode == 2 and f"{variable} is '{value}': expected" in done.stderr, done.stderr
