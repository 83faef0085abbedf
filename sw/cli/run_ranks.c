/* run_ranks.c - see run_ranks.h. */
#include "run_ranks.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* How many processes mpirun says it has started; MPI itself is slow to ask. */
static long count_started(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (getenv(names[i]))
            return strtol(getenv(names[i]), NULL, 10);
    return 1;
}

static void be_silent(fp3_run_ranks *ranks) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    ranks->speaks = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (nowhere < 0)
        return;
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
}

fp3_status fp3_run_ranks_begin(fp3_run_ranks *ranks, fp3_error *error) {
    *ranks = (fp3_run_ranks){.is_one = 1, .speaks = -1};
    if (count_started() < 2)
        return FP3_OK;
    const fp3_status status = fp3_ranks_open(&ranks->all, error);
    if (status)
        return status;
    ranks->is_one = 0;
    ranks->all.exchanged = &ranks->exchanged;
    if (ranks->all.rank)
        be_silent(ranks);
    return FP3_OK;
}

/* Bytes of all ranks together, and the mean of the times that they took. */
static void print_exchanged(const fp3_run_ranks *ranks) {
    uint64_t sums[] = {ranks->exchanged.bytes, ranks->exchanged.nanoseconds,
                       ranks->exchanged.steps};
    const uint64_t times = ranks->all.calls->most(ranks->all.world, ranks->exchanged.times);
    ranks->all.calls->add(ranks->all.world, sums, 3);
    if (times)
        printf("%-16s %.3g s of %.3g s, %" PRIu64 " times, %" PRIu64 " bytes; %u ranks\n",
               "exchange", (double)sums[1] / 1e9 / ranks->all.count,
               (double)sums[2] / 1e9 / ranks->all.count, times, sums[0], ranks->all.count);
}

int fp3_run_ranks_end(fp3_run_ranks *ranks, fp3_status status, const fp3_error *error) {
    if (!ranks->is_one && !status)
        print_exchanged(ranks);
    fflush(stdout);
    if (ranks->is_one || ranks->all.calls->close(ranks->all.world, status != FP3_OK) == 0)
        return ranks->all.rank != 0;
    if (ranks->all.rank)
        dprintf(ranks->speaks < 0 ? STDERR_FILENO : ranks->speaks, "fp3 run: rank %u: %s\n",
                ranks->all.rank, error->text);
    ranks->all.calls->abort(ranks->all.world, fp3_exit_code(status));
    return 1;
}
