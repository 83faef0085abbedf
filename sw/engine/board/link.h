/* SPDX-License-Identifier: Apache-2.0 */
/* link.h - reads and writes words on a board's bus, over a serial port; asks again where an answer
 * is lost. */
#ifndef FP3_LINK_H
#define FP3_LINK_H

#include <fp3/status.h>
#include <stdint.h>

typedef struct fp3_link fp3_link;

/* Says nothing to the board. Failures as of fp3_port_open. The caller closes *link, which is NULL
 * on failure; port and error must outlive it. */
fp3_status fp3_link_open(const char *port, uint32_t baud, fp3_link **link, fp3_error *error);
void fp3_link_close(fp3_link **link);

/* 1 to 64 words to, or from, addresses that grow by 4; the first transfer must be a read. *refused:
 * the number of the first word that the bus answered with an error, from 1, or 0. FP3_E_SYSTEM: no
 * answer, or the port has gone. */
fp3_status fp3_link_transfer(fp3_link *link, int is_write, uint32_t address, uint32_t *words,
                             uint32_t count, uint32_t *refused);
/* Requests so far that were sent again. */
uint64_t fp3_link_repeats(const fp3_link *link);
/* Bytes that were sent, and that came. */
uint64_t fp3_link_bytes(const fp3_link *link);

#endif
