"""Hostile files in libconfig's syntax: scenes, values and tables of integrators. Each is refused by name, line and limit, or
read as what it says."""

import re
import struct
import subprocess

import pytest

pytestmark = pytest.mark.smoke

ONE = ".state x\n.param T\n.shared h\nstep:\n    madd x, h, T, x\n"
MODEL = "param k = 1\nstate v = 0\nstate x = 1\nstep 0.0078125\nv' = -k*x\nx' = v\n"
FILES = {"one.s": ONE, "swing.ode": MODEL}
GROUP = '{ program = "one.s"; objects = 2; set = { x = 1.0; T = 2.0; h = 0.5; }; }'
BOM = b"\xef\xbb\xbf"


def scene(*lines, config='config = "many";'):
    return "\n".join([config, *lines])


def grouped(settings="", group=GROUP, config='config = "many";'):
    """Line 1: the configuration. Line 2: settings. Line 3: groups. Line 4: the group."""
    return "\n".join([config, settings, "groups = (", group, ");"])


def setting(text):
    """A group whose set is on line 5."""
    return grouped(group='{ program = "one.s"; objects = 2; set = {\n%s }; }' % text)


def swing(text=""):
    return grouped(group='{ program = "swing.ode"; objects = 2;\n%s }' % text)


# ---- scenes -------------------------------------------------------------------------------------

