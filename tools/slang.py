#!/usr/bin/env python3
"""Reads RTL with slang, strictly as Verilog-2005: `tools/lint.sh rtl` runs this in .venv/.

    tools/slang.py FILE...     each has a top: build/rtl/fp3_many.v, rtl/fp/fp3_fp_add.v, rtl/board/fp3_board.v; silent and 0 where all is well

slang refuses what other tools let pass, such as the use of a name above its declaration. Every warning is an error. These are not asked for:

  shift-count-overflow      a shift by the whole width gives 0, and widths follow from the configuration
  unconnected-output-port   a top leaves the trace open, unless it is asked for
"""

import pathlib
import sys

from pyslang.driver import Driver

ROOT = pathlib.Path(__file__).resolve().parents[1]
OPTIONS = "--std 1364-2005 -Werror -Wno-shift-count-overflow -Wno-unconnected-output-port -DFP3_CHECK -I rtl"


def read(file):
    listed = [line for line in (ROOT / "rtl/gen/files.f").read_text(encoding="utf-8").splitlines() if line.startswith("rtl/")
              and pathlib.Path(line).name != pathlib.Path(file).name]  # which may be a family's
    board = [path.relative_to(ROOT).as_posix() for name in ("board", "video") for path in sorted((ROOT / "rtl" / name).glob("*.v")) if not path.stem.endswith("_top")]
    around = [*board, "build/rtl/fp3_single.v", "build/rtl/fp3_world.v"] if file in board else []
    driver = Driver()
    driver.addStandardArgs()
    driver.parseCommandLine(f"slang {OPTIONS} --top {pathlib.Path(file).stem} {' '.join(dict.fromkeys([*listed, *around, file]))}")
    fine = driver.processOptions() and driver.parseAllSources()
    driver.reportCompilation(driver.createCompilation(), True)
    return driver.reportDiagnostics(True) and fine


if __name__ == "__main__":
    sys.exit(not all([read(file) for file in sys.argv[1:]]))
