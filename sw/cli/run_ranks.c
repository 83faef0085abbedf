/* SPDX-License-Identifier: Apache-2.0 */
/* run_ranks.c - see run_ranks.h. */
#include "run_ranks.h"

#include "arguments.h"
#include "engine/cluster/use.h"

#include <assert.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

static long number_in(const char *const *names, size_t count, long otherwise) {
    for (size_t i = 0; i < count; i++)
        if (getenv(names[i]))
            return strtol(getenv(names[i]), NULL, 10);
    return otherwise;
}

/* What mpirun, or Slurm's srun, says; MPI itself is slow to ask. */
static long count_started(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"};
    return number_in(names, sizeof names / sizeof *names, 1);
}

static long rank_said(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"};
    return number_in(names, sizeof names / sizeof *names, 0);
}

/* An on_exit function of a silent rank. A launcher kills all ranks when the first one ends with an
 * error. Where this rank has found the error before MPI has begun, in its arguments, rank 0 finds
 * it too, and must have the time to say so: rank 0 ends this wait, by its own end. */
static void wait_for_rank_0(int exit_code, void *unused) {
    const struct timespec second = {1, 0};
    (void)unused;
    if (exit_code)
        nanosleep(&second, NULL);
}

static void be_silent(fp3_run_ranks *ranks) {
    on_exit(wait_for_rank_0, NULL);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    ranks->speaks = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (nowhere < 0)
        return;
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
}

/* Without its mpirun a rank would go on until MPI notices, a second or so, and replace checkpoints
 * that a restarted run reads. Only the kernel can tell it at once; Linux can. To Linux the parent
 * is the thread that started this process: a launcher whose threads end before it does must start
 * ranks from one that stays, as mpirun and srun do. */
static void end_with_parent(void) {
    const pid_t parent = getppid();
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent)
        raise(SIGTERM);
}

void fp3_run_ranks_first(fp3_run_ranks *ranks) {
    *ranks = (fp3_run_ranks){.is_one = 1, .speaks = -1};
    if (count_started() > 1)
        end_with_parent();
    if (count_started() > 1 && rank_said() > 0)
        be_silent(ranks);
}

fp3_status fp3_run_ranks_begin(fp3_run_ranks *ranks, fp3_error *error) {
    const long started = count_started();
    if (started < 2)
        return FP3_OK;
    const fp3_status status = fp3_ranks_open(&ranks->all, error);
    if (status)
        return status;
    if (ranks->all.count != started) /* each would run all objects, and write the same files */
        return fp3_fail(error, FP3_E_SYSTEM,
                        "%ld processes were started, and MPI sees %u: fp3_mpi.so is compiled with "
                        "another MPI than the one that starts the processes",
                        started, ranks->all.count);
    ranks->is_one = 0;
    if (ranks->all.rank && ranks->speaks < 0)
        be_silent(ranks);
    return FP3_OK;
}

/* ---- whether ranks have the same options ---- */

enum { OPTIONS_MOST = 64 };

typedef struct {
    const fp3_option *table;
    const char *const *own;
    uint64_t values[OPTIONS_MOST]; /* of each option a hash */
} given;

/* An fp3_argument_fn. */
static fp3_status note(void *user, const fp3_option *option, const char *value, fp3_error *error) {
    given *g = user;
    (void)error;
    for (const char *const *own = g->own; option && *own; own++)
        if (!strcmp(*own, option->name))
            return FP3_OK;
    if (!option)
        return FP3_OK;
    uint64_t *hash = &g->values[option - g->table];
    *hash = (*hash ^ 0x100) * 0x100000001b3u; /* FNV-1a; where a value begins */
    for (; value && *value; value++)
        *hash = (*hash ^ (unsigned char)*value) * 0x100000001b3u;
    return FP3_OK;
}

static fp3_status compare(const fp3_option *table, const uint64_t *all, unsigned ranks,
                          fp3_error *error) {
    for (unsigned r = 1; r < ranks; r++)
        for (int i = 0; table[i].name; i++)
            if (all[(size_t)r * OPTIONS_MOST + (size_t)i] != all[i])
                return fp3_fail(
                    error, FP3_E_ARGUMENT,
                    "--%s: rank %u and rank 0 do not have the same value of this option",
                    table[i].name, r);
    return FP3_OK;
}

