// SPDX-License-Identifier: Apache-2.0
// fp_bench_shim: the Verilated tests/fp/fp_bench.v behind the C interface of fp_bench.h.
#include "fp_bench.h"

#include <cstdint>
#include <new>

#include "Vfp_bench.h"
#include <verilated.h>

struct fp3_bench {
    VerilatedContext context;
    Vfp_bench hardware{&context, "fp_bench"};
};

static unsigned unit_of(unsigned row, fp3_bench_op op) {
    return 3 * row + (op >= FP3_BENCH_MADD ? 2 : op == FP3_BENCH_MUL);
}

fp3_bench *fp3_bench_open(void) {
    fp3_bench *bench = new (std::nothrow) fp3_bench;
    if (bench)
        bench->hardware.eval();
    return bench;
}

void fp3_bench_close(fp3_bench *bench) {
    if (bench)
        bench->hardware.final();
    delete bench;
}

unsigned fp3_bench_rows(const fp3_bench *bench) {
    return sizeof bench->hardware.info_o / sizeof(uint32_t) / 3;
}

fp3_bench_core fp3_bench_describe(const fp3_bench *bench, unsigned row, fp3_bench_op op) {
    const uint32_t info = bench->hardware.info_o[unit_of(row, op)];
    fp3_bench_core core;
    core.exp = info >> 24 & 63;
    core.frac = info >> 18 & 63;
    core.subnormal = info >> 17 & 1;
    core.nearest = info >> 16 & 1;
    core.finite = info >> 15 & 1;
    core.cuts = info & 0x7fff;
    core.latency = static_cast<unsigned>(__builtin_popcount(core.cuts));
    return core;
}

void fp3_bench_run(fp3_bench *bench, unsigned row, fp3_bench_op op, size_t n, const uint32_t *a,
                   const uint32_t *b, const uint32_t *c, uint32_t *z, uint8_t *flags) {
    Vfp_bench &hardware = bench->hardware;
    const unsigned unit = unit_of(row, op);
    const size_t latency = fp3_bench_describe(bench, row, op).latency + 1; // the result register

    hardware.sub_i = op == FP3_BENCH_SUB || op == FP3_BENCH_MSUB;
    for (size_t i = 0; i < n + latency; i++) {
        if (i < n) {
            hardware.a_i = a[i];
            hardware.b_i = b[i];
            if (c)
                hardware.c_i = c[i];
        }
        hardware.clk_i = 0;
        hardware.eval();
        hardware.clk_i = uint64_t{1} << unit;
        hardware.eval();
        if (i >= latency) {
            z[i - latency] = hardware.z_o[unit];
            flags[i - latency] = static_cast<uint8_t>(hardware.flags_o[unit]);
        }
    }
}
