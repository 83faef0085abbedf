"""What a UART bridge has to do (docs/board.md), byte for byte, on a bus with 1024 words at 0; packets of a host, good and bad."""

import zlib

END, ESCAPE = 0xc0, 0xdb
BEYOND = 4096                            # addresses from here on are errors
ADDRESSES = 1 << 24                      # the bridge itself refuses these


def checked(body):
    return bytes(body) + zlib.crc32(bytes(body)).to_bytes(4, "little")


def escaped(data):
    return bytes(data).replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc")


def unescaped(data):
    """None: an escape is broken."""
    out, rest = bytearray(), iter(data)
    for byte in rest:
        if byte == ESCAPE:
            byte = {0xdc: END, 0xdd: ESCAPE}.get(next(rest, None))
            if byte is None:
                return None
        out.append(byte)
    return bytes(out)


def request(sequence, address, words=None, count=None):
    """The body of a request: a write of `words`, or a read of `count`."""
    command = 0x80 | len(words) - 1 if words is not None else count - 1
    return bytes([sequence, command]) + address.to_bytes(4, "little") + b"".join(w.to_bytes(4, "little") for w in words or ())


class Bridge:
    def __init__(self):
        self.memory, self.kept = [0] * 1024, None
        self.transfers, self.answers = [], []

    def packet(self, data):
        """The bytes of a packet between two ends, without framing errors. Returns whether it is answered."""
        body = unescaped(data)
        if body is None or len(body) < 10 or body != checked(body[:-4]) or body[1] & 0x40:
            return False
        sequence, words = body[0], (body[1] & 63) + 1
        write = body[1] >= 0x80
        if len(body) != 10 + 4 * words * write:
            return False
        at = int.from_bytes(body[2:6], "little")
        data = [int.from_bytes(body[6 + 4 * k:10 + 4 * k], "little") for k in range(words)] if write else [0] * words
        if not (write and self.kept and self.kept[0] == sequence):
            status, values = self.execute(write, at, data)
            self.kept = (sequence, status) if write else None
        answer = [sequence, self.kept[1]] if write else [sequence, status, *b"".join(v.to_bytes(4, "little") for v in values)]
        self.answers.append(checked(answer))
        return True

    def execute(self, write, at, data):
        values = []
        for k, word in enumerate(data):
            here = at + 4 * k
            if here >= ADDRESSES:
                return k + 1, values
            if here < BEYOND and write:
                self.memory[here >> 2] = word
            if not write:
                word = self.memory[here >> 2] if here < BEYOND else 0
            self.transfers.append(f"{'w' if write else 'r'} {here:06x} {word:08x}")
            if here >= BEYOND:
                return k + 1, values
            values.append(word)
        return 0, values


