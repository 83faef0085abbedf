/* wire.c - a wire between two network namespaces that delays each packet: for kernels without
 * netem.
 *
 *   wire NAMESPACE NAMESPACE MICROSECONDS
 *
 * Makes a device `wire` in each of the two, says "ready", and carries packets until it is ended.
 * Needs root and /dev/net/tun. */
#include <errno.h>
#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#define PACKET 65536
#define QUEUE 4096 /* packets on the way; a sender waits when they are all in use */
#define SECOND UINT64_C(1000000000)

typedef struct {
    uint64_t due;
    size_t bytes;
    char *text;
} packet;

/* One direction. Packets leave in the order in which they came. */
typedef struct {
    int from, to;
    packet packets[QUEUE];
    unsigned first, count;
} line;

static void fail(const char *what) {
    fprintf(stderr, "wire: %s: %s\n", what, strerror(errno));
    exit(1);
}

static int open_end(const char *namespace) {
    char path[256];
    snprintf(path, sizeof path, "/run/netns/%s", namespace);
    const int room = open(path, O_RDONLY | O_CLOEXEC);
    if (room < 0 || setns(room, CLONE_NEWNET))
        fail(path);
    close(room);
    const int end = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
    struct ifreq request = {.ifr_flags = IFF_TUN | IFF_NO_PI};
    strcpy(request.ifr_name, "wire");
    if (end < 0 || ioctl(end, TUNSETIFF, &request))
        fail("/dev/net/tun");
    return end;
}

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * SECOND + (uint64_t)t.tv_nsec;
}

/* Whether there was a packet. */
static int take(line *l, uint64_t delay) {
    packet *p = &l->packets[(l->first + l->count) % QUEUE];
    if (l->count == QUEUE)
        return 0;
    if (!p->text && !(p->text = malloc(PACKET)))
        fail("memory");
    const ssize_t got = read(l->from, p->text, PACKET);
    if (got <= 0)
        return 0;
    p->bytes = (size_t)got;
    p->due = now() + delay;
    l->count++;
    return 1;
}

/* What is due; a device that takes no packet loses it, as a network would. */
static void give(line *l) {
    while (l->count && l->packets[l->first].due <= now()) {
        const packet *p = &l->packets[l->first];
        if (write(l->to, p->text, p->bytes) < 0 && errno != EAGAIN && errno != EIO)
            fail("write");
        l->first = (l->first + 1) % QUEUE;
        l->count--;
    }
}

static uint64_t next_due(const line *a, const line *b) {
    uint64_t due = UINT64_MAX;
    due = a->count ? a->packets[a->first].due : due;
    return b->count && b->packets[b->first].due < due ? b->packets[b->first].due : due;
}

int main(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: wire NAMESPACE NAMESPACE MICROSECONDS\n");
        return 2;
    }
    const uint64_t delay = strtoull(argv[3], NULL, 10) * 1000;
    static line lines[2];
    lines[0].from = lines[1].to = open_end(argv[1]);
    lines[1].from = lines[0].to = open_end(argv[2]);
    const struct sched_param first = {.sched_priority = 10};
    if (sched_setscheduler(0, SCHED_FIFO, &first))
        fail("sched_setscheduler");
    prctl(PR_SET_TIMERSLACK, 1UL);
    puts("ready");
    fflush(stdout);
    for (;;) {
        struct pollfd ends[] = {{lines[0].from, POLLIN, 0}, {lines[1].from, POLLIN, 0}};
        const uint64_t due = next_due(&lines[0], &lines[1]), at = now();
        const uint64_t left = due <= at ? 0 : due - at;
        const struct timespec wait = {(time_t)(left / SECOND), (long)(left % SECOND)};
        if (ppoll(ends, 2, due == UINT64_MAX ? NULL : &wait, NULL) < 0 && errno != EINTR)
            fail("ppoll");
        for (int i = 0; i < 2; i++) {
            while (take(&lines[i], delay))
                ;
            give(&lines[i]);
        }
    }
}
