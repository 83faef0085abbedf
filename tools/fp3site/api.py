"""Pages of the public headers: each declaration with what its comment says, names that lead to each other, errors as a list."""

import re

ROLES = {"function": "func", "struct": "struct", "enum": "enum", "type": "type", "macro": "macro", "enumerator": "enumerator"}
NAME = r"(?:fp3|FP3)_\w+"
COMMENT = r"/\*(?:.|\n)*?\*/"


def comment(text):
    """What a comment says: prose as it is, what stands indented as code."""
    lines = text.strip().removeprefix("/*").removesuffix("*/").splitlines()
    lines = [re.sub(r"^ ?\*? ?", "", line.strip() if line.startswith("    ") else line) for line in lines]
    return "\n".join(line.rstrip() for line in lines).strip("\n")


def blocks(text):
    """Parts between empty lines, of which none is inside of braces."""
    part, depth = [], 0
    for line in [*text.splitlines(), ""]:
        if line or depth:
            part.append(line)
        elif part:
            yield "\n".join(part)
            part = []
        code = re.sub(r"/\*.*?\*/|\"[^\"]*\"", "", line)
        depth += code.count("{") - code.count("}")


def declarations(block):
    """Comments and declarations of a block, in order: ("text", ...) and ("code", ...)."""
    while block := block.lstrip("\n"):
        if found := re.match(COMMENT, block):
            yield "text", comment(found[0])
        elif found := re.match(r"#(?:.*\\\n)*.*", block):
            yield "code", found[0]
        else:
            lines, depth = [], 0
            for line in block.splitlines():
                lines.append(line)
                bare = re.sub(r"\"[^\"]*\"", "", re.sub(r"/\*.*?\*/|/\*.*$", "", line))
                depth += bare.count("{") - bare.count("}")
                if depth == 0 and re.search(r"[;}]\s*$", bare):
                    break
            code = "\n".join(lines)
            found = re.match(re.escape(code) + r"(?: *" + COMMENT + ")?", block)
            yield "code", found[0]
        block = block[found.end():]


def plain(code):
    """On one line and without comments."""
    return re.sub(r"\s+", " ", re.sub(COMMENT, " ", code)).strip().removesuffix(";").strip()


class Declaration:
    """kind: a directive of Sphinx's domain C, or "" for what it cannot say. What the code itself says of it: about and members."""

    def __init__(self, code):
        self.code, self.kind, self.name, self.about, self.members = code, "", "", "", ""
        bare = plain(code)
        if found := re.match(rf"#define ({NAME}(?:\([\w, ]*\))?)", code):
            self.kind, self.signature = "macro", found[1]
            said = re.search(r"/\*(?:.|\n)*\*/\s*$", code)
            value = code[found.end():said.start() if said else len(code)].strip()
            short = filter(None, [f"`{value}`" if value else "", comment(said[0]) if said else ""])
            self.about = f"```c\n{code}\n```" if "\\\n" in code else "\n\n".join(short)
        elif found := re.fullmatch(rf"typedef (struct|enum) (?:\w+ )?\{{(.*)\}} ({NAME})", bare):
            self.kind, self.signature, body = found[1], found[3], code[code.index("{") + 1:code.rindex("}")]
            # A row of X-macros, or a struct in a struct, is shown as it is.
            if re.search(r"[{#]" if self.kind == "struct" else r"[(#]", re.sub(COMMENT, "", body)):
                self.about = f"```c\n{code}\n```"
            else:
                self.members = body
        elif found := re.fullmatch(rf"typedef struct \w+ ({NAME})", bare):
            self.kind, self.signature = "type", found[1]
        elif found := re.fullmatch(rf"typedef (.*?\b{NAME}\(.*\))", bare):
            self.kind, self.signature = "type", found[1]
        elif found := re.match(rf"(?:static inline )?([\w* ]+?\b{NAME}\((?:[^(){{]|\([^()]*\))*\))", bare):
            self.kind, self.signature = "function", found[1]
        if self.kind:
            self.name = re.search(rf"({NAME})\(" if "(" in self.signature else rf"({NAME})$", self.signature)[1]

    def names(self):
        """Every name that a reader may look for, with its kind."""
        if self.kind:
            yield self.name, self.kind
        if self.kind == "enum":
            yield from ((name, "enumerator") for name in re.findall(rf"^\s*({NAME})", re.sub(COMMENT, "", self.members), re.M))


