"""The numbers of a page, unpacked as sw/view/pack.h says: a second implementation, which shares no code with the page's."""

import base64
import json
import re
import zlib

import numpy


def differences(planes, rows, count, width):
    size = rows * count
    codes = sum(planes[1 + k * size:1 + (k + 1) * size].astype(numpy.uint32) << numpy.uint32(8 * k) for k in range(width)).astype(numpy.int64)
    return numpy.where(codes & 1, -(codes >> 1) - 1, codes >> 1).reshape(rows, count)


def unpack(text, rows, count, width):
    planes = numpy.frombuffer(zlib.decompress(base64.b64decode(text, validate=True)), numpy.uint8)
    assert len(planes) == 1 + rows * count * width
    d = differences(planes, rows, count, width)
    mask = (1 << 8 * width) - 1
    made = numpy.zeros((rows, count), numpy.int64)
    made[0] = numpy.cumsum(d[0]) & mask
    for row in range(1, rows):
        expected = made[row - 1] if row == 1 or planes[0] == 1 else 2 * made[row - 1] - made[row - 2]
        made[row] = (expected + d[row]) & mask
    return made


class Page:
    def __init__(self, path):
        text = path.read_text(encoding="utf-8")
        self.about = json.loads(re.search(r'<script type="application/json" id="about">(.*?)</script>', text, re.S)[1])
        self.texts = dict(re.findall(r'<script type="text/plain" id="(\w[\d-]+)">([^<]*)</script>', text))
        self.columns = {column["name"]: column for column in self.about["columns"]}

    def codes(self, name):
        number = list(self.columns).index(name)
        width = 4 if self.columns[name]["isFloat"] else 2
        return numpy.concatenate([unpack(self.texts[f"d{k}-{number}"], rows, self.about["objects"], width) for k, rows in enumerate(self.about["chunks"])])

    def values(self, name):
        column, codes = self.columns[name], self.codes(name)
        if column["isFloat"]:
            return codes.astype(numpy.uint32).view(numpy.float32)
        return numpy.where(codes == 65535, numpy.nan, column["low"] + codes * column["step"])

    def links(self, number=0):
        count = self.about["relations"][number]["links"]
        return unpack(self.texts[f"l{number}"], 1, 2 * count, 4).reshape(count, 2)
