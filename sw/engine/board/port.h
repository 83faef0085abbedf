/* SPDX-License-Identifier: Apache-2.0 */
/* port.h - a serial port: 8N1, raw, without flow control. */
#ifndef FP3_PORT_H
#define FP3_PORT_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    int file; /* -1: closed */
    const char *name;
    fp3_error *error; /* where its calls say why they failed */
} fp3_port;

#define FP3_PORT_BAUD 115200u

/* name must outlive the port. FP3_E_ARGUMENT: no such rate. FP3_E_SYSTEM: there is no such port, or
 * it cannot be used. Bytes that came before are dropped. */
fp3_status fp3_port_open(const char *name, uint32_t baud, fp3_port *port, fp3_error *error);
void fp3_port_close(fp3_port *port);

/* Milliseconds of a clock that only goes forward. */
int64_t fp3_port_now(void);
/* All bytes, or those that leave until then. FP3_E_SYSTEM: the port has gone. */
fp3_status fp3_port_write(fp3_port *port, const uint8_t *bytes, size_t size, int64_t until);
/* What has come, as soon as something has; *size is 0 if nothing came until then. */
fp3_status fp3_port_read(fp3_port *port, uint8_t *bytes, size_t room, int64_t until, size_t *size);

#endif
