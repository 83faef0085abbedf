"""Reads and checks isa/*.toml."""

import tomllib

from .check import Bad
from .configs import check_configs, cut_positions
from .isa import check_isa
from .registers import check_registers


def load(root):
    def read(file):
        path = root / "isa" / file
        try:
            return tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise Bad(f"isa/{file}: {error.strerror}") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise Bad(f"isa/{file}: {error}") from None

    isa, regs, configs = read("isa.toml"), read("registers.toml"), read("configs.toml")
    check_isa(isa)
    check_registers(regs)
    positions = {unit: cut_positions(root, f"fp_{unit}") for unit in ("add", "mul")}
    return isa, regs, check_configs(configs, regs, positions)
