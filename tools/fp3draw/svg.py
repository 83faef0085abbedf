"""One look for what three tools draw: colours by class for light and dark, one font, a page of its own behind everything."""

import re
from xml.etree import ElementTree

SVG = "http://www.w3.org/2000/svg"
XLINK = "{http://www.w3.org/1999/xlink}href"
FONT = "'DejaVu Sans',Verdana,Arial,sans-serif"   # the first is as wide as any: text that fits with it fits
# Of each colour what sources write, and what it is on a light and on a dark page.
PALETTE = {"page": ("#ffffff", "#ffffff", "#0d1117"), "ink": ("#000000", "#1f2328", "#e6edf3"), "muted": ("#666666", "#59636e", "#9aa5b1"),
           "accent": ("#0055aa", "#0550ae", "#79c0ff"), "alarm": ("#aa0000", "#b42318", "#ff8f85"),
           "blue": ("#cce0ff", "#d6e6ff", "#1b3a63"), "green": ("#cceecc", "#d5f0d8", "#1d4428"), "orange": ("#ffe0b3", "#ffe5c2", "#553a12"),
           "red": ("#ffcccc", "#ffd9d6", "#5c2422"), "violet": ("#e0ccff", "#e8dcff", "#3f2d66"), "grey": ("#e6e6e6", "#eceef0", "#2a3038")}
NAMES = {"black": "#000000", "#000": "#000000", "#888": "#666666", "white": "#ffffff", "transparent": "none"}
# WaveDrom's classes: stroke, fill, and what else.
WAVES = {"s1": ("ink", None, ""), "s2": ("muted", None, "stroke-width:.5"), "s3": ("ink", None, "stroke-dasharray:1,3"), "s4": ("ink", None, ""),
         "s5": (None, "page", ""), "s6": (None, "ink", ""), "s7": (None, "page", ""), "s8": (None, "orange", ""), "s9": (None, "grey", ""),
         "s10": (None, "blue", ""), "s11": (None, "violet", ""), "s12": (None, "green", ""), "s13": (None, "violet", ""), "s14": (None, "red", "")}
STEP = 8.2                                         # the width of a letter of a wave's name, with room


def colour_class(value, kind):
    """The class for a colour of a tool, or None where there is none."""
    value = value.strip().lower()
    value = NAMES.get(value, value)
    if value == "none":
        return None
    rgb = re.fullmatch(r"rgb\((\d+),(\d+),(\d+)\)", value)
    if rgb:
        value = "#" + "".join(f"{int(part):02x}" for part in rgb.groups())
    found = [name for name, colours in PALETTE.items() if colours[0] == value]
    if not found:
        raise ValueError(f"the colour {value} is not in the palette of tools/fp3draw/svg.py")
    return kind + found[0]


def take_colours(one):
    """Colours of an element become classes."""
    said = dict(part.split(":", 1) for part in one.attrib.pop("style", "").split(";") if ":" in part)
    said = {name.strip(): value.strip() for name, value in said.items()}
    classes = [name for name in one.attrib.pop("class", "").split() if name in WAVES or name in ("muted", "info")]
    for name, kind in (("fill", "f-"), ("stroke", "s-")):
        value = said.pop(name, None) or one.attrib.pop(name, None)
        if value:
            found = colour_class(value, kind)
            classes += [found] if found else []
            if not found:
                one.set(name, "none")
    for name in ("stroke-width", "stroke-dasharray", "stroke-linejoin"):
        if name in said:
            one.set(name, said[name])
    if classes:
        one.set("class", " ".join(classes))


def take_text(one):
    """Font by style of the whole; the middle of a line by y, which every reader knows."""
    one.attrib.pop("font-family", None)
    size = one.attrib.pop("font-size", None)
    size = {None: None, "80%": 12.0, "125%": 16.0}.get(size) if size in (None, "80%", "125%") else float(size.rstrip("px"))
    if size:
        assert size >= 12, f"text of {size} px: {''.join(one.itertext())}"
        one.set("font-size", f"{size:g}")
    if one.attrib.pop("dominant-baseline", None):
        one.set("y", f"{float(one.get('y')) + 0.35 * (size or 13):.2f}")


