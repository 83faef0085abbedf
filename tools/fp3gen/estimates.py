"""The table of first approximations that rcp and rsqrt read."""

import math


def estimates():
    """The estimates of 1 / a and 1 / sqrt(a) as fractions of 9 bits: the largest that is not too large
    for any number with this index, so that a * d and a * d * d never exceed 1.

    rcp: the upper 10 bits f of a's fraction; d = (512 + g) / 1024 <= 1 / m for m < 1 + (f + 1) / 1024.
    rsqrt, from 1024 on: the lowest bit of a's exponent, then 9 bits f. With it 1, d = (512 + g) / 1024
    <= 1 / sqrt(m) for m < 1 + (f + 1) / 512. With it 0, one place more of d: the root is of twice that
    and d = (1024 + g) / 2048, below 0.708.
    """
    rcp = [(1 << 20) // (1025 + f) - 512 for f in range(1024)]
    even = [math.isqrt((1 << 30) // (513 + f)) - 1024 for f in range(512)]
    odd = [math.isqrt((1 << 29) // (513 + f)) - 512 for f in range(512)]
    return rcp + even + odd
