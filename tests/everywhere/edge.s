# edge.s - a product that is rounded to 2^-126: tiny before rounding, not after it, so it raises no underflow.

.state  x               # the product
.const  p 1.0843345e-19 # (1 + 2^-13) 2^-63
.const  q 1.0840699e-19 # (1 - 2^-13) 2^-63

step:
    mul  x, p, q
