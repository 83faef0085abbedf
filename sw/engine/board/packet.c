/* SPDX-License-Identifier: Apache-2.0 */
/* packet.c - see packet.h. */
#include "packet.h"

#include <zlib.h>

/* SLIP, RFC 1055. */
enum { END = 0xc0, ESCAPE = 0xdb, ESCAPED_END = 0xdc, ESCAPED_ESCAPE = 0xdd };

typedef struct {
    uint8_t *packet;
    size_t size;
    uLong crc;
} writer;

static void put_raw(writer *w, uint8_t byte) {
    if (byte == END || byte == ESCAPE) {
        w->packet[w->size++] = ESCAPE;
        byte = byte == END ? ESCAPED_END : ESCAPED_ESCAPE;
    }
    w->packet[w->size++] = byte;
}

static void put_byte(writer *w, uint8_t byte) {
    w->crc = crc32(w->crc, &byte, 1);
    put_raw(w, byte);
}

static void put_word(writer *w, uint32_t word) {
    for (int i = 0; i < 32; i += 8)
        put_byte(w, (uint8_t)(word >> i));
}

size_t fp3_packet_request(uint8_t sequence, int is_write, uint32_t address, const uint32_t *words,
                          uint32_t count, uint8_t packet[FP3_PACKET_SIZE]) {
    writer w = {packet, 0, crc32(0, NULL, 0)};
    packet[w.size++] = END; /* ends what noise began */
    put_byte(&w, sequence);
    put_byte(&w, (uint8_t)((is_write ? 0x80 : 0) | (count - 1)));
    put_word(&w, address);
    for (uint32_t i = 0; is_write && i < count; i++)
        put_word(&w, words[i]);
    const uLong crc = w.crc;
    for (int i = 0; i < 32; i += 8)
        put_raw(&w, (uint8_t)(crc >> i));
    packet[w.size++] = END;
    return w.size;
}

uint32_t fp3_packet_word(const uint8_t *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static int end(fp3_packet_reader *r) {
    const int is_whole = !r->is_bad && !r->is_escaped && r->size > 4 &&
                         crc32(crc32(0, NULL, 0), r->content, (uInt)(r->size - 4)) ==
                             fp3_packet_word(r->content + r->size - 4);
    r->is_over = 1;
    r->size -= is_whole ? 4 : 0;
    return is_whole;
}

int fp3_packet_feed(fp3_packet_reader *r, uint8_t byte) {
    if (r->is_over)
        r->size = (size_t)(r->is_over = r->is_bad = r->is_escaped = 0);
    if (byte == END)
        return end(r);
    if (r->is_escaped) {
        r->is_bad |= byte != ESCAPED_END && byte != ESCAPED_ESCAPE;
        byte = byte == ESCAPED_END ? END : ESCAPE;
        r->is_escaped = 0;
    } else if (byte == ESCAPE) {
        r->is_escaped = 1;
        return 0;
    }
    if (r->size < sizeof r->content)
        r->content[r->size++] = byte;
    else
        r->is_bad = 1;
    return 0;
}
