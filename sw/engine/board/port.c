/* SPDX-License-Identifier: Apache-2.0 */
/* port.c - see port.h. */
#include "port.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static const struct {
    uint32_t baud;
    speed_t code;
} speeds[] = {
    {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
    {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},
    {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000},
    {3000000, B3000000},
};
enum { SPEEDS = sizeof speeds / sizeof *speeds };

#define BAUDS_SIZE 160
static void list_bauds(char text[BAUDS_SIZE]) {
    size_t size = 0;
    for (int i = 0; i < SPEEDS; i++)
        size += (size_t)snprintf(text + size, BAUDS_SIZE - size, "%s%u", i ? ", " : "",
                                 (unsigned)speeds[i].baud);
}

static fp3_status find_speed(uint32_t baud, speed_t *code, fp3_error *error) {
    char list[BAUDS_SIZE];
    for (int i = 0; i < SPEEDS; i++)
        if (speeds[i].baud == baud) {
            *code = speeds[i].code;
            return FP3_OK;
        }
    list_bauds(list);
    return fp3_fail(error, FP3_E_ARGUMENT, "no baud rate %u: there are %s", (unsigned)baud, list);
}

static fp3_status cannot(const char *name, fp3_error *error) {
    const char *why = errno == ENOENT || errno == ENXIO || errno == ENODEV
                          ? "; is the board plugged in? /dev/serial/by-id lists the ports"
                      : errno == EACCES || errno == EPERM
                          ? "; you must be a member of the group that owns the port, often dialout"
                      : errno == EWOULDBLOCK ? "; another program uses the port"
                                             : "";
    return fp3_fail(error, FP3_E_SYSTEM, "port %s: %s%s", name,
                    errno == EWOULDBLOCK ? "taken" : strerror(errno), why);
}

/* HUPCL off: closing must not reset a board that has its reset at DTR. */
static fp3_status set_up(fp3_port *port, speed_t code, uint32_t baud) {
    struct termios t;
    if (tcgetattr(port->file, &t))
        return cannot(port->name, port->error);
    cfmakeraw(&t);
    t.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB | CRTSCTS | HUPCL);
    t.c_cflag |= CLOCAL | CREAD;
    t.c_cc[VMIN] = 1;
    t.c_cc[VTIME] = 0;
    if (cfsetispeed(&t, code) || cfsetospeed(&t, code) || tcsetattr(port->file, TCSAFLUSH, &t) ||
        tcgetattr(port->file, &t))
        return cannot(port->name, port->error);
    return cfgetospeed(&t) == code ? FP3_OK
                                   : fp3_fail(port->error, FP3_E_SYSTEM, "port %s: no baud rate %u",
                                              port->name, (unsigned)baud);
}

fp3_status fp3_port_open(const char *name, uint32_t baud, fp3_port *port, fp3_error *error) {
    speed_t code = B0;
    *port = (fp3_port){-1, name, error};
    fp3_status status = find_speed(baud, &code, error);
    if (status)
        return status;
    port->file = open(name, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (port->file < 0)
        return cannot(name, error);
    if (!isatty(port->file))
        status = fp3_fail(error, FP3_E_SYSTEM, "port %s: not a serial port", name);
    else if (flock(port->file, LOCK_EX | LOCK_NB))
        status = cannot(name, error);
    else
        status = set_up(port, code, baud);
    if (status)
        fp3_port_close(port);
    return status;
}

void fp3_port_close(fp3_port *port) {
    if (port->file >= 0)
        close(port->file);
    port->file = -1;
}

int64_t fp3_port_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static fp3_status gone(const fp3_port *port) {
    return fp3_fail(
        port->error, FP3_E_SYSTEM,
        "port %s: the other side has gone: the board was unplugged, or the simulated one "
        "has ended",
        port->name);
}

/* *is_ready: for the events, before the time is over. */
static fp3_status await(fp3_port *port, short events, int64_t until, int *is_ready) {
    struct pollfd p = {.fd = port->file, .events = events};
    int ready;
    do {
        const int64_t left = until - fp3_port_now();
        ready = poll(&p, 1, left > 0 ? (int)left : 0);
    } while (ready < 0 && errno == EINTR);
    if (ready < 0)
        return cannot(port->name, port->error);
    *is_ready = ready && (p.revents & events);
    return ready && !*is_ready ? gone(port) : FP3_OK;
}

fp3_status fp3_port_write(fp3_port *port, const uint8_t *bytes, size_t size, int64_t until) {
    for (int is_ready = 1; size && is_ready;) {
        fp3_status status = await(port, POLLOUT, until, &is_ready);
        if (status || !is_ready)
            return status;
        const ssize_t sent = write(port->file, bytes, size);
        if (sent < 0 && errno != EINTR && errno != EAGAIN)
            return errno == EIO || errno == ENXIO ? gone(port) : cannot(port->name, port->error);
        bytes += sent > 0 ? sent : 0;
        size -= sent > 0 ? (size_t)sent : 0;
    }
    return FP3_OK;
}

fp3_status fp3_port_read(fp3_port *port, uint8_t *bytes, size_t room, int64_t until, size_t *size) {
    int is_ready = 0;
    *size = 0;
    fp3_status status = await(port, POLLIN, until, &is_ready);
    if (status || !is_ready)
        return status;
    const ssize_t got = read(port->file, bytes, room);
    if (got == 0 || (got < 0 && (errno == EIO || errno == ENXIO)))
        return gone(port);
    if (got < 0 && errno != EINTR && errno != EAGAIN)
        return cannot(port->name, port->error);
    *size = got > 0 ? (size_t)got : 0;
    return FP3_OK;
}
