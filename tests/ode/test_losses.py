"""What the compiler counts as lost below the normal numbers of double, without asking for a flag: WebAssembly has none."""

import subprocess


def test_what_underflows_is_what_the_processor_flags(build):
    said = subprocess.run([build / "tests/losses", "100000"], capture_output=True, text=True, check=True).stdout
    rows = [tuple(map(int, line.split())) for line in said.splitlines()]
    assert len(rows) == 17 and all(different == 0 for _, _, different in rows), said
    assert sum(flagged > 1000 for _, flagged, _ in rows) == 13