SCENES = [
    # text, what the message says
    ("", r"x\.scene:1: expected config = "),
    ("\0", r"x\.scene:1: found a NUL byte, expected text"),
    ("config = \"many\";\n\n# a comment\0\n", r"x\.scene:3: found a NUL byte"),
    (b"\xff\xfe\x00s\x00t", r"x\.scene:1: found a NUL byte"),
    (b"\xff\xfegroups", r"x\.scene:1: syntax error, expected settings as name = value;"),
    (b"\x1f\x8b\x08" + bytes(range(1, 64)), r"x\.scene:\d+: "),
    ("{", r"x\.scene:\d: syntax error"),
    ("}", r"x\.scene:\d: syntax error"),
    (")" * 1000, r"x\.scene:\d: syntax error"),
    ("groups = " + "(" * 17, r"x\.scene:1: expected groups and lists within each other at most 16 deep"),
    ("groups = " + "(" * 100000, r"x\.scene:1: expected groups and lists within each other at most 16 deep"),
    ("a = " + "{b = " * 100000, r"x\.scene:1: expected groups and lists within each other at most 16 deep"),
    ("\n@include \"other.cfg\"\n", r"x\.scene:2: found '@', expected settings: @include is not read"),
    (scene('  @include "/etc/passwd"'), r"x\.scene:2: found '@'"),
    (scene("groups = (", "/* no end", "steps = 3;"), r"x\.scene:3: found a comment without an end, expected '\*/'"),
    (scene('engine = "isa;', "steps = 3;"), r"x\.scene:2: found a text without an end, expected '\"'"),
    (scene('engine = "isa\\"'), r"x\.scene:2: found a text without an end"),
    (scene('engine = "isa\\'), r"x\.scene:2: found a text without an end"),
    (scene("steps = 3 4;"), r"x\.scene:2: syntax error"),
    (scene('steps = 3 "4";'), r"x\.scene:2: syntax error"),
    (scene("steps = 3; steps = 4;"), r"x\.scene:2: duplicate setting name"),
    (scene("step = 3;"), r"x\.scene:2: found 'step', expected a setting of a scene: .* \(did you mean 'steps'\?\)"),
    (scene("GROUPS = 3;"), r"x\.scene:2: found 'GROUPS', .* \(did you mean 'groups'\?\)"),
    (scene("%s = 3;" % ("x" * 5000)), r"x\.scene:2: found 'xxx"),
    (scene("\n".join(f"a{i} = 1;" for i in range(1100))), r"x\.scene:1025: expected at most 1024 settings in a group"),
    (scene("visit = 1;", config='config = "maany";'), r"x\.scene:1: config: no configuration 'maany': there are .*single"),
    (scene(config='config = "";'), r"x\.scene:1: config: no configuration ''"),
    (scene(config="config = 7;"), r"x\.scene:1: config: found '7', expected a text in quotes"),
    (scene(config='config = "many\x01";'), r"x\.scene:1: config: no configuration 'many\?'"),
    (grouped('engine = "rt";'), r"x\.scene:2: engine: no engine 'rt': there are rtl, isa, fast and board"),
    (grouped("engine = true;"), r"x\.scene:2: engine: found true or false, expected a text"),
    # counts: 2^32 is 0 and 2^32 + 1 is 1 to libconfig
    (grouped("steps = 4294967296;"), r"x\.scene:2: steps: found '4294967296', expected an integer from 0 to 4294967295"),
    (grouped("steps = 4294967297;"), r"x\.scene:2: steps: found '4294967297', expected an integer"),
    (grouped("steps = 4294967296L;"), r"x\.scene:2: steps: found '4294967296L', expected an integer"),
    (grouped("steps = 18446744073709551616;"), r"x\.scene:2: steps: found '18446744073709551616', expected an integer"),
    (grouped("steps = 18446744073709551617L;"), r"x\.scene:2: steps: found '18446744073709551617L', expected an integer"),
    (grouped("steps = 0x100000000;"), r"x\.scene:2: steps: found '0x100000000', expected an integer"),
    (grouped("steps = 0x10000000000000001;"), r"x\.scene:2: steps: found '0x10000000000000001', expected an integer"),
    (grouped("steps = 0xfffffffffffffffff;"), r"x\.scene:2: steps: found "),
    (grouped("steps = %s;" % ("9" * 300)), r"x\.scene:2: steps: found '9999"),
    (grouped("steps = -1;"), r"x\.scene:2: steps: found '-1', expected an integer from 0 to 4294967295"),
    (grouped("steps = -18446744073709551615;"), r"x\.scene:2: steps: found '-18446744073709551615', expected"),
    (grouped("steps = 1e3;"), r"x\.scene:2: steps: found '1e3', expected an integer"),
    (grouped("steps = 1.0;"), r"x\.scene:2: steps: found '1\.0', expected an integer"),
    (grouped("steps = .;"), r"x\.scene:2: steps: found '\.', expected an integer"),
    (grouped("steps = 12abc;"), r"x\.scene:2: steps: found '12abc', expected an integer"),
    (grouped("steps = 1_000;"), r"x\.scene:2: steps: found '1_000', expected an integer"),
    (grouped("steps = 0x;"), r"x\.scene:2: steps: found '0x', expected an integer"),
    (grouped("steps = 0b11;"), r"x\.scene:2: steps: found '0b11', expected an integer"),
    (grouped("steps = 1LLL;"), r"x\.scene:2: steps: found '1LLL', expected an integer"),
    (grouped("steps = true;"), r"x\.scene:2: steps: found true or false, expected an integer"),
    (grouped("steps = [1];"), r"x\.scene:2: steps: found a list \[ \] of 1, expected an integer"),
    (grouped("visit = 0;"), r"x\.scene:2: visit: found '0', expected an integer from 1 to 4294967295"),
    (grouped("visit = 4294967296;"), r"x\.scene:2: visit: found '4294967296', expected an integer from 1 to 4294967295"),
    # h
    (grouped("h = 0;"), r"x\.scene:2: h: found '0', expected a time step from 1\.4e-45 to 3\.4028235e38"),
    (grouped("h = -0.5;"), r"x\.scene:2: h: found '-0\.5', expected a time step"),
    (grouped("h = 1e-50;"), r"x\.scene:2: h: found '1e-50', expected a time step"),
    (grouped("h = 1e50;"), r"x\.scene:2: h: found '1e50', expected a time step"),
    (grouped("h = 1e-400;"), r"x\.scene:2: h: found '1e-400', expected 0 or a number above 4\.9e-324"),
    (grouped("h = 1e400;"), r"x\.scene:2: h: found '1e400', expected a number below 1\.8e308"),
    (grouped("h = 0x1p-7;"), r"x\.scene:2: h: found '0x1p-7', expected a number as 2, 0\.5, 1\.5e-3 or 0x1f"),
    (grouped("h = 1-7;"), r"x\.scene:2: syntax error"),
    (grouped("h = --7;"), r"x\.scene:2: syntax error"),
    (grouped("h = -+7;"), r"x\.scene:2: syntax error"),
    (grouped("h = - 7;"), r"x\.scene:2: syntax error"),
    (grouped("h = 1+7;"), r"x\.scene:2: syntax error"),
    (grouped("h = 0x1-7;"), r"x\.scene:2: syntax error"),
    (grouped("h = nan;"), r"x\.scene:2: syntax error"),
    (grouped("h = -inf;"), r"x\.scene:2: syntax error"),
    (grouped("h = \"0.5\";"), r"x\.scene:2: h: found a text, expected a number"),
    # groups
    (scene("groups = { };"), r"x\.scene:2: groups: found a group \{ \}, expected a list"),
    (scene("groups = [ ];"), r"x\.scene:2: groups: found a list"),
    (scene("groups = (", ");"), r"x\.scene:2: expected a group in groups"),
    (scene("groups = (", "7 );"), r"x\.scene:3: expected a group, \{ program = "),
    (grouped(group="( %s )" % GROUP), r"x\.scene:4: expected a group, \{ program = "),
    (grouped(group=", ".join(2 * [GROUP])), r"x\.scene:3: found 2 groups, .* configuration 'many' has 1 scheduler$"),
    (grouped(group=",\n".join(5 * [GROUP]), config='config = "array";'), r"x\.scene:3: found 5 groups, .* 'array' has 4 schedulers"),
    (grouped(group=GROUP.replace("2;", "4294967296;", 1)), r"x\.scene:4: objects: found '4294967296', expected an integer from 1 to 4294967295"),
    (grouped(group=GROUP.replace("2;", "4294967298;", 1)), r"x\.scene:4: objects: found '4294967298', expected an integer"),
    (grouped(group=GROUP.replace("2;", "-4294967294;", 1)), r"x\.scene:4: objects: found '-4294967294', expected an integer"),
    (grouped(group=GROUP.replace("2;", "1000000;", 1)), r"x\.scene:4: objects: found 1000000, expected at most \d+: configuration 'many' has room for"),
    (grouped(group=GROUP.replace("2;", "0;", 1)), r"x\.scene:4: objects: found '0', expected an integer from 1"),
    (grouped(group=GROUP.replace("objects", "object")), r"x\.scene:4: found 'object', .* \(did you mean 'objects'\?\)"),
    (grouped(group=GROUP.replace("one.s", "")), r"x\.scene:4: found program '', expected a name that ends in"),
    (grouped(group=GROUP.replace("one.s", "none.s")), r"x\.scene:4: none\.s: cannot open"),
    (grouped(group=GROUP.replace("one.s", "x.scene")), r"x\.scene:4: found program 'x\.scene', expected a name that ends in"),
    (swing('integrator = "rk5";'), r"x\.scene:4: .*no integrator 'rk5': there are "),
    (swing('integrator = "none.cfg";'), r"x\.scene:4: .*none\.cfg: cannot open"),
    (swing("integrator = 4;"), r"x\.scene:5: integrator: found '4', expected a text"),
    (swing("compensated = 1;"), r"x\.scene:5: compensated: found '1', expected true or false"),
    (swing("set = { h = 0; };"), r"x\.scene:5: 'h' is 0: expected a time step"),
    (swing("set = { h = -1; };"), r"x\.scene:5: 'h' is -1: expected a time step"),
    (swing("set = { h = 1e-46; };"), r"x\.scene:5: 'h' is 1e-46: expected a time step"),
    (swing("spread = { h = [0.5, 1]; };"), r"x\.scene:5: 'h' is spread"),
    (swing("set = { k = 1e300; };"), r"x\.scene:4: -k \(line 5 of the model\) is -1e\+?\d+: expected a number below 3\.4028236e38"),
    (swing("set = { q = 1; };"), r"x\.scene:5: the program has no 'q'"),
    (setting("x = 1; h = 1; " "T = 1e39;"), r"x\.scene:5: 'T' is 1e\+39: expected a number below 3\.4028236e38, the end of FP32"),
    (setting("x = 1; h = 1; " "T = -1e39;"), r"x\.scene:5: 'T' is -1e\+39: expected a number below"),
    (setting("T = 1e400;"), r"x\.scene:5: T: found '1e400', expected a number below 1\.8e308"),
    (setting("x = 1; h = 1; " + "T = %s;" % ("1" + "0" * 60)), r"x\.scene:5: 'T' is 1e\+60: expected a number below"),
    (setting("T = 0x10000000000000000;"), r"x\.scene:5: T: found '0x10000000000000000', expected an integer below 2\^64"),
    (setting("T = 0.%s1;" % ("0" * 300)), r"x\.scene:5: T: found '0\.000.*, expected a number of fewer than 256 characters"),
    (setting("T = 1.5L;"), r"x\.scene:5: T: found '1\.5L', expected a number"),
    (setting("T = 1..5;"), r"x\.scene:5: T: found '1\.\.5', expected a number"),
    (setting("x = 1; h = 1; T = \"1/T\";"), r"x\.scene:5: 'T' is computed from itself"),
    (setting("T = \"1/x\"; x = 0;"), r"x\.scene:5: 'T' is 1/x: column 1: found '1', expected a finite value"),
    (setting("T = (1, 2);"), r"x\.scene:5: T: found a list \( \) of 2, expected a number or"),
    (setting("a-b = 1;"), r"x\.scene:5: 'a-b' is no name"),
    (setting("%s = 1;" % ("n" * 40)), r"x\.scene:5: 'n+' is no name"),
    (setting("x = 1; h = 0.5;"), r"x\.scene:4: 'T' has no value"),
]


