"""Where a file of C can be changed, and one text that has all of these changes.

All mutants of a file are compiled at once: each is chosen by its number while the program runs, so a file is compiled once and not
thousands of times (mutant schemata: R. H. Untch, A. J. Offutt, M. J. Harrold, "Mutation analysis using mutant schemata", ISSTA 1993).
`FP3_M(n)` is 1 for the mutant that the environment names, and notes that n was reached.
"""

import dataclasses
import re

# What becomes of an operator. A comparison changes at its end, so that only a test of the end sees it.
SWAPPED = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "+", "/": "*", "%": "/",
           "&": "|", "|": "&", "^": "|", "<<": ">>", ">>": "<<"}
# One side alone. %s: the sides, with their own mutants.
SIDES = {"&&": "((FP3_M({1}) || (%s)) && (FP3_M({0}) || (%s)))", "||": "((!FP3_M({1}) && (%s)) || (!FP3_M({0}) && (%s)))"}
GIVEN = {"+=": "-=", "-=": "+=", "|=": "&=", "&=": "|=", "*=": "/=", "<<=": ">>=", ">>=": "<<="}
# What the compiler must know: no mutant can be chosen there while the program runs.
CONSTANT = {"array_declarator", "case_statement", "enumerator", "sizeof_expression", "alignof_expression", "static_assert_declaration", "bitfield_clause",
            "field_declaration", "preproc_if", "preproc_ifdef", "preproc_def", "preproc_function_def", "subscript_designator", "offsetof_expression",
            "type_descriptor", "attribute_specifier", "gnu_asm_expression", "preproc_directive", "preproc_call", "macro_type_specifier"}
# Before the text of a mutated file, and once beside all of them.
BEFORE = """extern int fp3_m_now_;
extern unsigned char fp3_m_seen_[];
#define FP3_M(n) (fp3_m_seen_[n] = 1, fp3_m_now_ == (n))
"""
BESIDE = """#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#define HIDDEN __attribute__((visibility("hidden")))
HIDDEN int fp3_m_now_ = -1;
HIDDEN unsigned char fp3_m_seen_[COUNT];
__attribute__((constructor)) static void begin(void) {
    const char *text = getenv("FP3_MUTANT");
    fp3_m_now_ = text ? atoi(text) : -1;
}
__attribute__((destructor)) static void end(void) {
    const char *folder = getenv("FP3_MUTANTS_SEEN");
    char path[4096];
    if (!folder)
        return;
    snprintf(path, sizeof path, "%s/%ld.%p", folder, (long)getpid(), (void *)fp3_m_seen_);
    FILE *file = fopen(path, "wb");
    if (file) {
        fwrite(fp3_m_seen_, 1, sizeof fp3_m_seen_, file);
        fclose(file);
    }
}
"""


@dataclasses.dataclass
class Mutant:
    number: int
    file: str
    line: int
    column: int
    text: str                # what becomes of what
    change: tuple            # begin, end, bytes: of the file alone, with this change in it
    state: str = "open"      # killed, equivalent, open, or lost: it does not compile
    by: str = ""


def parser():
    import tree_sitter
    import tree_sitter_c
    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_c.language()))


