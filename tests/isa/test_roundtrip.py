"""Words and images through text and back, in numbers."""

import subprocess


def test_words_and_images_come_back_from_text(build, long):
    """100,000 words and hundreds of images; or two million and thousands."""
    words = 2_000_000 if long else 100_000
    got = subprocess.run(
        [build / "tests" / "isa_roundtrip", "--seed", "1", "--words", str(words)], text=True, capture_output=True, timeout=600
    )
    assert got.returncode == 0, got.stdout + got.stderr
    assert int(got.stdout.splitlines()[-1].split()[0]) >= words
