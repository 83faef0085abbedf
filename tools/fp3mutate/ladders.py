"""Which modules get mutants in which design, and what may kill them there, the cheapest rung first."""

from typing import NamedTuple

import control
import simulate
import test_modules
import test_parts

from .netlist import Design
from .promises import Promises, Spec
from .rungs import Bench, Cosim, Units


class Ladder(NamedTuple):
    """A design and its rungs. Modules that lie in it beside the top may be among those that get mutants."""
    name: str
    modules: tuple
    top: str
    parameters: dict
    rungs: object                        # of a Design: its rungs
    read: str = ""                       # a source beside rtl/
    kind: type = Design
    whole: bool = True                   # equivalence is asked of the whole design; else of the mutant's module, as if its inputs were any


def of_module(root, name, *modules):
    """A bench of tests/modules/test_modules.py."""
    parameters = test_modules.OWN[name] if name in test_modules.OWN else {"CONFIG": simulate.config_word(root, test_modules.BENCHES[name])}
    return Ladder(name, modules or (name,), f"fp3_{name}", parameters, lambda design: [Bench(design, name, {}, root)])


def of_part(root, name, *modules):
    """A bench of tests/modules/test_parts.py."""
    part = test_parts.PARTS[name]
    return Ladder(name, modules or (part.module,), f"fp3_{part.module}", part.parameters, lambda design: [Bench(design, part.bench, part.told, root)])


def of_units(made, name, modules, read, parameters, *programs):
    """A bench of tests/fp or tests/lns."""
    top = read.split()[0].rpartition("/")[2].removesuffix(".v")
    return Ladder(name, modules, top, parameters, lambda design: [Units(design, made, *words) for words in programs], read)


def of_config(made, config, modules, *programs):
    """Programs that compare a named configuration with the engine isa."""
    rungs = lambda design: [Cosim(design, made, *words) for words in programs]
    return Ladder(config, modules, f"fp3_{config}", {}, rungs, f"{made}/rtl/fp3_{config}.v", whole=False)


def of_spec(subject):
    """A specification of tests/formal."""
    module = subject.sources[0].removeprefix("fp3_").removesuffix(".v")
    return Ladder(f"{module}, its promises", (module,), subject.spec, {}, lambda design: [Promises(design)], subject, Spec, False)


def all_of(root, made):
    stream = lambda config, *more: ("random_stream", "--config", config, "--instructions", 20000, *more)
    neighbours = lambda config: [("neighbours", 1, config, 12), ("given", 1, config, 20, 30)]
    return [
        of_module(root, "rounds"),
        of_module(root, "issue"),
        of_module(root, "exchange"),
        of_module(root, "visits"),
        of_module(root, "keep"),
        of_module(root, "lane", "lane", "lane_end", "lane_operands", "lane_result", "lane_status", "lane_store"),
        of_module(root, "lane_report"),
        of_part(root, "decode, everything for one object in turn"),
        of_part(root, "decode, dual"),
        of_part(root, "decode, lists that are made"),
        of_part(root, "hub, waits"),
        of_part(root, "fp_rint, cut"),
        of_part(root, "narrow, binary16"),
        of_part(root, "narrow, bfloat16"),
        of_part(root, "widen, binary16"),
        of_part(root, "mix"),
        of_part(root, "uart_rx"),
        of_part(root, "slip_tx"),
        of_part(root, "shift_right_sticky, beyond its width"),
        of_part(root, "ram_forward, few words"),
        of_part(root, "ram_forward, many words"),
        of_units(made, "fp, 8 bits", ("fp_add", "fp_add_near", "fp_add_round", "fp_add_swap", "fp_mul", "fp_mul_pack", "fp_mul_product",
                 "fp_mul_scale", "fp_fma", "fp_fma_align", "fp_fma_normalize", "fp_fma_product", "fp_fma_round"), "tests/fp/fp_bench.v", {"ONLY": 3},
                 *(("fp_small", "--op", op, "--row", 3, "--pairs", 20000) for op in ("add", "sub", "mul", "madd", "msub"))),
        of_units(made, "lns", ("lns_add", "lns_add_curve", "lns_curve", "lns_inverse", "lns_mul", "lns_root"),
                 "tests/lns/lns_bench.v tests/lns/fp3_lns_from_float.v tests/lns/fp3_lns_to_float.v", {}, ("lns_rtl", 30000)),
        of_config(made, "single", ("solo", "solo_arith", "fetch", "axi_lite", "responses"), stream("single"), ("host_port", "single")),
        of_config(made, "many", ("host_port", "host_decode", "sequencer", "one_stream", "sweep", "batch", "counters", "lane_arith",
                  "adder", "multiplier", "unit", "tile", "tile_scheduler"),
                  stream("many"), ("host_port", "many")),
        of_config(made, "world", ("loops", "lists"), *neighbours("world")),
        of_config(made, "shared", ("shared_arith",), stream("shared")),
        of_config(made, "dual", ("two_streams", "dual_sweep", "dual_end", "dual_operands", "lane_group", "product", "fp_scale"), stream("dual")),
        of_config(made, "single_fused", ("solo_fused",), stream("single_fused")),
        of_config(made, "log", ("log_arith",), stream("log")),
        of_config(made, "fused_full", ("fused_arith", "fused_adder", "fp_value", "fp_estimate", "fp_exponent"), stream("fused_full")),
        of_config(made, "many_half", ("draws",), stream("many_half")),
        *map(of_spec, (control.SCOREBOARD, control.ARBITER, control.PACE, control.DUAL_PACE)),
    ]