class Changed:
    """A file with all its mutants. without: lines whose mutants do not compile."""

    def __init__(self, path, text, first, without=()):
        self.path, self.text, self.without, self.mutants, self.first = path, text, set(without), [], first
        self.out = self.top(parser().parse(text).root_node)

    def top(self, root):
        """Functions alone are changed."""
        out, at = [], 0
        for node in self.functions(root):
            body = node.child_by_field_name("body")
            out += [self.text[at:body.start_byte], self.of(body)]
            at = body.end_byte
        return b"".join([*out, self.text[at:]])

    def functions(self, node):
        if node.type == "function_definition":
            yield node
        elif node.type in ("translation_unit", "preproc_if", "preproc_ifdef", "preproc_else", "preproc_elif", "linkage_specification", "declaration_list"):
            for child in node.children:
                yield from self.functions(child)

    def mutant(self, node, text, change):
        """The number of a new one, or None where none compiles."""
        line = node.start_point[0] + 1
        if line in self.without:
            return None
        number = self.first + len(self.mutants)
        self.mutants.append(Mutant(number, self.path, line, node.start_point[1] + 1, text, change))
        return number

    def plain(self, node):
        return self.text[node.start_byte:node.end_byte]

    def of(self, node):
        """The text of a node with the mutants in it."""
        if node.type in CONSTANT or self.is_static(node) or node.is_error or node.is_missing:
            if node.type == "case_statement":           # its value alone is constant
                return self.children(node, skip=node.child_by_field_name("value"))
            return self.plain(node)
        make = getattr(self, node.type, None)
        return make(node) if make else self.children(node)

    def is_static(self, node):
        return node.type == "declaration" and any(child.type == "storage_class_specifier" and child.text == b"static" for child in node.children)

    def children(self, node, skip=None):
        out, at = [], node.start_byte
        for child in node.children:
            out += [self.text[at:child.start_byte], self.plain(child) if skip is not None and child == skip else self.of(child)]
            at = child.end_byte
        return b"".join([*out, self.text[at:node.end_byte]])

    def binary_expression(self, node):
        left, sign, right = (node.child_by_field_name(name) for name in ("left", "operator", "right"))
        operator = sign.text.decode()
        # With comments and ends of lines, which stay.
        sides = self.of(left) + self.text[left.end_byte:sign.start_byte], self.text[sign.end_byte:right.start_byte] + self.of(right)
        if operator in SIDES:
            numbers = [self.mutant(node, f"{node_text(node)} -> {node_text(kept)}", (node.start_byte, node.end_byte, self.plain(kept))) for kept in (left, right)]
            if None not in numbers:
                return SIDES[operator].format(*numbers).encode() % sides
            return sides[0] + sign.text + sides[1]
        other = SWAPPED.get(operator)
        number = other and self.mutant(sign, f"{operator} -> {other} in {node_text(node)}", (sign.start_byte, sign.end_byte, other.encode()))
        if number is None:
            return sides[0] + sign.text + sides[1]
        form = "__extension__({{ __auto_type l{0}_ = (%s); __auto_type r{0}_ = (%s); FP3_M({0}) ? l{0}_ {1} r{0}_ : l{0}_ {2} r{0}_; }})"
        return form.format(number, other.replace("%", "%%"), operator.replace("%", "%%")).encode() % sides

    def unary_expression(self, node):
        argument = node.child_by_field_name("argument")
        inner = self.children(node)
        if node.child_by_field_name("operator").text != b"!":
            return inner
        number = self.mutant(node, f"{node_text(node)} -> {node_text(argument)}", (node.start_byte, node.end_byte, self.plain(argument)))
        return inner if number is None else b"((" + inner + f") ^ FP3_M({number}))".encode()

    def call_expression(self, node):
        if re.fullmatch(rb"U?INT\d+_C", node.child_by_field_name("function").text):      # glues a suffix to its argument
            return node.text
        return self.children(node)

    def number_literal(self, node):
        text = node.text.decode()
        changed = f"({text} + 1)" if text.lower().startswith("0x") or not set(text.lower()) & set(".ep") else f"({text} * 2)"
        number = self.mutant(node, f"{text} -> {changed[1:-1]}", (node.start_byte, node.end_byte, changed.encode()))
        if number is None:
            return node.text
        return f"({text} {'+' if '+' in changed else '* (1 +'} FP3_M({number}){'' if '+' in changed else ')'})".encode()

    def assignment_expression(self, node):
        left, sign, right = (node.child_by_field_name(name) for name in ("left", "operator", "right"))
        operator = sign.text.decode()
        other = GIVEN.get(operator)
        has_effects = any(sign in left.text for sign in (b"++", b"--", b"("))       # the left side is there twice
        number = None if not other or has_effects else \
            self.mutant(sign, f"{operator} -> {other} in {node_text(node)}", (sign.start_byte, sign.end_byte, other.encode()))
        if number is None:
            return self.children(node)
        form = "__extension__({{ __auto_type r{0}_ = (%s); FP3_M({0}) ? (%s {1} r{0}_) : (%s {2} r{0}_); }})"
        return form.format(number, other, operator).encode() % (self.of(right), left.text, left.text)

    def expression_statement(self, node):
        inner = self.children(node)
        if not node.children or node.children[0].type == ";":
            return inner
        number = self.mutant(node, f"{node_text(node)} -> ;", (node.start_byte, node.end_byte, b";"))
        return inner if number is None else f"{{ if (!FP3_M({number})) ".encode() + inner + b" }"

    def jump(self, node):
        number = self.mutant(node, f"{node_text(node)} -> ;", (node.start_byte, node.end_byte, b";"))
        return node.text if number is None else f"{{ if (!FP3_M({number})) ".encode() + node.text + b" }"

    break_statement = continue_statement = jump


def node_text(node):
    return " ".join(node.text.decode().split())[:60]


def alone(text, mutant):
    """The file with one change."""
    begin, end, new = mutant.change
    return text[:begin] + new + text[end:]
