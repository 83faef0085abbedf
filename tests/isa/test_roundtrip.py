"""Words and images through text and back, in numbers."""

import subprocess


def test_a_million_words_and_thousands_of_images_come_back_from_text(build):
    got = subprocess.run(
        [build / "tests" / "isa_roundtrip", "--seed", "1"], text=True, capture_output=True, timeout=600
    )
    assert got.returncode == 0, got.stdout + got.stderr
    assert int(got.stdout.splitlines()[-1].split()[0]) >= 1_000_000
