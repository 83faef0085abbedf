"""A strict reader of Kanata logs, the format of the pipeline viewer Konata (docs/tracing.md says where it is described).

    python3 tests/kanata/check.py FILE [--schedulers N] [--contexts N]

Refuses, with the line, all that the format forbids, and more: what it leaves open is one way here. Every stage is ended,
takes a cycle at least and follows the one before it in its lane; every instruction has one label, a stage and an end;
with --schedulers and --contexts a thread is scheduler * contexts + context, and a scheduler starts one instruction in a cycle at most.
"""

import argparse
import dataclasses
import pathlib
import re
import sys


class Refused(Exception):
    """What is wrong, and where."""

    def __init__(self, line, why):
        super().__init__(f"{line}: {why}")
        self.line, self.why = line, why


@dataclasses.dataclass
class Instruction:
    thread: int
    issued: int                                        # cycle
    label: str = ""
    detail: str = ""
    stages: list = dataclasses.field(default_factory=list)   # (lane, name, first cycle, cycle after the last)
    open: dict = dataclasses.field(default_factory=dict)     # by lane: (name, first cycle)
    ended: int = None                                  # cycle
    flushed: bool = False


# Of each command how many fields follow it, and which of them are text.
FIELDS = {"C=": (1, ()), "C": (1, ()), "I": (3, ()), "L": (3, (2,)), "S": (3, (2,)), "E": (3, (2,)), "R": (3, ()),
          "W": (3, ())}
METHODS = {"C=": "begin", "C": "elapse", "I": "start", "L": "label", "S": "enter", "E": "leave", "R": "end", "W": "depend"}


def split(number, line):
    """The command of a line and its fields, numbers as int."""
    if not line.isascii() or not line.replace("\t", "").isprintable():
        raise Refused(number, "a character that is neither printable ASCII nor a tab")
    command, *fields = line.split("\t")
    if command not in FIELDS:
        raise Refused(number, f"no command '{command}'")
    count, text = FIELDS[command]
    if len(fields) != count:
        raise Refused(number, f"{command} has {len(fields)} fields, not {count}")
    for i, field in enumerate(fields):
        if i in text:
            if not field:
                raise Refused(number, f"field {i + 1} is empty")
        elif not re.fullmatch(r"0|[1-9][0-9]*", field):
            raise Refused(number, f"field {i + 1}, '{field}', is no number")
        else:
            fields[i] = int(field)
    return command, fields


