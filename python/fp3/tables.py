"""What the command measures, as tables: the tuner, the benchmark and the stress suite.

These run for seconds to minutes and must stop at Ctrl-C, which a call of the library cannot; benchmark and stress suite
are not in the library at all. So these start the command that the package carries, and read its --json.
"""

from __future__ import annotations

import html
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from ._library import home
from .errors import ArgumentError, FailedError, ProgramError, SystemFailure
from .given import as_mapping, as_number, shown as shown_value
from .model import Model, Source, as_model

_OBJECTS_FAILED = 3  # exit code: all is written, and something is not as it should be


class Table(List[Dict[str, Any]]):
    """Rows, each a dict with the same keys: pandas.DataFrame(table) takes it, and so does csv.DictWriter."""

    @property
    def columns(self) -> List[str]:
        return list(dict.fromkeys(key for row in self for key in row))

    def column(self, name: str) -> List[Any]:
        """The values of a column, None where a row has none."""
        if name not in self.columns:
            raise ArgumentError(f"the table has no column {name!r}, it has {', '.join(self.columns)}")
        return [row.get(name) for row in self]

    def _repr_html_(self) -> str:
        def row(cells: Iterable[Any], tag: str) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(shown(cell))}</{tag}>" for cell in cells) + "</tr>"
        return f"<table>{row(self.columns, 'th')}{''.join(row((of.get(key) for key in self.columns), 'td') for of in self)}</table>"


def shown(cell: Any) -> str:
    return "" if cell is None else f"{cell:.6g}" if isinstance(cell, float) else str(cell)


class Tuning:
    """What fp3.tune found. met: whether the choice keeps the tolerance; choice: the best row with errors and cost; rows: all
    that was tried; scene: the choice as the text of a scene."""

    def __init__(self, found: Dict[str, Any], scene: str) -> None:
        self.rows = Table(found.pop("tried"))
        self.choice, self.scene = found, scene
        self.met: bool = bool(found["met"])

    def __repr__(self) -> str:
        c = self.choice
        best = c.get("choice") or c
        return f"fp3.Tuning({c.get('model') or c['scene']}: " + (
            f"{best['integrator']}, {best['arithmetic']}, error {best['error']:.3g})" if self.met else "nothing meets the tolerance)")


def _ended(words: Sequence[str], progress: bool, is_kept: bool) -> "subprocess.CompletedProcess[str]":
    """is_kept: a first Ctrl-C only tells the command to end, and what it has found so far counts."""
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, start_new_session=is_kept,
                          stderr=sys.stderr if progress and has_descriptor(sys.stderr) else subprocess.PIPE) as child:
        try:
            out, said = child.communicate()
        except KeyboardInterrupt:
            if not is_kept:
                child.kill()
                raise
            child.send_signal(signal.SIGINT)
            try:
                out, said = child.communicate()
            except KeyboardInterrupt:
                child.kill()
                raise
        return subprocess.CompletedProcess(words, child.returncode, out, said)


def command(arguments: Sequence[str], found: pathlib.Path, *, progress: bool = False, is_kept: bool = False) -> Any:
    """Starts the command that the package carries, and reads what it has written to `found`. Ctrl-C ends it, too."""
    done = _ended([str(home() / "bin" / "fp3"), *arguments, f"--json={found}"], progress, is_kept)
    if done.returncode in (0, _OBJECTS_FAILED) and found.exists():
        return json.loads(found.read_text())
    said = (done.stderr or done.stdout).strip()
    line = said.splitlines()[-1] if said else f"fp3 {arguments[0]} ended with exit code {done.returncode}"
    place = re.search(r"(?:^|: )([^:\s]+):(\d+):(?:(\d+):)?", line)
    kind = FailedError if done.returncode == _OBJECTS_FAILED else SystemFailure if done.returncode not in (1, 2) else ProgramError if place else ArgumentError
    raise kind(line, file=place[1] if place else None, line=int(place[2]) if place else None,
               column=int(place[3]) if place and place[3] else None)


def has_descriptor(stream: Any) -> bool:
    try:
        return int(stream.fileno()) >= 0
    except (AttributeError, OSError, ValueError):
        return False


class _Files:
    """A directory with the models as files, and for what the command writes."""

    def __init__(self, models: Iterable[Union[Model, Source]]) -> None:
        self._directory = tempfile.TemporaryDirectory(prefix="fp3-")
        self.path = pathlib.Path(self._directory.name)
        self.found = self.path / "found.json"
        self.models: List[str] = []
        for i, model in enumerate(map(as_model, models)):
            name = pathlib.Path(os.fsdecode(model._where)).name.removesuffix(".ode") or "text"
            (self.path / str(i)).mkdir()
            file = self.path / str(i) / f"{name}.ode"
            file.write_bytes(model._text)
            self.models.append(str(file))

    def __enter__(self) -> "_Files":
        return self

    def __exit__(self, *of: Any) -> None:
        self._directory.cleanup()


