"""Models, and the programs that the compiler makes of them."""

from __future__ import annotations

import ctypes
import os
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Union

from . import _declarations as d
from ._library import Handle, check, library, name_bytes
from .errors import ArgumentError

Source = Union[str, "os.PathLike[str]"]
_PROGRAMS_MOST = 32  # that a model keeps


class How(NamedTuple):
    """How a model is compiled, in the command's words."""

    method: Optional[str] = None
    arithmetic: str = "plain"
    config: Optional[str] = None
    adaptive: Optional[Tuple[float, float, float, float]] = None  # tolerance, absolute, until, maxstep; tolerance 0: cut


class Program(Handle):
    """A compiled model. Batches share it."""

    def __init__(self, model: "Model", how: How) -> None:
        lib, error, report = library(), d.fp3_error(), ctypes.c_char_p()
        definition = lib.default(d.fp3_program_def)
        definition.compile.arithmetic = find_arithmetic(how.arithmetic)
        definition.alone = b"many_full"
        definition.compile.is_for_host = 1
        if how.method is not None:
            definition.integrator = name_bytes("method", how.method)
        if how.config is not None:
            definition.compile.config = name_bytes("config", how.config)
        if how.adaptive is not None:
            definition.is_adaptive = 1
            adaptive = definition.adaptive
            adaptive.tolerance, adaptive.absolute, adaptive.until, adaptive.maxstep = how.adaptive
        pointer = ctypes.POINTER(d.fp3_program)()
        check(lib.fp3_program_read(model._text, len(model._text), model._where, definition, pointer, report, error), error, report)
        super().__init__(pointer, "fp3_program_close", definition)  # the program has the name of its configuration from there
        self.how = how

    @property
    def c(self) -> Any:
        return self.pointer.contents

    @property
    def warning(self) -> Optional[str]:
        said = self.c.compiled.contents.warning
        return None if said is None else str(said, errors="replace")

    def evaluations(self) -> int:
        """Right-hand sides of a step, as the method's table has them."""
        integrator = self.c.integrator.contents
        if integrator.kind == d.FP3_STOERMER:
            return 1
        if integrator.kind == d.FP3_SPLITTING:
            return int(sum(integrator.substeps[i].is_kick for i in range(integrator.stages)))
        return int(integrator.stages)


def find_arithmetic(name: str) -> int:
    """plain, compensated, folded or double-single."""
    lib = library()
    number = int(lib.fp3_arithmetic_find(name_bytes("arithmetic", name).replace(b"-", b"_")))
    if number == d.FP3_ARITHMETICS:
        names = [lib.fp3_arithmetic_of(i).contents.name.decode().replace("_", "-") for i in range(d.FP3_ARITHMETICS)]
        raise ArgumentError(f"arithmetic: found {name!r}, expected one of {', '.join(names)}")
    return number


def integrators() -> Tuple[str, ...]:
    """The names of the built-in integrators, for `method`."""
    lib = library()
    names: List[str] = []
    while (name := lib.fp3_integrator_name(len(names))) is not None:
        names.append(name.decode())
    return tuple(names)


class Model:
    """Equations of motion, read from a file or from a text.

    source is the path of a model, or its text: a string with a line break is a text. name is what messages call a text.
    Mistakes raise ProgramError, with file, line and column.

        model = fp3.Model("kepler.ode")
        model.states                    # ('v_x', 'v_y', 'r_x', 'r_y')
    """

    def __init__(self, source: Source, *, name: Optional[str] = None) -> None:
        if isinstance(source, str) and "\n" in source:
            self._text, self._where = source.encode(errors="surrogatepass"), name_bytes("name", "text" if name is None else name)
        else:
            self._where = name_bytes("source", source)
            with open(source, "rb") as file:
                self._text = file.read()
        self._read()

    def _read(self) -> None:
        lib, error, report = library(), d.fp3_error(), ctypes.c_char_p()
        pointer = ctypes.POINTER(d.fp3_model)()
        check(lib.fp3_model_read(self._text, len(self._text), self._where, pointer, report, error), error, report)
        self._handle = Handle(pointer, "fp3_model_free")
        self._programs: Dict[How, Program] = {}
        c = self._c
        self.name: str = c.name.decode()
        self.doc: str = (c.doc or b"").decode(errors="replace")
        self.step: float = c.step
        self.span: float = c.span
        self.time_unit: str = c.time_unit.decode(errors="replace")
        self.states: Tuple[str, ...] = tuple(c.states[i].name.decode() for i in range(c.state_count))
        #: What the model reads of objects of other groups stands among the params, and nobody gives it.
        foreign = {i for kind in c.kinds[:c.kind_count] for i in range(kind.first, kind.first + kind.count)}
        own = [c.params[i] for i in range(c.param_count) if i not in foreign]
        self.params: Tuple[str, ...] = tuple(q.name.decode() for q in own)
        self.shared: Tuple[str, ...] = tuple(q.name.decode() for q in own if q.is_shared)
        self.kinds: Tuple[str, ...] = tuple(kind.name.decode() for kind in c.kinds[:c.kind_count])
        self.relations: Tuple[str, ...] = tuple(c.relations[i].name.decode() for i in range(c.relation_count))
        self.invariants: Tuple[str, ...] = tuple(c.invariants[i].name.decode() for i in range(c.invariant_count))
        #: Those of all objects of a group together, which `fp3 run --check` computes.
        self.group_invariants: Tuple[str, ...] = tuple(c.group_invariants[i].name.decode() for i in range(c.group_invariant_count))
        quantities = [*c.states[:c.state_count], *own]
        #: The starts of states and the defaults of params.
        self.defaults: Dict[str, float] = {q.name.decode(): q.value for q in quantities}
        #: Their units, as the model has them.
        self.units: Dict[str, str] = {q.name.decode(): (q.dimension or b"").decode(errors="replace") for q in quantities}

    @property
    def _c(self) -> Any:
        return self._handle.pointer.contents

    @property
    def text(self) -> str:
        """The text of the model."""
        return self._text.decode(errors="replace")

    @property
    def uses_time(self) -> bool:
        """Whether t is in the model."""
        return any(e.op == d.FP3_EXPR_TIME for e in self._c.exprs[:self._c.expr_count])

    def program(self, how: How = How()) -> Program:
        """Compiles the model, or finds what was compiled before."""
        method, arithmetic, config = (None if name is None else os.fsdecode(name_bytes(what, name))
                                      for what, name in (("method", how.method), ("arithmetic", how.arithmetic), ("config", how.config)))
        how = how._replace(method=method, arithmetic=arithmetic or "plain", config=config)
        if method and (os.sep in method or method.endswith(".cfg")):
            return Program(self, how)  # a file, which may change
        found = self._programs.get(how)
        if found is None:
            if len(self._programs) >= _PROGRAMS_MOST:
                self._programs.pop(list(self._programs)[0], None)
            found = self._programs[how] = Program(self, how)
        return found

    def __reduce__(self) -> Tuple[Any, ...]:
        return _again, (self._text, self._where)

    def __repr__(self) -> str:
        return f"fp3.Model({os.fsdecode(self._where)!r}: {self.name}, states {', '.join(self.states)})"


def _again(text: bytes, where: bytes) -> Model:
    """A pickled model, in another process."""
    model = Model.__new__(Model)
    model._text, model._where = text, where
    model._read()
    return model


def as_model(model: Union[Model, Source]) -> Model:
    return model if isinstance(model, Model) else Model(model)
