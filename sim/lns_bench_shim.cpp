// SPDX-License-Identifier: Apache-2.0
// lns_bench_shim: the Verilated tests/lns/lns_bench.v behind the C interface of lns_bench.h.
#include "lns_bench.h"

#include <new>

#include "Vlns_bench.h"
#include <verilated.h>

struct fp3_lns_bench {
    VerilatedContext context;
    Vlns_bench hardware{&context, "lns_bench"};
};

fp3_lns_bench *fp3_lns_bench_open(void) {
    fp3_lns_bench *bench = new (std::nothrow) fp3_lns_bench;
    if (bench)
        bench->hardware.eval();
    return bench;
}

void fp3_lns_bench_close(fp3_lns_bench *bench) {
    if (bench)
        bench->hardware.final();
    delete bench;
}

void fp3_lns_bench_run(fp3_lns_bench *bench, fp3_lns_op op, size_t n, const uint32_t *a,
                       const uint32_t *b, uint32_t *z, uint8_t *flags) {
    static const size_t latencies[] = {9, 1, 0, 6, 5, 13};
    Vlns_bench &hardware = bench->hardware;
    const unsigned unit = op / 2;
    const size_t latency = latencies[unit];

    // Operands change while the clock is low. A function answers at once, the others some edges
    // later.
    hardware.other_i = op % 2;
    for (size_t i = 0; i < n + latency; i++) {
        hardware.a_i = i < n ? a[i] : 0;
        hardware.b_i = i < n ? b[i] : 0;
        hardware.clk_i = 0;
        hardware.eval();
        if (i >= latency) {
            z[i - latency] = hardware.z_o[unit];
            flags[i - latency] = static_cast<uint8_t>(hardware.flags_o >> 5 * unit & 31);
        }
        hardware.clk_i = static_cast<uint8_t>(1 << unit);
        hardware.eval();
    }
}
