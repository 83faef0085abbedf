"""Code of the pages in colours: which language a block is in, and lexers of the languages that Pygments does not know: an extension of Sphinx."""

import re

from docutils import nodes
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text, Whitespace


class Model(RegexLexer):
    """A *.ode file. A line that begins with a word that no = or ' follows is a statement; a name before a parenthesis is a function."""
    name, aliases = "FP3 model", ["ode"]
    tokens = {"root": [
        (r"#.*", Comment.Single),
        (r'"[^"\n]*"?', String),
        (r"^(\s*)([A-Za-z_]\w*)(?=\s+[\w(])", bygroups(Whitespace, Keyword.Declaration)),
        (r"\b(and|or|not|in|for|if|rising|falling|any)\b", Operator.Word),
        (r"\b(t|pi)\b", Name.Constant),
        (r"([A-Za-z_]\w*)(?=\()", Name.Function),
        (r"([A-Za-z_][\w.]*)('+)", bygroups(Name.Variable, Operator)),
        (r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", Name),
        (r"\d+(?=\.\.)|(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", Number),
        (r"\.\.|[-+*/^=<>!?:]+", Operator),
        (r"[()\[\],']", Punctuation),
        (r"\s+", Whitespace),
        (r".", Text),
    ]}


class Scene(RegexLexer):
    """A *.scene file, and others that libconfig reads."""
    name, aliases = "FP3 scene", ["scene"]
    tokens = {"root": [
        (r"#.*|//.*", Comment.Single),
        (r"(?s)/\*.*?\*/", Comment.Multiline),
        (r'"(\\.|[^"\\\n])*"?', String),
        (r"([A-Za-z*][-\w*]*)(\s*)([=:])", bygroups(Name.Attribute, Whitespace, Operator)),
        (r"(?i)\b(true|false)\b", Keyword.Constant),
        (r"[-+]?(0x[\da-fA-F]+|\d+\.?\d*([eE][-+]?\d+)?|\.\d+)L?", Number),
        (r"[(){}\[\],;]", Punctuation),
        (r"\s+", Whitespace),
        (r".", Text),
    ]}


LEXERS = [Model, Scene]
# The first that fits. Every language has to be seen in a line, so what a program prints stays as it is.
SIGNS = [
    ("console", r"^\$ "),
    ("html", r"^<(script|html|!DOCTYPE|iframe)"),
    ("cpp", r"^#include <fp3/\w+\.hpp>|^#include <(vector|cstdio|memory)>|std::"),
    ("python", r"^(import|from) \w+|^def \w+\(.*:$|^with .*:$|^>>> |fp3\.\w+\(|^\w+ = (np|fp3|ships|batch|bodies)\.|^print\("),
    ("verilog", r"^(module|endmodule|assign|always)\b|^ *(wire|reg|input|output) .*[;,]|`include|^ *\.\w+ *\(\w*\)"),
    ("c", r"^#include|^#define|\bfp3_\w+ ?\(|\bfp3_\w+ \*?\w+ *(=|;)|^(static|typedef|const|enum|struct|float|double|int|uint\d+_t) .*[;{]$"),
    ("json", r'^\{$|^ *"\w+": |^\{"'),
    ("scene", r"^ *[A-Za-z]\w* *= *[({\[\"\d-].*;|^ *[A-Za-z]\w* *= *[({]$|^ *\} *\);?$"),
    ("gas", r"^ *\.(state|param|shared|const|temp|list|loop|visit)\b|^(first|step|last):|"
            r"^ *(add|sub|mul|madd|msub|rcp|ld|lds|st|sel|lt|sleep|mov|neg)\b +\w+, "),
    ("ode", r"^ *(model|param|shared|state|step|span|when|at|project|links|near|all|kind|exact|invariant|remember|rest|for|integrator)\b +[\w(\[]|"
            r"^\w+'+ = |^\w[\w.]*(\[\d\])? *= .*\S"),
    ("bash", r"^(build/|make|apt-get|fp3|tools/|pip|python3?|/usr/bin|git|cc|gcc|c\+\+|g\+\+|cd|export|sudo|\.venv|jupyter|mpirun|dpkg|docker|cmake|"
             r"time|gtkwave|iverilog|FP3_\w+=|[A-Z_]+=\S+ ).*"),
]


def language(code):
    """Of a block; "text": none that is known."""
    return next((name for name, sign in SIGNS if re.search(sign, code, re.M)), "text")


def choose(_, document):
    """Blocks of a page that are indented say no language."""
    for block in document.findall(nodes.literal_block):
        if block.get("language") in (None, "none", "default"):
            block["language"] = language(block.astext())


def setup(app):
    for lexer in LEXERS:
        app.add_lexer(lexer.aliases[0], lexer)
    app.connect("doctree-read", choose)
    return {"parallel_read_safe": True}
