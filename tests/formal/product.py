"""The lemma of the multiplier: fp_mul_product's result is the product of its operands.

The circuit is read as an identity between integers. A word is the sum of its bits, each with its
power of two, so slices, shifts and concatenations need no rule. Starting from

    (the sum of the result's bits) - a * b                              modulo 2^width

each cell's output bits are replaced, from the result back to the operands, by what the cell says of
them: a multiplier by the product of its two words, an adder by their sum, an AND by the product of
two bits, a register by its input (that registers are balanced is shown elsewhere). What remains is a
polynomial in the operands' bits; the lemma holds if no term remains.

Assumed: $mul multiplies and $add adds, in yosys as in the vendor's tools. Nothing is assumed about
how the product is cut into tiles. An adder or multiplier whose word may be too narrow for its value
is accepted only if the carry it loses weighs a multiple of 2^width. Refused, not guessed at: cells
of other kinds, and words of which only a part is used.
"""

WORDS = {"$add": "+", "$sub": "-", "$mul": "*"}
BITS = ("$and", "$mux", "$not", "$or", "$xor", "$dff", "$pos")


class Lemma(Exception):
    """The circuit does not compute the product, or it is not evident that it does."""


def prove(module, operands, result):
    """module: yosys JSON of a flattened fp_mul_product; operands, result: names of its ports."""
    a, b, y = (module["ports"][name]["bits"] for name in (*operands, result))
    modulus = 1 << len(y)
    if len(a) + len(b) > len(y):
        raise Lemma(f"{len(y)} bits do not hold the product of {len(a)} and {len(b)}")
    cells = _sorted(module["cells"])
    zero = _zero_bits(cells)
    left = _sum(y, zero)
    for term, weight in _times(_sum(a, zero), _sum(b, zero)).items():
        _add(left, term, -weight, modulus)
    for cell in reversed(cells):
        left = _replace(left, cell, zero, modulus)
    if left:
        raise Lemma(f"{len(left)} terms remain, for example "
                    + ", ".join(f"{w:#x} * bits {sorted(t)}" for t, w in list(left.items())[:3]))


def _sorted(cells):
    """Cells from operands to result."""
    driver = {bit: name for name, cell in cells.items()
              for port, bits in cell["connections"].items()
              if cell["port_directions"][port] == "output" for bit in bits}
    order, state = [], {}

    def visit(name):
        if state.get(name) == "open":
            raise Lemma("the circuit feeds back on itself")
        if name in state:
            return
        state[name] = "open"
        cell = cells[name]
        if cell["type"] not in WORDS and cell["type"] not in BITS:
            raise Lemma(f"no rule for the cell {name} of type {cell['type']}")
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input" and port != "CLK":
                for bit in bits:
                    if bit in driver:
                        visit(driver[bit])
        state[name] = "done"
        order.append(cell)

    for name in cells:
        visit(name)
    return order


def _zero_bits(cells):
    """Output bits of words that are always 0: above the largest value the cell can have."""
    zero = {"0"}
    for cell in cells:
        if cell["type"] == "$dff":
            pairs = zip(cell["connections"]["D"], cell["connections"]["Q"])
            zero.update(q for d, q in pairs if d in zero)
        elif cell["type"] in ("$add", "$mul"):
            bound = _bound(cell["type"], _operand(cell, "A"), _operand(cell, "B"), zero)
            y = cell["connections"]["Y"]
            if bound < 1 << len(y):
                zero.update(y[bound.bit_length():])
    return zero


def _bound(kind, a, b, zero):
    """The largest value that the exact result of $add or $mul can have."""
    a, b = (sum(1 << i for i, bit in enumerate(word) if bit not in zero) for word in (a, b))
    return a * b if kind == "$mul" else a + b


def _operand(cell, port):
    bits = cell["connections"][port]
    if int(cell["parameters"][f"{port}_SIGNED"], 2) and bits[-1] != "0":
        raise Lemma(f"a signed operand in a {cell['type']}")
    return bits


