#!/usr/bin/env python3
"""The top module of a configuration: the ports of rtl/fp3.v with their attributes and no parameters left. `make top CONFIG=world`.

    tools/tops.py CONFIG...                 writes build/rtl/fp3_CONFIG.v where its text has changed, and names it
    tools/tops.py --output FOLDER CONFIG... likewise there
    tools/tops.py FILE.yml                  as a generator of FuseSoC (fp3.core), for the configuration that the file names
"""

import argparse
import pathlib
import re
import sys

from fp3gen import verilog
from fp3gen.check import Bad
from fp3gen.read import load
from fp3gen.text import licensed

ROOT = pathlib.Path(__file__).resolve().parents[1]
CORE = "CAPI=2:\nname: {vlnv}\nfilesets:\n  rtl: {{file_type: verilogSource, files: [{file}]}}\ntargets:\n  default: {{filesets: [rtl]}}\n"


def write(row, machine, folder=ROOT / "build/rtl"):
    """The file; untouched where it has this text already, so that nothing is built again."""
    path = folder / f"fp3_{row['name']}.v"
    text = "\n".join(licensed(path.name, verilog.config_verilog(row, machine, ROOT))) + "\n"
    folder.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
    return path


def generator(text):
    """The configuration and the name of the core that FuseSoC asks for, in plain YAML."""
    return (re.search(rf"^ *{key}: *['\"]?([^'\"\n]+)", text, re.M)[1] for key in ("config", "vlnv"))


def main():
    parser = argparse.ArgumentParser(description="top modules of configurations")
    parser.add_argument("configs", nargs="+", metavar="CONFIG")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/rtl", help="the folder (build/rtl)")
    args = parser.parse_args()
    if args.configs[0].endswith(".yml"):
        config, vlnv = generator(pathlib.Path(args.configs[0]).read_text(encoding="utf-8"))
        args.configs, args.output = [config], pathlib.Path.cwd()
        pathlib.Path("top.core").write_text(CORE.format(vlnv=vlnv, file=f"fp3_{config}.v"), encoding="utf-8")
    try:
        machine = load(ROOT)
        rows = {row["name"]: row for row in machine.configs}
        for name in args.configs:
            if name not in rows:
                raise Bad(f"there is no configuration {name}: there are {', '.join(rows)}")
            print(write(rows[name], machine, args.output))
    except (Bad, OSError) as error:
        sys.exit(f"tops.py: {error}")


if __name__ == "__main__":
    main()
