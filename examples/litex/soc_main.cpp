// soc_main.cpp - the simulated SoC: soc_main CYCLES. What comes out of its UART is printed until it
// ends its transmission.

#include "Vsoc.h"
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace {
constexpr int end_of_transmission = 4;
}

int main(int argc, char **argv) {
    const uint64_t limit = argc == 2 ? std::strtoull(argv[1], nullptr, 10) : 0;
    const auto soc = std::make_unique<Vsoc>();
    soc->serial_source_ready = 1;
    for (uint64_t cycle = 0; cycle < limit; cycle++) {
        soc->sys_clk = 0;
        soc->eval();
        const bool is_byte = soc->serial_source_valid;
        const int byte = soc->serial_source_data;
        soc->sys_clk = 1;
        soc->eval();
        if (is_byte && byte == end_of_transmission) {
            std::fprintf(stderr, "%" PRIu64 " cycles\n", cycle);
            return 0;
        }
        if (is_byte)
            std::putchar(byte);
    }
    std::fprintf(stderr, "no end within %" PRIu64 " cycles\n", limit);
    return 1;
}