fp3_status fp3_run_ranks_agree(const fp3_run_ranks *ranks, const fp3_option *table, int argc,
                               char *const *argv, const char *const *own, fp3_error *error) {
    given g = {.table = table, .own = own};
    const unsigned count = ranks->all.count;
    int options = 0;
    while (table[options].name)
        options++;
    assert(options <= OPTIONS_MOST);
    if (ranks->is_one)
        return FP3_OK;
    uint64_t *bytes = calloc(count, sizeof *bytes);
    uint64_t *all = calloc(count, sizeof g.values);
    fp3_status status = bytes && all ? fp3_arguments_each(table, argc, argv, note, &g, error)
                                     : fp3_no_memory(error);
    for (unsigned r = 0; !status && r < count; r++)
        bytes[r] = sizeof g.values;
    if (!status) {
        ranks->all.calls->gather(ranks->all.world, g.values, bytes, all);
        status = compare(table, all, count, error);
    }
    free(bytes);
    free(all);
    return status;
}

static fp3_status check_ports(const char *text, unsigned ranks, fp3_error *error) {
    unsigned ports = 1;
    for (const char *c = text; *c; c++)
        ports += *c == ',';
    if (ports != ranks && ranks == 1)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--port: found %u ports, expected one: each process has a board, and there "
                        "is one process (mpirun -n %u starts one for each port)",
                        ports, ports);
    if (ports != ranks)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--port: found %u port%s, expected %u, with commas between them: one "
                        "for each rank",
                        ports, ports == 1 ? "" : "s", ranks);
    if (*text == ',' || strstr(text, ",,") || text[strlen(text) - 1] == ',')
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--port: found '%s', expected a name before and "
                        "behind each comma",
                        text);
    return FP3_OK;
}

fp3_status fp3_run_ranks_port(fp3_run_ranks *ranks, fp3_run_engine *on, fp3_error *error) {
    const char *text = on->port;
    if (!text || !*text)
        return FP3_OK;
    const fp3_status status = check_ports(text, ranks->is_one ? 1 : ranks->all.count, error);
    if (status)
        return status;
    for (unsigned r = 0; r < ranks->all.rank; r++)
        text = strchr(text, ',') + 1;
    ranks->port = strndup(text, strcspn(text, ","));
    on->port = ranks->port;
    return ranks->port ? FP3_OK : fp3_no_memory(error);
}

/* Bytes of all ranks together, and the means of their times. */
static void print_exchange(const fp3_rank_use *all, unsigned count) {
    fp3_rank_use sum = {0};
    for (unsigned r = 0; r < count; r++) {
        sum.sent += all[r].sent;
        sum.exchange += all[r].exchange;
        sum.steps += all[r].steps;
        sum.times = all[r].times > sum.times ? all[r].times : sum.times;
    }
    if (sum.times)
        printf("%-16s %.3g s of %.3g s, %" PRIu64 " times, %" PRIu64 " bytes; %u ranks\n",
               "exchange", (double)sum.exchange / 1e9 / count, (double)sum.steps / 1e9 / count,
               sum.times, sum.sent, count);
}

void fp3_run_ranks_print(fp3_engine *engine) {
    fp3_rank_use *all = NULL;
    unsigned count = 0;
    if (fp3_ranks_use(engine, &all, &count))
        return;
    for (unsigned r = 0; r < count; r++) {
        printf("rank %-11u %" PRIu64 " objects, %" PRIu64 " guests; ", r, all[r].objects,
               all[r].guests);
        if (all[r].cycles)
            printf("%" PRIu64 " cycles; ", all[r].cycles);
        printf("%" PRIu64 " bytes to other ranks", all[r].sent);
        if (all[r].bus.transfers)
            printf("; %" PRIu64 " words on the bus", all[r].bus.transfers);
        if (all[r].bus.requests)
            printf(", %" PRIu64 " requests, %" PRIu64 " bytes on the line", all[r].bus.requests,
                   all[r].bus.bytes);
        putchar('\n');
    }
    print_exchange(all, count);
    free(all);
}

int fp3_run_ranks_end(fp3_run_ranks *ranks, const char *command, fp3_status status,
                      const fp3_error *error) {
    free(ranks->port);
    ranks->port = NULL;
    fflush(stdout);
    if (ranks->is_one || ranks->all.calls->close(ranks->all.world, status != FP3_OK) == 0)
        return ranks->all.rank != 0;
    if (ranks->all.rank)
        dprintf(ranks->speaks < 0 ? STDERR_FILENO : ranks->speaks, "fp3 %s: rank %u: %s\n", command,
                ranks->all.rank, error->text);
    ranks->all.calls->abort(ranks->all.world, fp3_exit_code(status));
    return 1;
}
