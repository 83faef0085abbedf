/* SPDX-License-Identifier: Apache-2.0 */
/* window.c - see window.h. */
#include "window.h"

#include "together.h"

#include <stdlib.h>

#define LEAST 4096

static int is_free(const fp3_window *window, uint64_t bytes) {
    return !window->is_used && window->bytes >= bytes;
}

/* Every rank finds the same one: sizes are the same, and so is the order of calls. */
fp3_window *fp3_mpi_window_take(fp3_mpi *world, uint64_t bytes) {
    const uint64_t most = fp3_mpi_most(world, bytes);
    fp3_window *window = world->windows;
    while (window && !is_free(window, most))
        window = window->next;
    if (!window) {
        window = calloc(1, sizeof *window);
        if (fp3_mpi_most(world, !window)) {
            free(window);
            return NULL;
        }
        for (window->bytes = LEAST; window->bytes < most;)
            window->bytes *= 2;
        MPI_Win_allocate_shared((MPI_Aint)window->bytes, 1, MPI_INFO_NULL, world->node,
                                &window->base, &window->win);
        MPI_Win_lock_all(MPI_MODE_NOCHECK, window->win);
        window->next = world->windows;
        world->windows = window;
    }
    window->is_used = 1;
    return window;
}

char *fp3_mpi_window_of(const fp3_mpi *world, const fp3_window *window, int rank) {
    MPI_Aint bytes;
    int unit;
    char *base;
    MPI_Win_shared_query(window->win, world->node_rank[rank], &bytes, &unit, &base);
    return base;
}

void fp3_mpi_windows_free(fp3_mpi *world) {
    for (fp3_window *window = world->windows, *next; window; window = next) {
        next = window->next;
        MPI_Win_unlock_all(window->win);
        MPI_Win_free(&window->win);
        free(window);
    }
    world->windows = NULL;
}