@pytest.mark.parametrize("text, message", SCENES, ids=map(str, range(len(SCENES))))
def test_a_hostile_scene_is_refused(refused, text, message):
    refused({**FILES, "x.scene": text}, ["run", "--engine", "rtl", "--scene", "x.scene", "--bus-log", "log"], "^fp3 run: " + message)


# ---- values -------------------------------------------------------------------------------------

GOOD = "x = 1; T = 2; h = 0.5;"
VALUES = [
    ("x = 1; T = 2;\nh = 0;", r"x\.cfg:2: 'h' is 0: expected a time step from 1\.4e-45"),
    ("x = 1; T = 2;\nh = -1;", r"x\.cfg:2: 'h' is -1: expected a time step"),
    ("x = 1;\n\nT = 3.5e38; h = 1;", r"x\.cfg:3: 'T' is 3\.5e\+38: expected a number below"),
    (GOOD + "\ny = 1;", r"x\.cfg:2: the program has no 'y'"),
    (GOOD + "\nx = 1;", r"x\.cfg:2: duplicate setting name"),
    (GOOD + "\n@include \"x.cfg\"", r"x\.cfg:2: found '@'"),
    ("x = 1; T = ; h = 1;", r"x\.cfg:1: syntax error"),
    ("x = 1; h = 1; T = \"fast\";", r"x\.cfg:1: 'T' is fast: 'fast' has no value"),
    ("\nT = { a = 1; };", r"x\.cfg:2: T: found a group \{ \}, expected a number"),
    ("\nT = 0777777777777777777777777777777x;", r"x\.cfg:2: T: found '07+x', expected a number as 2, 0\.5"),
    ("\n".join(f"p{i} = 1;" for i in range(100000)), r"x\.cfg:1025: expected at most 1024 settings in a group"),
    ("T = (" + "1, " * 200000 + "1);", r"x\.cfg:1: T: found a list \( \) of 200001, expected a number"),
    ('T = "%s";' % ("a" * 1000000), r"x\.cfg:1: T: found a text, expected a number"),
]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("text, message", VALUES, ids=map(str, range(len(VALUES))))
def test_hostile_values_are_refused(refused, text, message, engine):
    refused({**FILES, "x.cfg": text}, ["run", "one.s", "--engine", engine, "--params", "x.cfg"], "^fp3 run: " + message)


