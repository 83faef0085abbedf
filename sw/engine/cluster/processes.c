/* SPDX-License-Identifier: Apache-2.0 */
/* processes.c - see processes.h. */
#include "processes.h"

#include "engine/common/library.h"

#include <stddef.h>

fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error) {
    void *library = NULL;
    *ranks = (fp3_ranks){0};
    const fp3_status status =
        fp3_library_load("fp3_mpi.so", "library for clusters", &library, NULL, error);
    if (status)
        return status;
    ranks->calls = fp3_library_symbol(library, "fp3_mpi_calls");
    if (!ranks->calls || ranks->calls->version != FP3_MPI_VERSION ||
        ranks->calls->size != sizeof *ranks->calls)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "fp3_mpi.so is of another version: both must come from one build");
    ranks->world = ranks->calls->open();
    if (!ranks->world)
        return fp3_fail(error, FP3_E_SYSTEM, "MPI does not start");
    ranks->rank = ranks->calls->rank(ranks->world);
    ranks->count = ranks->calls->ranks(ranks->world);
    return FP3_OK;
}
