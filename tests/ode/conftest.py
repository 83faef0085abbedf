"""What the tests of the model language share: a text, read by the driver tests/ode/language.c."""

import json
import subprocess

import pytest


@pytest.fixture
def language(build, tmp_path):
    """Runs the driver on a text (or bytes): `language(text, "x=1")`."""

    def run(text, *point, name="in.ode"):
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / name).write_bytes(data)
        return subprocess.run([build / "tests" / "language", "model", name, *point], cwd=tmp_path,
                              capture_output=True, timeout=60)

    return run


@pytest.fixture
def written(tmp_path):
    """Writes the text of a model to a file, for the command."""

    def write(text, name="m.ode"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write


@pytest.fixture
def model(language):
    """The model that a text describes."""

    def read(text, *point, **options):
        got = language(text, *point, **options)
        assert (got.returncode, got.stderr.decode(errors="replace")) == (0, "")
        return Model(json.loads(got.stdout))

    return read


@pytest.fixture
def errors(language):
    """The report on a text; there must be one."""

    def read(text, **options):
        got = language(text, **options)
        assert got.returncode == 2 and not got.stdout
        return got.stderr.decode(errors="strict")

    return read


@pytest.fixture
def constant(build):
    def run(text):
        return subprocess.run([build / "tests" / "language", "constant", text], capture_output=True,
                              text=True, timeout=60)

    return run


class Model(dict):
    """A dump, with ways to look into it."""

    def named(self, kind, name):
        return next(entry for entry in self[kind] if entry["name"] == name)

    def text(self, i):
        """An expression in prefix form: (ADD v 1)."""
        e = self["exprs"][i]
        match e["op"]:
            case "NUMBER":
                return f"{e['number']:g}"
            case "STATE":
                return self["states"][e["index"]]["name"]
            case "PARAM":
                return self["params"][e["index"]]["name"]
            case "TIME":
                return "t"
            case "INITIAL":
                return self["states"][e["index"]]["name"] + "(0)"
        parts = [self.text(operand) for operand in e["operand"] if operand is not None]
        return f"({' '.join([e['op'], *parts])})"

    def derivative(self, state):
        return self.text(self.named("states", state)["derivative"])

    def exact(self, state):
        return self.text(self.named("states", state)["exact"])

    def definition(self, name, kind="definitions"):
        return self.text(self.named(kind, name)["expr"])

    def value(self, name, kind="definitions"):
        return float(self["exprs"][self.named(kind, name)["expr"]]["value"])