SETS = [
    ("T=1e999", r"'T=1e999': '1e999' is no number: .*expected a number below 1\.8e308"),
    ("T=1e-999", r"'T=1e-999': '1e-999' is no number: .*expected 0 or a number above 4\.9e-324"),
    ("T=1e39", r"'T' is 1e\+39: expected a number below 3\.4028236e38, the end of FP32"),
    ("T=", r"'T=': '' is no number"),
    ("T= 1x", r"'T= 1x': ' 1x' is no number"),
    ("h=0", r"'h' is 0: expected a time step"),
    ("h=-0.5", r"'h' is -0\.5: expected a time step"),
    ("h=nan", r"'h' is nan: expected a time step"),
    ("h=inf", r"'h' is inf: expected a time step"),
    ("h=1e-60", r"'h' is 1e-60: expected a time step"),
    ("h=2^-200", r"'h' is 6\.\d+e-61: expected a time step"),
]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("text, message", SETS, ids=map(str, range(len(SETS))))
def test_a_hostile_set_is_refused(refused, text, message, engine):
    refused({**FILES, "x.cfg": GOOD}, ["run", "one.s", "--engine", engine, "--params", "x.cfg", "--set", text],
            "^fp3 run: " + message)


@pytest.mark.parametrize("h", ["0", "-0.5", "nan", "1e-60", "inf"])
def test_a_model_has_a_time_step_above_0(refused, h):
    refused(FILES, ["run", "swing.ode", "--engine", "isa", "--set", f"h={h}"], "^fp3 run: 'h' is .*: expected a time step from 1.4e-45")