def take_code(one):
    """What a source has between ` ` is in type of code."""
    before, *rest = one.text.split("`")
    one.text = before
    for code, after in zip(rest[::2], rest[1::2], strict=True):
        part = ElementTree.SubElement(one, f"{{{SVG}}}tspan", {"class": "code"})
        part.text, part.tail = code, after


def without(root, dropped):
    for parent in root.iter():
        for child in [child for child in parent if dropped(child)]:
            parent.remove(child)


def view(root, margin):
    """The frame, in pixels: what the tool says, a margin, and on the left room for the names of waves."""
    left, top, width, height = (float(part) for part in re.split("[ ,]+", root.get("viewBox")))
    names = [len("".join(one.itertext())) for one in root.iter(f"{{{SVG}}}text") if one.get("class") == "info"]
    if names:
        lanes = next(one for one in root.iter(f"{{{SVG}}}g") if one.get("id") == "lanes_0")
        less = max(names) * STEP + 10 - float(re.search(r"\(([\d.]+)", lanes.get("transform"))[1])
        left, width = left - less, width + less
    return left - margin, top - margin, width + 2 * margin, height + 2 * margin


def style(used):
    """The rules that are needed, for a light and for a dark page."""
    def rules(which):
        colour = {name: colours[which] for name, colours in PALETTE.items()}
        out = [f".page{{fill:{colour['page']}}}", f"text{{fill:{colour['ink']}}}"]
        for name in sorted(used):
            if name in WAVES:
                stroke, fill, more = WAVES[name]
                out.append(f".{name}{{fill:{colour[fill] if fill else 'none'};stroke:{colour[stroke] if stroke else 'none'};{more}}}")
            elif name == "code":
                out.append(".code{font-family:'DejaVu Sans Mono',monospace}")
            elif name in ("muted", "info"):
                out.append(f".{name}{{fill:{colour['muted' if name == 'muted' else 'ink']}}}")
            elif name[:2] in ("f-", "s-"):
                out.append(f".{name}{{{'fill' if name[0] == 'f' else 'stroke'}:{colour[name[2:]]}}}")
        return "".join(out)

    return f"svg{{font:13px {FONT}}}{rules(1)}@media(prefers-color-scheme:dark){{{rules(2)}}}"


def themed(text, margin=8):
    """What a tool has drawn, in our colours."""
    ElementTree.register_namespace("", SVG)
    root = ElementTree.fromstring(text)
    bricks = {one.get(XLINK)[1:] for one in root.iter(f"{{{SVG}}}use")}   # WaveDrom brings all that it has
    for defs in root.iter(f"{{{SVG}}}defs"):
        without(defs, lambda one: one.tag in (f"{{{SVG}}}g", f"{{{SVG}}}marker") and one.get("id") not in bricks)
    without(root, lambda one: one.tag in (f"{{{SVG}}}title", f"{{{SVG}}}style"))
    for one in root.iter():
        if XLINK in one.attrib:
            one.set("href", one.attrib.pop(XLINK))
        if one is not root:
            take_colours(one)
        if one.tag == f"{{{SVG}}}text":
            take_text(one)
        one.attrib.pop("{http://www.w3.org/XML/1998/namespace}space", None)
    frame = view(root, margin)
    for one in root.iter():
        if one.get("id") not in bricks:
            one.attrib.pop("id", None)
    for one in list(root.iter()):
        if "`" in (one.text or ""):
            take_code(one)
    used = {name for one in root.iter() if one is not root for name in one.get("class", "").split()}
    root.attrib.clear()
    root.set("viewBox", " ".join(f"{part:g}" for part in frame))
    root.set("width", f"{frame[2]:g}")
    root.set("height", f"{frame[3]:g}")
    page = ElementTree.Element(f"{{{SVG}}}rect", {"class": "page", "x": f"{frame[0]:g}", "y": f"{frame[1]:g}", "width": "100%", "height": "100%"})
    sheet = ElementTree.Element(f"{{{SVG}}}style")
    sheet.text = style(used)
    root[:0] = [sheet, page]
    for one in root.iter():                                     # a line for each element
        one.tail = one.tail if one.get("class") == "code" else None if one.tag.endswith("}tspan") else "\n"
        if one.tag.endswith(("}g", "}svg", "}defs")):
            one.text = "\n"
    return ElementTree.tostring(root, encoding="unicode") + "\n"