def _replace(left, cell, zero, modulus):
    wires = cell["connections"]
    if cell["type"] in WORDS:
        return _replace_word(left, cell, zero, modulus)
    for i, bit in enumerate(wires["Q" if cell["type"] == "$dff" else "Y"]):
        left = _replace_bit(left, bit, lambda: _bit(cell, i, zero), modulus)
    return left


def _replace_bit(left, bit, value, modulus):
    touched = [term for term in left if bit in term]
    value = value() if touched else None
    for term in touched:
        weight = left.pop(term)
        for more, factor in _times({term - {bit}: weight}, value).items():
            _add(left, more, factor, modulus)
    return left


def _bit(cell, i, zero):
    """Bit i of a bitwise cell as a polynomial."""
    def port(name, index=i):
        bits = cell["connections"][name]
        return _sum([bits[index] if index < len(bits) else "0"], zero)

    kind, one = cell["type"], {frozenset(): 1}
    if kind == "$dff":
        return port("D")
    a = port("A")
    if kind == "$pos":
        return a
    if kind == "$not":
        return _combine(one, 1, a, -1)
    b = port("B")
    if kind == "$mux":
        return _combine(a, 1, _times(port("S", 0), _combine(b, 1, a, -1)), 1)
    both = _times(a, b)
    if kind == "$and":
        return both
    return _combine(_combine(a, 1, b, 1), 1, both, -1 if kind == "$or" else -2)


def _replace_word(left, cell, zero, modulus):
    kind, y = cell["type"], cell["connections"]["Y"]
    a, b = (_operand(cell, port) for port in "AB")
    while kind == "$add" and a and b and y and (a[0] in zero or b[0] in zero):
        low = [b[0] if a[0] in zero else a[0]]           # no carry so far: a wire
        left = _replace_bit(left, y[0], lambda: _sum(low, zero), modulus)
        a, b, y = a[1:], b[1:], y[1:]
    alive = {bit: i for i, bit in enumerate(y) if bit not in zero}
    if any(len(term) > 1 and not term.isdisjoint(alive) for term in left):
        raise Lemma(f"bits of a {kind} are multiplied with others")
    if not any(frozenset([bit]) in left for bit in alive):
        return left
    lowest = min(alive, key=alive.get)
    unit = left.get(frozenset([lowest]), 0) >> alive[lowest]
    for bit, i in alive.items():
        if (left.pop(frozenset([bit]), 0) - (unit << i)) % modulus:
            raise Lemma(f"only a part of a {kind} is used")
    exact = kind != "$sub" and _bound(kind, a, b, zero) < 1 << len(y)
    if not exact and (unit << len(y)) % modulus:
        raise Lemma(f"a {kind} may lose a carry")
    a, b = _sum(a, zero), _sum(b, zero)
    value = _times(a, b) if kind == "$mul" else _combine(a, 1, b, -1 if kind == "$sub" else 1)
    for term, weight in value.items():
        _add(left, term, unit * weight, modulus)
    return left


def _sum(bits, zero):
    """A word as a polynomial: term (a set of bits, all 1) -> weight."""
    result = {}
    for i, bit in enumerate(bits):
        if bit == "x":
            raise Lemma("an undefined bit")
        if bit not in zero:
            term = frozenset() if bit == "1" else frozenset([bit])
            result[term] = result.get(term, 0) + (1 << i)
    return result


def _times(a, b):
    result = {}
    for s, v in a.items():
        for t, w in b.items():
            result[s | t] = result.get(s | t, 0) + v * w
    return result


def _combine(a, v, b, w):
    result = {t: v * x for t, x in a.items()}
    for t, x in b.items():
        result[t] = result.get(t, 0) + w * x
    return result


def _add(polynomial, term, weight, modulus):
    total = (polynomial.get(term, 0) + weight) % modulus
    if total:
        polynomial[term] = total
    else:
        polynomial.pop(term, None)