# ---- integrators --------------------------------------------------------------------------------

HEAD = 'name = "mine"; doc = "d"; source = "s"; kind = "runge-kutta"; order = 1;\n'
TABLE = HEAD + "A = (());\nb = (1);\n"
TABLES = [
    ("", r"mine\.cfg:1: found no 'kind', expected one"),
    (TABLE.replace("(1)", "(4294967297)"), r"mine\.cfg:3: b: found the sum 4294967297, expected 1"),
    (TABLE.replace("(1)", "(18446744073709551617)"), r"mine\.cfg:3: b: found the sum 1\.84467440737e\+19, expected 1"),
    (TABLE.replace("(1)", "(0x100000001)"), r"mine\.cfg:3: b: found the sum 4294967297, expected 1"),
    (TABLE.replace("(1)", "(1e400)"), r"mine\.cfg:3: b\[1\]: found '1e400', expected a number below 1\.8e308"),
    (TABLE.replace("(1)", "(1e-400)"), r"mine\.cfg:3: b\[1\]: found '1e-400', expected 0 or a number above 4\.9e-324"),
    (TABLE.replace("(1)", '("1e400")'), r"mine\.cfg:3: b\[1\]: .*expected a number below 1\.8e308"),
    (TABLE.replace("(1)", '("1/0")'), r"mine\.cfg:3: b\[1\]: .*expected a finite value"),
    (TABLE.replace("(1)", "(1.)").replace("order = 1", "order = 4294967297"),
     r"mine\.cfg:1: order: found '4294967297', expected an integer from 1 to 8"),
    (TABLE.replace("order = 1", "order = -4294967295"), r"mine\.cfg:1: order: found '-4294967295', expected"),
    (TABLE.replace("order = 1", "ordr = 1"), r"mine\.cfg:1: found 'ordr', .* \(did you mean 'order'\?\)"),
    (TABLE.replace("(())", "((0, 0))"), r"mine\.cfg:2: A\[1\]: found the length 2, expected 0"),
    (TABLE + "/*", r"mine\.cfg:4: found a comment without an end"),
    (TABLE + "@include \"mine.cfg\"", r"mine\.cfg:4: found '@'"),
    (TABLE + "\0", r"mine\.cfg:.*found a NUL byte"),
    (TABLE.replace("(())", "(" * 100 + ")" * 100), r"mine\.cfg:2: expected groups and lists within each other"),
    (TABLE.replace("(1)", "(" + "1, " * 100000 + "1)"), r"mine\.cfg:3: b: found the length 100001, expected 1"),
]