class Reader:
    """A method for each command; what it returns is why the command is refused."""

    def __init__(self, schedulers, contexts, at_once):
        self.schedulers, self.contexts, self.at_once = schedulers, contexts, at_once
        self.instructions, self.retired, self.cycle, self.started = [], 0, None, []

    def read(self, text):
        if not text.startswith("Kanata\t0004\n"):
            raise Refused(1, "the header is not 'Kanata', a tab and '0004'")
        if not text.endswith("\n"):
            raise Refused(text.count("\n") + 1, "the last line does not end")
        number = 1
        for number, line in enumerate(text.split("\n")[1:-1], 2):
            command, fields = split(number, line)
            if (command == "C=") != (number == 2):
                raise Refused(number, "C= stands in the second line and nowhere else")
            why = getattr(self, METHODS[command])(*fields)
            if why:
                raise Refused(number, why)
        if self.cycle is None:
            raise Refused(2, "there is no C=")
        for i, instruction in enumerate(self.instructions):
            if instruction.ended is None:
                raise Refused(number + 1, f"instruction {i} has no R")

    def alive(self, i):
        if i >= len(self.instructions):
            return f"instruction {i} has no I"
        if self.instructions[i].ended is not None:
            return f"instruction {i} has ended"
        return None

    def begin(self, cycle):
        self.cycle = cycle

    def elapse(self, cycles):
        if cycles == 0:
            return "no cycle elapses"
        self.cycle += cycles
        self.started = []
        return None

    def start(self, i, _, thread):
        if i != len(self.instructions):
            return f"instruction {i}, expected {len(self.instructions)}"
        if self.schedulers and thread >= self.schedulers * self.contexts:
            return f"thread {thread} of {self.schedulers * self.contexts}"
        scheduler = thread // self.contexts if self.schedulers else None
        if self.schedulers and self.started.count(scheduler) == self.at_once:
            return f"scheduler {scheduler} starts a second instruction in cycle {self.cycle}"
        self.started.append(scheduler)
        self.instructions.append(Instruction(thread, self.cycle))
        return None

    def label(self, i, kind, text):
        if kind > 1:
            return f"label of type {kind}"
        if self.alive(i):
            return self.alive(i)
        instruction = self.instructions[i]
        if kind == 0 and instruction.label:
            return f"instruction {i} has a label already"
        if kind == 0:
            instruction.label = text
        else:
            instruction.detail += text.replace("\\n", "\n")
        return None

    def enter(self, i, lane, name):
        if self.alive(i):
            return self.alive(i)
        instruction = self.instructions[i]
        if not instruction.label:
            return f"instruction {i} has no label"
        if lane in instruction.open:
            return f"stage {instruction.open[lane][0]} of instruction {i} has no E"
        if not re.fullmatch(r"[A-Z][a-z]?", name):
            return f"stage '{name}' is not called by a capital and perhaps a small letter"
        before = [after for other, _, _, after in instruction.stages if other == lane]
        if self.cycle != (before[-1] if before else instruction.issued):
            return f"stage {name} of instruction {i} leaves a gap"
        instruction.open[lane] = name, self.cycle
        return None

    def leave(self, i, lane, name):
        if self.alive(i):
            return self.alive(i)
        instruction = self.instructions[i]
        if instruction.open.get(lane, (None,))[0] != name:
            return f"instruction {i} is not in stage {name}"
        _, first = instruction.open.pop(lane)
        if first == self.cycle:
            return f"stage {name} of instruction {i} takes no cycle"
        instruction.stages.append((lane, name, first, self.cycle))
        return None

    def end(self, i, retired, kind):
        if kind > 1:
            return f"end of type {kind}"
        if self.alive(i):
            return self.alive(i)
        instruction = self.instructions[i]
        if instruction.open:
            return f"stage {min(instruction.open.values())[0]} of instruction {i} has no E"
        if not instruction.stages:
            return f"instruction {i} has no stage"
        if instruction.stages[-1][3] != self.cycle:
            return f"instruction {i} ends {self.cycle - instruction.stages[-1][3]} cycles after its last stage"
        if retired != self.retired:
            return f"retirement {retired}, expected {self.retired}"
        self.retired += kind == 0
        instruction.ended, instruction.flushed = self.cycle, kind == 1
        return None

    def depend(self, consumer, producer, kind):
        if kind > 0:
            return f"dependency of type {kind}"
        if self.alive(consumer):
            return self.alive(consumer)
        if producer >= len(self.instructions):
            return f"instruction {producer} has no I"
        if producer == consumer:
            return f"instruction {producer} depends on itself"
        return None


def read(text, schedulers=0, contexts=0, at_once=1):
    """The instructions of a log, or Refused. schedulers = 0: threads may have any number. at_once: of a scheduler in a cycle."""
    reader = Reader(schedulers, contexts, at_once)
    reader.read(text)
    return reader.instructions


def main():
    parser = argparse.ArgumentParser(description="Checks a Kanata log.")
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--schedulers", type=int, default=0)
    parser.add_argument("--contexts", type=int, default=1)
    options = parser.parse_args()
    try:
        found = read(options.file.read_bytes().decode("latin-1"), options.schedulers, options.contexts)
    except Refused as why:
        sys.exit(f"FAIL {options.file}:{why}")
    flushed = sum(one.flushed for one in found)
    print(f"PASS {options.file}: {len(found)} instructions, {len(found) - flushed} retired, {flushed} flushed")


if __name__ == "__main__":
    main()
