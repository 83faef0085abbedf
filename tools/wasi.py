#!/usr/bin/env python3
"""Runs a command that is compiled for WASI, with the directories, streams and environment of whoever starts it.

    .venv/bin/python tools/wasi.py build/wasm/fp3.wasm run programs/kepler.ode --engine isa
"""

import os
import sys

from wasmtime import Config, Engine, ExitTrap, Linker, Module, Store, WasiConfig


def main():
    path, *words = sys.argv[1:]
    config = Config()
    config.cache = True
    engine = Engine(config)
    wasi = WasiConfig()
    wasi.argv = [os.path.basename(path), *words]
    wasi.env = list(os.environ.items())
    wasi.inherit_stdin()
    wasi.inherit_stdout()
    wasi.inherit_stderr()
    for place in [".", *sorted(entry.path for entry in os.scandir("/") if entry.is_dir())]:
        wasi.preopen_dir(place, place)
    store = Store(engine)
    store.set_wasi(wasi)
    linker = Linker(engine)
    linker.define_wasi()
    start = linker.instantiate(store, Module.from_file(engine, path)).exports(store)["_start"]
    try:
        start(store)
    except ExitTrap as end:
        return end.code
    return 0


if __name__ == "__main__":
    sys.exit(main())