@pytest.mark.parametrize("text, message", TABLES, ids=map(str, range(len(TABLES))))
def test_a_hostile_table_is_refused(refused, text, message):
    refused({**FILES, "mine.cfg": text}, ["compile", "swing.ode", "--integrator", "./mine.cfg", "-o", "out.s"], r"\./" + message)


# ---- what is strange and right ------------------------------------------------------------------

def bits(number):
    return "0x%08x" % struct.unpack("<I", struct.pack("<f", number))[0]


RIGHT = [
    # how T is spelled, what it is; x is 0 + 1 * T after a step
    ("210000000000", 210000000000.0),
    ("4294967296", 4294967296.0),
    ("2147483648", 2147483648.0),
    ("-2147483649", -2147483649.0),
    ("0xffffffff", 4294967295.0),
    ("0xFFFFFFFFFFFFFFFFLL", 18446744073709551615.0),
    ("18446744073709551616", 18446744073709551616.0),
    ("100000000000000000000000000000000000000", 1e38),
    ("1L", 1.0),
    ("+3", 3.0),
    ("-.5e1", -5.0),
    ("7.", 7.0),
    ("1e-45", 1.4012984643248170709e-45),
    ("3.4028235e38", 3.4028235e38),
    ("16777217", 16777216.0),
]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("text, number", RIGHT, ids=map(str, range(len(RIGHT))))
def test_a_number_is_what_its_digits_say(hostile, text, number, engine):
    """From a file of values; the same from a scene."""
    done = hostile({**FILES, "x.cfg": f"x = 0; h = 1; T = {text};"}, ["run", "one.s", "--engine", engine, "--params", "x.cfg"])
    assert done.returncode == 0 and f" {bits(number)} ".encode() in done.stdout, done
    done = hostile({"x.scene": setting(f"x = 0; h = 1; T = {text};")}, ["run", "--scene", "x.scene", "--engine", engine])
    assert done.returncode == 0 and done.stdout.count(f" {bits(number)} ".encode()) == 2, done


@pytest.mark.parametrize("text", [
    BOM + b"x = 0; h = 1; T = 8;",
    b"x = 0\r\nh = 1\r\nT = 8\r\n",
    b"x : 0, h : 1, T : 8 // steps = 4294967296",
    b"/* T = 9; @include \"a\" \" */ x = 0; h = 1; # \"T = 9\nT = 8; #",
    b"x = 0; h = 1; T\n=\n\n8",
    b"x=0;h=1;T=8",
])
def test_a_strange_file_is_read(hostile, text):
    done = hostile({**FILES, "x.cfg": text}, ["run", "one.s", "--engine", "isa", "--params", "x.cfg"])
    assert done.returncode == 0 and bits(8.0).encode() in done.stdout, done


def test_a_mark_in_front_of_a_scene_and_a_table_is_no_error(hostile):
    done = hostile({**FILES, "x.scene": BOM + swing('integrator = "mine.cfg";').encode(), "mine.cfg": BOM + TABLE.encode()},
                   ["run", "--scene", "x.scene", "--engine", "isa"])
    assert done.returncode == 0, done.stderr


def test_libconfig_sees_the_numbers_that_were_replaced_and_no_other(build):
    """50,000 damaged files; to repeat: build/tests/spelled 1 50000."""
    done = subprocess.run([build / "tests/spelled", "1", "50000"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    read, refused = map(int, re.findall(r"\d+", done.stdout))
    assert read > 1000 and refused > 1000
