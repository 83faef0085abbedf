/* SPDX-License-Identifier: Apache-2.0 */
/* packet.h - the packets between a host and a board: docs/board.md. */
#ifndef FP3_PACKET_H
#define FP3_PACKET_H

#include <stddef.h>
#include <stdint.h>

#define FP3_PACKET_WORDS 64
#define FP3_PACKET_CONTENT                                                                         \
    (6 + 4 * FP3_PACKET_WORDS + 4) /* the largest, with its CRC, without escapes */
#define FP3_PACKET_SIZE (2 * FP3_PACKET_CONTENT + 2) /* the largest on the line */

/* A request for 1 to FP3_PACKET_WORDS words; words: what a write writes, ignored by a read. Returns
 * its size. */
size_t fp3_packet_request(uint8_t sequence, int is_write, uint32_t address, const uint32_t *words,
                          uint32_t count, uint8_t packet[FP3_PACKET_SIZE]);

/* Begins as {0}. */
typedef struct {
    uint8_t content[FP3_PACKET_CONTENT];
    size_t size;                     /* of a whole packet: without its CRC */
    int is_escaped, is_bad, is_over; /* is_over: the next byte begins a packet */
} fp3_packet_reader;

/* The next byte of the line. 1: with it a packet with a right CRC is whole, until the next byte. */
int fp3_packet_feed(fp3_packet_reader *reader, uint8_t byte);

/* Four bytes, low first. */
uint32_t fp3_packet_word(const uint8_t *bytes);

#endif