class Header:
    def __init__(self, path):
        _, _, text = path.read_text(encoding="utf-8").partition("\n")
        intro, _, _ = text.partition("*/")
        title, _, self.about = comment(intro).partition("\n\n")
        name, dash, what = " ".join(title.split()).partition(" - ")
        self.title, self.what = (name, what[:1].upper() + what[1:]) if dash else (f"fp3/{path.name}", name)
        body = text.rpartition("\nFP3_API_BEGIN\n")[2].partition("\nFP3_API_END")[0] if "\nFP3_API_BEGIN\n" in text else text.partition("*/")[2]
        self.body = re.sub(r"^#ifndef (\w+_H)\n#define \1\n(/\* clang-format off \*/)?|^#endif.*$|^#include.*$", "", body, flags=re.M)
        self.parts = [[(kind, Declaration(found) if kind == "code" else found) for kind, found in declarations(block)] for block in blocks(self.body)]

    def names(self):
        return {name: kind for part in self.parts for kind, found in part if kind == "code" for name, kind in found.names()}


def sentences(text):
    return re.split(r"(?<=[^.]\.) (?=[A-Za-z*`\"(])", text)


class Pages:
    def __init__(self, paths):
        self.headers = {path: Header(path) for path in paths}
        self.stems = {path.stem for path in paths}
        self.names = {name: kind for header in self.headers.values() for name, kind in header.names().items()}

    def linked(self, text):
        """Prose of a comment, in which names lead to their places."""
        def role(found):
            return f"{{c:{ROLES[self.names[found[1]]]}}}`{found[1]}`" if found[1] in self.names else found[0]
        def prose(part):
            part = re.sub(r"(?<![\w*])\*(\w+)(?!\*)", r"`*\1`", re.sub(rf"(?<![\w/.])({NAME})\b(?:\(\))?", role, part))
            part = re.sub(r"\bdocs/([\w/]+\.md)(#[\w-]+)?", r"[\1](../\1\2)", part)
            return re.sub(r"\bfp3/(\w+)\.h\b", lambda found: f"[{found[0]}]({found[1]}.md)" if found[1] in self.stems else found[0], part)
        return "".join(part if part.startswith("`") else prose(part) for part in re.split(r"(`[^`\n]+`)", text))

    def page_linked(self, text):
        """A page of docs, whose names of the library in type of code lead to their places. Links, headings and code stay as they are."""
        def role(found):
            return f"{{c:{ROLES[self.names[found[1]]]}}}`{found[1]}`" if found[1] in self.names else found[0]
        return re.sub(rf"```[\s\S]*?```|\[[^\[\]]*\]\([^()\s]*\)|^(?: {{4}}|#)[^\n]*|`({NAME})(?:\(\))?`", role, text, flags=re.M)

    def prose(self, text, signature=""):
        """Paragraphs, then a list of the parameters that the text names and of the errors that it tells."""
        params = set(re.findall(r"(\w+)(?:\[\w*\])?(?=[,)])", signature.partition("(")[2]))
        said, fields = [], []
        for paragraph in text.split("\n\n"):
            if paragraph.startswith("    "):
                said.append(paragraph)
                continue
            kept = []
            for sentence in sentences(re.sub(r"\s+", " ", paragraph)):
                if signature and (found := re.match(r"(FP3_E_\w+): (.*)", sentence)):
                    fields.append(f":retval {found[1]}: {self.linked(found[2])}")
                elif signature and (found := re.match(r"(\w+)(?:\[\w+\])?: (.*)", sentence)) and found[1] in params:
                    fields.append(f":param {found[1]}: {self.linked(found[2])}")
                else:
                    kept.append(sentence)
            said.append(self.linked(" ".join(kept)))
        fields.sort(key=lambda field: field.startswith(":retval"))
        return "\n\n".join([*filter(None, said), "\n".join(fields)]).strip("\n")

    def members(self, declaration):
        """Of a struct or an enum, each with what stands beside it; what stands above several is said above the first."""
        role, text, last = ("member" if declaration.kind == "struct" else "enumerator"), declaration.members, None
        found, at = [], 0
        for piece in re.finditer(rf"({COMMENT})|([^;,/]+(?:\([^;]*?\))?[^;/]*;)|(\w+(?: = [^,/]+)?)(?:,|(?=\s*(?:{COMMENT}\s*)*$))" if role == "enumerator"
                                 else rf"({COMMENT})|([^;/]+;)", text):
            between, at = text[at:piece.start()], piece.end()
            if piece[1]:
                said = self.prose(comment(re.sub(r"\n +", "\n ", piece[1])))
                if last is not None and "\n" not in between:
                    found[last] = (*found[last][:2], said)
                else:
                    found.append(("", "", said))
                continue
            code = plain(piece[0]).removesuffix(",")
            head = re.match(r"((?:const |struct )*\w+) (.*)", code) if role == "member" and "(" not in code else None
            for declared in head[2].split(", ") if head else [code]:
                found.append((role, f"{head[1]} {declared}" if head else declared, ""))
            last = len(found) - 1
        for n, (role, _, said) in enumerate(found):     # what stands above one alone belongs to it
            if not role and n + 1 < len(found) and found[n + 1][0] and not found[n + 1][2] and (n + 2 == len(found) or not found[n + 2][0]):
                found[n], found[n + 1] = ("", "", ""), (*found[n + 1][:2], said)
        for role, code, said in filter(any, found):
            yield f"````{{c:{role}}} {code}\n{said}\n````\n" if role else said + "\n"

    def declared(self, declaration, text):
        if not declaration.kind:
            yield from [text + "\n"] if text else []
            yield f"```c\n{declaration.code}\n```\n"
            return
        about = declaration.about if declaration.about.startswith("```") else self.linked(declaration.about)
        content = [self.prose(text, declaration.signature if declaration.kind == "function" else ""), about, *self.members(declaration)]
        yield "\n".join([f"`````{{c:{declaration.kind}}} {declaration.signature}", *filter(None, content), "`````", ""])

    def page(self, path):
        """What the first comment below the line of the licence says, then each declaration with its comment."""
        header = self.headers[path]
        yield "\n\n".join([f"# {header.title}", self.linked(header.what), self.prose(header.about.strip("\n")), ""])
        for part in header.parts:
            pending, number = "", 0
            if part[0][0] == "text" and (heading := re.fullmatch(r"-+ (.*?) -+", part[0][1].partition("\n")[0])):
                title, _, page = heading[1].partition(" (docs/")
                yield f"## {title[:1].upper()}{title[1:]}\n"
                about = (f"See docs/{page.rstrip(')')}.\n\n" if page else "") + part[0][1].partition("\n")[2].strip("\n")
                if about:
                    yield self.prose(about) + "\n"
                number = 1
            if len(part) == number + 1 and part[number][0] == "text":
                yield self.prose(part[number][1]) + "\n"
                continue
            while number < len(part):
                kind, found = part[number]
                number += 1
                if kind == "text":
                    pending = found
                    continue
                # Of declarations below one comment the last has the text: their signatures stand together.
                is_shared = number < len(part) and part[number][0] == "code" and found.kind == part[number][1].kind == "function" \
                    and not part[number][1].code.startswith("static")
                yield from self.declared(found, "" if is_shared else pending)
                pending = pending if is_shared else ""

    def index(self):
        rows = "".join(f"| [{header.title}]({path.stem}.md) | {sentences(header.what)[0].rstrip('.')} |\n" for path, header in self.headers.items())
        return f"# Headers of the library\n\n| header | what for |\n|---|---|\n{rows}\n"
