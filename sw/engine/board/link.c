/* SPDX-License-Identifier: Apache-2.0 */
/* link.c - see link.h. */
#include "link.h"

#include "packet.h"
#include "port.h"

#include <inttypes.h>
#include <stdlib.h>

/* A request is sent so often; the board has 100 ms for its answer, and twice as long each time. */
#define TRIES 5
#define PATIENCE 100

struct fp3_link {
    fp3_port port;
    uint32_t baud;
    uint8_t sequence;
    fp3_packet_reader reader;
    uint64_t sent, bytes, answers,
        repeats; /* bytes sent; that came; packets that were answers; requests sent again */
};

typedef struct {
    int is_write;
    uint32_t address, count;
    uint32_t *words;
} request;

fp3_status fp3_link_open(const char *port, uint32_t baud, fp3_link **link, fp3_error *error) {
    fp3_link *made = *link = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made->baud = baud;
    /* By the clock, so an answer to another program's request is not taken for ours. */
    made->sequence = (uint8_t)fp3_port_now();
    fp3_status status = fp3_port_open(port, baud, &made->port, error);
    if (status)
        fp3_link_close(link);
    return status;
}

void fp3_link_close(fp3_link **link) {
    if (*link)
        fp3_port_close(&(*link)->port);
    free(*link);
    *link = NULL;
}

uint64_t fp3_link_repeats(const fp3_link *link) { return link->repeats; }

uint64_t fp3_link_bytes(const fp3_link *link) { return link->sent + link->bytes; }

/* Whether the packet that the reader has answers the request; then the words and *refused are
 * filled. */
static int take(fp3_link *link, const request *r, uint32_t *refused) {
    const fp3_packet_reader *packet = &link->reader;
    if (packet->size < 2 || packet->content[0] != link->sequence || packet->content[1] > r->count)
        return 0;
    const uint32_t status = packet->content[1];
    const uint32_t words = r->is_write ? 0 : status ? status - 1 : r->count;
    if (packet->size != 2 + 4 * (size_t)words)
        return 0;
    for (uint32_t i = 0; i < words; i++)
        r->words[i] = fp3_packet_word(packet->content + 2 + 4 * i);
    *refused = status;
    link->answers++;
    return 1;
}

static fp3_status await_answer(fp3_link *link, const request *r, int64_t until, uint32_t *refused,
                               int *is_answered) {
    uint8_t bytes[FP3_PACKET_SIZE];
    *is_answered = 0;
    while (!*is_answered && fp3_port_now() < until) {
        size_t size = 0;
        fp3_status status = fp3_port_read(&link->port, bytes, sizeof bytes, until, &size);
        if (status)
            return status;
        link->bytes += size;
        for (size_t i = 0; i < size && !*is_answered; i++)
            *is_answered = fp3_packet_feed(&link->reader, bytes[i]) && take(link, r, refused);
    }
    return FP3_OK;
}

static fp3_status complain(const fp3_link *link, const request *r) {
    const char *port = link->port.name;
    fp3_error *error = link->port.error;
    if (link->answers)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "port %s: no answer any more: a %s of %" PRIu32 " words at 0x%08" PRIx32
                        " was sent %d times",
                        port, r->is_write ? "write" : "read", r->count, r->address, TRIES);
    if (link->bytes)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "port %s: %" PRIu64 " bytes came, and none of them was an answer: is the "
                        "board's rate %" PRIu32 " baud (--baud), and is it an FP3?",
                        port, link->bytes, link->baud);
    return fp3_fail(error, FP3_E_SYSTEM,
                    "port %s: no answer at %" PRIu32
                    " baud: does the board have power and its bitstream, is "
                    "this its port and its baud rate (--baud), is its reset released?",
                    port, link->baud);
}

/* What the line takes for both packets, if every byte is escaped, and a time for the board. */
static int64_t patience(const fp3_link *link, const request *r, int tries) {
    const uint64_t bits = 10u * 2u * (24u + 4u * (uint64_t)r->count);
    return (int64_t)(1000 * bits / link->baud) + ((int64_t)PATIENCE << tries);
}

fp3_status fp3_link_transfer(fp3_link *link, int is_write, uint32_t address, uint32_t *words,
                             uint32_t count, uint32_t *refused) {
    const request r = {is_write, address, count, words};
    uint8_t packet[FP3_PACKET_SIZE];
    const size_t size =
        fp3_packet_request(++link->sequence, is_write, address, words, count, packet);
    for (int tries = 0; tries < TRIES; tries++) {
        const int64_t until = fp3_port_now() + patience(link, &r, tries);
        int is_answered = 0;
        link->repeats += tries > 0;
        link->sent += size;
        fp3_status status = fp3_port_write(&link->port, packet, size, until);
        if (!status)
            status = await_answer(link, &r, until, refused, &is_answered);
        if (status || is_answered)
            return status;
    }
    return complain(link, &r);
}
