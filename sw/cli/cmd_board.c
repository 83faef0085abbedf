/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_board.c - fp3 board: a simulated board, whose serial line is a pseudo-terminal. */
#include "arguments.h"
#include "board_rtl.h"
#include "cli.h"
#include "engine/common/library.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define CYCLES 256                   /* from one look at the terminal to the next */
#define ROOM (2 * (CYCLES / 32 + 1)) /* of bytes in that time; noise may double one */
#define ONE_IN 500                   /* bytes that noise damages */

typedef struct {
    const char *config;
    uint64_t noise; /* 0: there is none */
} options;

typedef struct {
    const fp3_board_ops *ops;
    fp3_board *board;
    int terminal;
    uint64_t noise;
    uint8_t in[ROOM], out[ROOM];
    size_t waiting, left; /* bytes in `in` for the board, in `out` for the terminal */
} simulation;

static void take_word(void *user, struct argp_state *state, char *text) {
    (void)user;
    argp_error(state, "found '%s', expected options alone", text);
}

static const fp3_option table[] = {
    {"config", 'c', "NAME", "Configuration (default: single)", FP3_TEXT(options, config)},
    {"noise", 'x', "SEED",
     "Damage one byte of 500 on the line, at random from SEED: changed, lost or doubled",
     FP3_NUMBER(options, noise, 1, UINT64_MAX)},
    {0},
};

static uint32_t chance(simulation *s, uint32_t below) {
    s->noise = s->noise * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((s->noise >> 33) % below);
}

/* Returns how many bytes became of count; bytes has room for twice as many. */
static size_t damage(simulation *s, uint8_t *bytes, size_t count) {
    for (size_t i = 0; s->noise && i < count; i++) {
        const uint32_t kind = chance(s, ONE_IN) ? 3 : chance(s, 3);
        if (kind == 0)
            bytes[i] ^= (uint8_t)(1u << chance(s, 8));
        else if (kind == 1)
            memmove(bytes + i, bytes + i + 1, --count - i);
        else if (kind == 2) {
            memmove(bytes + i + 1, bytes + i, count++ - i);
            i++;
        }
    }
    return count;
}

/* What the host sent, if there is room and a host. */
static fp3_status listen(simulation *s, int *is_there, fp3_error *error) {
    struct pollfd p = {.fd = s->terminal, .events = POLLIN};
    if (poll(&p, 1, 0) < 0 && errno != EINTR)
        return fp3_fail(error, FP3_E_SYSTEM, "pseudo-terminal: %s", strerror(errno));
    *is_there = !(p.revents & POLLHUP);
    if (!(p.revents & POLLIN) || s->waiting)
        return FP3_OK;
    const ssize_t got = read(s->terminal, s->in, sizeof s->in / 2);
    s->waiting = got > 0 ? damage(s, s->in, (size_t)got) : 0;
    return FP3_OK;
}

/* What the terminal has no room for waits; a real line would lose it. */
static void say(simulation *s) {
    const ssize_t sent = s->left ? write(s->terminal, s->out, s->left) : 0;
    if (sent > 0)
        memmove(s->out, s->out + sent, s->left -= (size_t)sent);
}

/* A board without a host is not simulated, since its work could not be seen. */
static fp3_status simulate(simulation *s, fp3_error *error) {
    fp3_status status = FP3_OK;
    while (!status) {
        int is_there = 0;
        status = listen(s, &is_there, error);
        if (!is_there && !s->waiting) {
            s->left = 0;
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
            continue;
        }
        say(s);
        if (s->left)
            continue;
        size_t taken = 0;
        s->left = s->ops->clock(s->board, CYCLES, s->in, s->waiting, &taken, s->out);
        s->left = damage(s, s->out, s->left);
        memmove(s->in, s->in + taken, s->waiting -= taken);
    }
    return status;
}

/* Raw from the start: what is sent must not come back as an echo. */
static fp3_status open_terminal(int *terminal, fp3_error *error) {
    struct termios t;
    *terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    const char *name =
        *terminal >= 0 && !grantpt(*terminal) && !unlockpt(*terminal) ? ptsname(*terminal) : NULL;
    const int line = name ? open(name, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
    int failed = line < 0 || tcgetattr(line, &t);
    if (!failed) {
        cfmakeraw(&t);
        failed = tcsetattr(line, TCSANOW, &t) || fcntl(*terminal, F_SETFL, O_NONBLOCK);
    }
    if (failed)
        fp3_fail(error, FP3_E_SYSTEM, "pseudo-terminal: %s", strerror(errno));
    if (line >= 0)
        close(line); /* from now on it is open while a host is there */
    if (!failed)
        printf("%s\n", name);
    fflush(stdout);
    return failed ? FP3_E_SYSTEM : FP3_OK;
}

static fp3_status load(const char *config, void **library, const fp3_board_ops **ops,
                       fp3_error *error) {
    char name[128], *path = NULL;
    snprintf(name, sizeof name, "fp3_board_%s.so", config);
    fp3_status status =
        fp3_library_load(name, "simulated board of this configuration", library, &path, error);
    *ops = status ? NULL : fp3_library_symbol(*library, "fp3_board_table");
    if (!status && (!*ops || (*ops)->version != FP3_BOARD_VERSION || (*ops)->size != sizeof **ops))
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: not a board of this version", path);
    free(path);
    return status;
}

int fp3_cmd_board(int argc, char **argv) {
    static const fp3_command command = {.options = table,
                                        .take = take_word,
                                        .doc =
                                            "Simulates a board, rtl/board/fp3_board_top.v with a "
                                            "configuration, under Verilator. Prints the name of a "
                                            "pseudo-terminal that is its serial port, for fp3 run "
                                            "--engine board --port, at any rate, and "
                                            "runs until it is killed."};
    options o = {.config = "single"};
    simulation s = {.terminal = -1};
    void *library = NULL;
    fp3_error error = {.text = ""};
    fp3_arguments_parse(&command, argc, argv, &o);
    s.noise = o.noise;
    fp3_status status = load(o.config, &library, &s.ops, &error);
    if (!status && !(s.board = s.ops->open()))
        status = fp3_no_memory(&error);
    if (!status)
        status = open_terminal(&s.terminal, &error);
    if (!status)
        status = simulate(&s, &error);
    if (s.board)
        s.ops->close(s.board);
    if (s.terminal >= 0)
        close(s.terminal);
    fp3_library_unload(library);
    return fp3_cli_fail("board", status, &error);
}