def _numbers(option: str, values: Optional[Mapping[str, Any]], width: int) -> List[str]:
    words = []
    for name, value in as_mapping(option, values).items():
        parts = [value] if width == 1 else list(value) if isinstance(value, (tuple, list)) or isinstance(value, np.ndarray) and value.ndim == 1 else []
        if len(parts) != width:
            raise ArgumentError(f"'{name}': found {shown_value(value)}, expected a pair, first and last")
        words.append(f"--{option}={name}=" + ":".join(repr(as_number(f"'{name}'", part)) for part in parts))
    return words


def _options(**options: Any) -> List[str]:
    """--name=value of those that are given; True is a flag."""
    return [f"--{name.replace('_', '-')}" + ("" if value is True else f"={value}") for name, value in options.items()
            if value is not None and value is not False]


def _tune_scene(path: str, tolerance: float, output: Optional[str], progress: bool, **options: Any) -> Tuning:
    with _Files([]) as files:
        found = command(["tune", path, f"--tolerance={as_number('tolerance', tolerance)!r}", *([f"--output={output}"] if output else []), *_options(**options)],
                        files.found, progress=progress, is_kept=True)
    return Tuning(found, pathlib.Path(output).read_text() if output and found["met"] else "")


def tune(model: Union[Model, Source], tolerance: float, *, ranges: Optional[Mapping[str, Union[Tuple[float, float], "np.ndarray[Any, Any]"]]] = None,
         params: Optional[Mapping[str, float]] = None, around: Optional[float] = None, span: Optional[float] = None,
         config: Optional[str] = None, objects: Optional[int] = None, held_out: Optional[int] = None, cost: Optional[str] = None,
         within: Optional[float] = None, work: Optional[float] = None, output: Union[str, "os.PathLike[str]", None] = None, progress: bool = False) -> Tuning:
    """`fp3 tune`: the cheapest integrator, step and arithmetic that keep a tolerance over ranges of values.

    ranges: by name, (first, last); params: values; around: a range of this share to both sides for each start and param.
    The path of a scene whose objects see each other, *.scene: one integrator, step and arithmetic for all; cost, "cycles" or "time",
    within and work are of such a scene, and around is how far starts differ in other scenes. output: a file for the choice, or None.
    Starts the command that the package carries, so that Ctrl-C ends it; of a scene the result has what was found until then.
    FailedError: there is no truth to measure errors against.
    """
    if isinstance(model, (str, os.PathLike)) and os.fsdecode(model).endswith(".scene"):
        if ranges or params or objects is not None:
            raise ArgumentError("tune: ranges, params and objects are in the scene")
        return _tune_scene(os.fsdecode(model), tolerance, os.fspath(output) if output is not None else None, progress, around=around, span=span,
                           config=config, held_out=held_out, cost=cost, within=within, work=work)
    if cost is not None or within is not None or work is not None or output is not None:
        raise ArgumentError("tune: cost, within, work and output are of a scene")
    with _Files([model]) as files:
        scene = files.path / "found.scene"
        found = command(["tune", files.models[0], f"--tolerance={as_number('tolerance', tolerance)!r}", f"--output={scene}",
                 *_numbers("spread", ranges, 2), *_numbers("set", params, 1),
                 *_options(around=around, span=span, config=config, objects=objects, held_out=held_out)], files.found, progress=progress)
        text = scene.read_text() if scene.exists() else ""
        name = os.fsdecode(as_model(model)._where)
        return Tuning(found, re.sub(r'program = ".*";', lambda _: f'program = "{name}";', text))


def bench(*models: Union[Model, Source], integrators: Sequence[str] = (), config: Optional[str] = None, quick: bool = False,
          progress: bool = False) -> Table:
    """`fp3 bench`: error against run time for every integrator, arithmetic and step, beside a plain loop and GSL.

    A row for each point; docs/command.md describes the columns. Minutes a model, with quick seconds; it wants an idle machine.
    Starts the command that the package carries: the library has no benchmark.
    """
    if not models:
        raise ArgumentError("bench: expected a model")
    with _Files(models) as files:
        return Table(command(["bench", *files.models, *(f"--integrator={name}" for name in integrators), *_options(config=config, quick=quick)],
                             files.found, progress=progress)["points"])


def stress(*models: Union[Model, Source], integrators: Sequence[str] = (), only: Optional[str] = None, quick: bool = False,
           progress: bool = False) -> Table:
    """`fp3 stress`: what FP32 does to models, or without a model to the integrators, beside theory.

    A row for each result; `holds` says whether it is as it should be. Starts the command that the package carries: the
    library has no stress suite.
    """
    with _Files(models) as files:
        return Table(command(["stress", *files.models, *(f"--integrator={name}" for name in integrators), *_options(only=only, quick=quick)],
                             files.found, progress=progress)["results"])
