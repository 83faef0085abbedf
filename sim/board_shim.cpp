// SPDX-License-Identifier: Apache-2.0
/* board_shim.cpp - clocks one Verilated board, and is the other end of its serial line; compile
 * with -DFP3_DIVISOR=<clock cycles in a bit of the line>.
 */
#include "board_rtl.h"

#include <Vfp3_board_top.h>
#include <memory>
#include <new>
#include <verilated.h>

namespace {

const unsigned RESET_CYCLES = 8; /* more than the board takes to light its light */
const unsigned BITS = 10;        /* of a byte on the line: start, eight, stop */

/* One direction of the line: a bit is level for FP3_DIVISOR cycles. */
struct sender {
    unsigned bits = 0, count = 0, cycle = 0; /* still to send: the next one in the lowest place */
    bool is_free() const { return count == 0; }
    void begin(uint8_t byte) {
        bits = 1u << 9 | static_cast<unsigned>(byte) << 1;
        count = BITS;
        cycle = 0;
    }
    unsigned level() const { return count ? bits & 1 : 1; }
    void tick() {
        if (!count || ++cycle < FP3_DIVISOR)
            return;
        cycle = 0;
        bits >>= 1;
        count--;
    }
};

/* Looks at each bit in its middle. */
struct receiver {
    unsigned bits = 0, count = 0, wait = 0;
    bool take(unsigned level, uint8_t *byte) {
        if (!count) {
            if (level)
                return false;
            count = BITS;
            wait = FP3_DIVISOR / 2;
        }
        if (wait) {
            wait--;
            return false;
        }
        bits = bits >> 1 | level << (BITS - 1);
        wait = FP3_DIVISOR - 1;
        *byte = static_cast<uint8_t>(bits >> 1);
        return --count == 0;
    }
};

} // namespace

struct fp3_board {
    std::unique_ptr<VerilatedContext> context;
    std::unique_ptr<Vfp3_board_top> top;
    sender to;
    receiver from;
};

namespace {

void edge(fp3_board *board) {
    board->top->clk_pin = 0;
    board->top->eval();
    board->top->clk_pin = 1;
    board->top->eval();
}

size_t clock_board(fp3_board *board, uint64_t cycles, const uint8_t *in, size_t size, size_t *taken,
                   uint8_t *out) {
    size_t came = 0;
    *taken = 0;
    for (; cycles > 0; cycles--) {
        if (board->to.is_free() && *taken < size)
            board->to.begin(in[(*taken)++]);
        board->top->uart_rxd = board->to.level();
        edge(board);
        board->to.tick();
        came += board->from.take(board->top->uart_txd, &out[came]);
    }
    return came;
}

fp3_board *open_board() try {
    std::unique_ptr<fp3_board> board(new fp3_board());
    board->context.reset(new VerilatedContext);
    board->context->threads(1); /* as in fp3_shim.cpp */
    /* With --x-initial unique, what has no first value in the source starts as noise. */
    board->context->randReset(2);
    board->context->randSeed(1);
    board->top.reset(new Vfp3_board_top{board->context.get()});
    board->top->uart_rxd = 1;
    for (unsigned i = 0; i < RESET_CYCLES; i++)
        edge(board.get());
    return board->top->light ? board.release() : nullptr;
} catch (const std::bad_alloc &) {
    return nullptr;
}

void close_board(fp3_board *board) {
    board->top->final();
    delete board;
}

} // namespace

extern "C" __attribute__((visibility("default"))) const fp3_board_ops fp3_board_table;
extern "C" const fp3_board_ops fp3_board_table = {
    FP3_BOARD_VERSION, sizeof(fp3_board_ops), open_board, close_board, clock_board,
};
