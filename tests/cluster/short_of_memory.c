/* SPDX-License-Identifier: Apache-2.0 */
/* short_of_memory.c - one rank of a world of bodies runs out of memory, at its first allocation, at
 * its second, and so on: before it gives up it has told the others, who else would wait for it.
 *
 *     short_of_memory
 *
 * MPI is a stand-in with one rank. It notes what it was told last, and for what it was asked.
 */
#include "bodies/share.h"

#include <fp3/bodies.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__
int main(void) { /* a sanitizer has an allocator of its own */
    printf("0 failed\n");
    return 0;
}
#else

/* ---- the allocator ---- */

extern void *__libc_malloc(size_t size), *__libc_calloc(size_t count, size_t size);
extern void *__libc_memalign(size_t to, size_t size);

static long left = -1; /* allocations before the one that fails; below 0: none does */
static int is_out(void) { return left >= 0 && left-- == 0; }

void *malloc(size_t size) { return is_out() ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return is_out() ? NULL : __libc_calloc(count, size); }
void *aligned_alloc(size_t to, size_t size) { return is_out() ? NULL : __libc_memalign(to, size); }

/* ---- the other ranks ---- */

static uint64_t told;         /* last, by this rank */
static long until_fails = -1; /* questions before the one in which another rank says so */

static uint64_t most(fp3_mpi *world, uint64_t own) {
    (void)world;
    told = own;
    return until_fails >= 0 && until_fails-- == 0 ? FP3_E_SYSTEM : own;
}

static void gather(fp3_mpi *world, const void *own, const uint64_t *bytes, void *all) {
    (void)world;
    told = 0;
    memcpy(all, own, bytes[0]);
}

/* ---- worlds ---- */

static fp3_error error;

/* Boxes that fall on the ground and fall asleep; two of them are joined. */
static fp3_bodies *open_world(uint32_t dimensions) {
    fp3_bodies_def def = fp3_bodies_default();
    fp3_bodies *world = NULL;
    uint64_t handle[21], joint;
    def.error = &error;
    def.dimensions = dimensions;
    def.rest_time = 0.05;
    def.rest_speed = 100;
    fp3_status status = fp3_bodies_open(&def, &world);
    for (int i = 0; !status && i < 21; i++) {
        fp3_body_def body = fp3_body_default();
        fp3_shape_def shape = dimensions == 3 ? fp3_shape_box3(i ? 0.5 : 50, 0.5, i ? 0.5 : 50, 0)
                                              : fp3_shape_box(i ? 0.5 : 50, 0.5, 0);
        shape.restitution = 0.5;
        body.type = i ? FP3_DYNAMIC : FP3_STATIC;
        body.x[0] = i ? 1.5 * i : 0;
        body.x[1] = i ? 1.02 : 0;
        body.v[1] = i ? -4 : 0;
        status = fp3_bodies_add(world, &body, 1, &handle[i]);
        if (!status)
            status = fp3_bodies_attach(world, &handle[i], 1, &shape, NULL);
    }
    fp3_joint_def join = fp3_joint_default(FP3_WELD, handle[1], handle[2]);
    if (status || fp3_bodies_join(world, &join, 1, &joint))
        exit(2);
    return world;
}

static fp3_status share_and_step(fp3_bodies *world) {
    static const fp3_mpi_ops calls = {.most = most, .gather = gather};
    const fp3_ranks ranks = {.calls = &calls, .count = 1};
    const fp3_status status = fp3_share_begin(world, &ranks, 6);
    return status ? status : fp3_bodies_step(world, 6);
}

/* 1: a rank gave up and others wait, or it went on after another one has given up. */
static int check(uint32_t dimensions, long at, long asked) {
    fp3_bodies *world = open_world(dimensions);
    told = 0;
    left = at;
    until_fails = asked;
    const fp3_status status = share_and_step(world);
    const int has_failed = (at >= 0 && left < 0) || (asked >= 0 && until_fails < 0);
    left = until_fails = -1;
    fp3_bodies_close(&world);
    if (!has_failed)
        return -1;
    if (asked >= 0 ? status != FP3_OK : status == FP3_E_SYSTEM && told == FP3_E_SYSTEM)
        return 0;
    printf("%u dimensions, allocation %ld, question %ld: status %d, told %d: %s\n", dimensions, at,
           asked, (int)status, (int)told, error.text);
    return 1;
}

int main(void) {
    int failed = 0;
    for (uint32_t dimensions = 2; dimensions <= 3; dimensions++) {
        long at = 0, asked = 0;
        int result;
        for (; (result = check(dimensions, at, -1)) >= 0; at++)
            failed += result;
        for (; (result = check(dimensions, -1, asked)) >= 0; asked++)
            failed += result;
        failed += at < 20 || asked < 12;
    }
    printf("%d failed\n", failed);
    return failed != 0;
}
#endif