class Host:
    """A script for the bench, and what has to come of it."""

    def __init__(self, chance, most=64):
        self.chance, self.most, self.bridge, self.script = chance, most, Bridge(), []
        self.sequence, self.last = 0, None
        self.good = self.bad = 0

    def bytes(self, data):
        self.script += [f"b {byte:02x}" for byte in data]

    def ask(self, body, begin=True):
        """A good packet: it is answered."""
        data = escaped(checked(body))
        self.bytes(([END] if begin else []) + [*data, END])
        assert self.bridge.packet(data)
        self.script.append("a 0")
        self.good += 1

    def overrun(self, body, late):
        """A good packet, and before its answer is whole another one: that is not heard."""
        self.bytes([END, *escaped(checked(body)), END, *escaped(checked(late)), END])
        assert self.bridge.packet(escaped(checked(body)))
        self.script.append("a 0")
        self.good += 1

    def body(self):
        chance = self.chance
        count = chance.choice((1, 1, 2, 3, chance.randrange(1, self.most + 1)))
        at = chance.choice((4 * chance.randrange(1024), 4 * chance.randrange(1024), 4096 - 4 * chance.randrange(70),
                            ADDRESSES - 4 * chance.randrange(3), 4 * chance.randrange(1 << 30), 2**32 - 4))
        self.sequence = self.sequence + 1 & 255
        odd = lambda: chance.choice((0xc0c0c0c0, 0xdbdcdbdd, chance.getrandbits(32)))
        return request(self.sequence, at, words=[odd() for _ in range(count)]) if chance.random() < 0.6 else request(self.sequence, at, count=count)

    def ask_something(self):
        if self.last and self.chance.random() < 0.2:
            self.ask(self.last)                            # its answer was lost
            return
        self.last = self.body()
        self.ask(self.last, self.chance.random() < 0.99 or self.bad)

    def disturb(self):
        """A bad packet: nothing may come of it. What has no end ends where the next packet begins."""
        chance, self.bad = self.chance, self.bad + 1
        body = self.body()
        whole = checked(body)
        line = [END, *escaped(whole), END]
        place = chance.randrange(1, len(line) - 1)
        kind = chance.randrange(14)
        if kind == 0:                                      # garbage
            line = [chance.choice((END, ESCAPE, 0xdc, 0xdd, chance.randrange(256))) for _ in range(chance.randrange(40))]
        elif kind == 1:                                    # a broken CRC, or a broken body
            spoilt = bytearray(whole)
            spoilt[chance.randrange(len(spoilt))] ^= 1 << chance.randrange(8)
            line = [END, *escaped(spoilt), END]
        elif kind == 2:                                    # a broken escape
            place = max(place, 2)
            line[place:place] = [ESCAPE, chance.choice((ESCAPE, 0, 0xdb, 0xde, END))]
        elif kind == 3:                                    # truncated
            line = [END, *escaped(whole[:chance.randrange(1, len(whole))]), END]
        elif kind == 4:                                    # truncated, its CRC right
            line = [END, *escaped(checked(body[:chance.randrange(1, len(body))])), END]
        elif kind == 5:                                    # too long, its CRC right
            line = [END, *escaped(checked(body + bytes(chance.randrange(256) for _ in range(chance.choice((1, 4, 5, 5 * self.most)))))), END]
        elif kind == 6:                                    # too long, with bytes behind its CRC
            line = [END, *escaped(whole + bytes([chance.randrange(256)])), END]
        elif kind == 7:                                    # an unknown command
            line = [END, *escaped(checked(bytes([body[0], body[1] | 0x40]) + body[2:])), END]
        elif kind == 8:                                    # a write that says it is a read, or the other way round
            line = [END, *escaped(checked(bytes([body[0], body[1] ^ 0x80]) + body[2:])), END]
        elif kind == 9:                                    # another number of words
            line = [END, *escaped(checked(bytes([body[0], 0x80 | (body[1] + 1 & 63)]) + body[2:])), END]
        elif kind == 10:                                   # no end
            line = line[:place]
        elif kind == 11:                                   # ends within
            place = max(place, 2)
            line[place:place] = [END, END]
        if kind == 12:                                     # a stop bit that is low; in an end: two packets become one
            place = chance.randrange(1, len(line))
            self.bytes(line[:place])
            self.script.append(f"x {line[place]:02x}")
            self.bytes(line[place + 1:])
        elif kind == 13:                                   # a break
            self.bytes(line[:place])
            self.script.append(f"k {chance.randrange(10, 50):x}")
            self.bytes(line[place:])
        else:
            self.bytes(line)
            for packet in bytes(line).split(bytes([END])):
                assert not self.bridge.packet(packet), (kind, bytes(line).hex())

    def expected(self):
        return self.bridge.transfers, self.bridge.answers


def heard(text):
    """The transfers, the packets and the last line of what the bench wrote."""
    lines = text.splitlines()
    said = bytes(int(line[2:], 16) for line in lines if line[0] == "t")
    packets = [unescaped(packet) for packet in said.split(bytes([END])) if packet]
    assert None not in packets, "a broken escape"
    return [line for line in lines if line[:2] in ("w ", "r ")], packets, lines[-1]
