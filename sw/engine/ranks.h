/* ranks.h - an engine whose objects are divided among the processes of a cluster.
 *
 * Every process makes the same calls in the same order, with the same arguments: each has the whole scene in view and an engine of its own for
 * its part of the objects. Reads give every process the words of all. So what stands on an engine runs on a cluster as it is, if it decides
 * nothing by time or by chance.
 */
#ifndef FP3_ENGINE_RANKS_H
#define FP3_ENGINE_RANKS_H

#include <fp3/engine.h>
#include <mpi/fp3_mpi.h>

/* What this rank has exchanged in all runs, and how long that took, with the time that it waited for others. steps: how long all steps took, exchanges
 * among them, but not what the ranks do before the first one. */
typedef struct {
    uint64_t times, bytes; /* bytes: sent */
    uint64_t nanoseconds, steps;
} fp3_exchanged;

typedef struct {
    const fp3_mpi_ops *calls;
    fp3_mpi *world;
    unsigned rank, count;
    fp3_exchanged *exchanged; /* NULL: nobody asks */
} fp3_ranks;

/* Loads fp3_mpi.so and starts MPI. FP3_E_SYSTEM: there is none, or it does not start. */
fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error);

/* fp3_engine_open for objects of all ranks together. FP3_E_ARGUMENT as there, and where the definition asks for what one process alone
 * can have: a trace, a bus log, retirements, a cycle limit, native code. */
fp3_status fp3_engine_open_ranks(const fp3_engine_def *def, const fp3_ranks *ranks,
                                 fp3_engine **engine);

#endif
