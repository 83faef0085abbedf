"""The bundles of rtl/ (NAME_FIELDS in a file *.vh) as numbers: fields by name, the last in the lowest bits."""

import os
import re
from pathlib import Path

RTL = Path(os.environ["FP3_RTL"])


class Bundle:
    """`dut` has the parameters that widths are made of."""

    def __init__(self, dut, name):
        text = next(text for text in (path.read_text() for path in RTL.rglob("*.vh")) if f"`define FP3_{name}_FIELDS" in text)
        body = re.search(rf"`define FP3_{name}_FIELDS((?:.*\\\n)*.*\n)", text)[1]
        self.fields = []                                   # (name, its lowest bit, its mask), the lowest first
        rows = [(re.sub(rf"^{name.lower()}_", "", field.strip()), self.width(dut, bits))
                for bits, fields in re.findall(r"wire\s+(?:\[([^\]]*)\])?\s*([^;]+);", body) for field in fields.split(",")]
        at = 0
        for field, width in reversed(rows):
            self.fields.append((field, at, (1 << width) - 1))
            at += width

    @staticmethod
    def width(dut, bits):
        if not bits:
            return 1
        high = re.sub(r"[A-Z_]+", lambda name: str(int(getattr(dut, name[0]).value)), bits.split(":")[0])
        return eval(high) + 1                              # a sum of numbers

    def pack(self, **values):
        word = 0
        for field, at, mask in self.fields:
            value = values.pop(field, 0)
            assert 0 <= value <= mask, f"{field} is {value}"
            word |= int(value) << at
        assert not values, f"no field {', '.join(values)}"
        return word

    def fields_of(self, word):
        return {field: word >> at & mask for field, at, mask in self.fields}


def settings(dut, **values):
    """The bundle SETTINGS: those that are not named are 0. The first is in the lowest bits."""
    word, at, text = 0, 0, (RTL / "gen/settings.vh").read_text()
    for bits, name in re.findall(r"wire \[(.+)-1:0\] setting_(\w+);", text):
        bits = re.sub(r"[A-Z_]+", lambda parameter: str(int(getattr(dut, parameter[0]).value)), re.sub(r"\d+'d|\$", "", bits))
        width, value = eval(bits, {"clog2": lambda n: (n - 1).bit_length()}), values.pop(name, 0)
        assert 0 <= value < 1 << width, f"{name} is {value}"
        word |= value << at
        at += width
    assert not values, f"no setting {', '.join(values)}"
    assert at == len(dut.settings_i)
    return word


def seen(port):
    """A port's value; bits that are not known are 0, so that fields beside them can be read."""
    return int(port.value.binstr.replace("x", "0").replace("z", "0"), 2)
