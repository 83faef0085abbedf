/* fp3_shim.cpp - clocks one Verilated configuration; compile with -DFP3_CONFIG=<name>.
 *
 * A cycle: the inputs are set, the low phase settles what depends on them and is where outputs are
 * looked at, the rising edge ends it.
 */
#define PASTE_(a, b) a##b
#define PASTE(a, b) PASTE_(a, b)
#define STRING_(a) #a
#define STRING(a) STRING_(a)
#define MODEL PASTE(Vfp3_, FP3_CONFIG)
#define HEADER STRING_HEADER(MODEL)
#define STRING_HEADER(a) STRING(a.h)
#include HEADER

#include "fp3_rtl.h"

#include <memory>
#include <new>
#include <verilated.h>

struct fp3_rtl {
    std::unique_ptr<VerilatedContext> context;
    std::unique_ptr<MODEL> top;
    fp3_retire_fn *retire;
    void *user;
    uint64_t cycle;
    unsigned transfers;
};

namespace {

const unsigned RESET_CYCLES = 4;
const unsigned ANSWER_CYCLES = 1000;

void settle(fp3_rtl *rtl) {
    rtl->top->clk_i = 0;
    rtl->top->eval();
}

/* Ends the cycle that settle began. Whether something retired in it. */
bool edge(fp3_rtl *rtl) {
    MODEL *top = rtl->top.get();
    const bool retired = top->retire_valid_o && !top->rst_i;
    if (retired && rtl->retire) {
        const fp3_retirement what = {rtl->cycle, top->retire_context_o, top->retire_register_o,
                                     top->retire_value_o, top->retire_flags_o};
        rtl->retire(rtl->user, &what);
    }
    top->clk_i = 1;
    top->eval();
    rtl->cycle++;
    return retired;
}

/* The host holds its request until it is taken, and lets the response wait for 0 to 3 cycles, in
 * which it must stand still. */
int transfer(fp3_rtl *rtl, int is_write, uint32_t address, uint32_t *data) {
    MODEL *top = rtl->top.get();
    top->req_valid_i = 1;
    top->req_write_i = is_write != 0;
    top->req_addr_i = address;
    top->req_wdata_i = is_write ? *data : 0;
    bool taken = false, answered = false;
    for (unsigned i = 0; i < ANSWER_CYCLES && !taken; i++) {
        settle(rtl);
        taken = top->req_ready_o;
        edge(rtl);
    }
    top->req_valid_i = 0;
    top->req_addr_i = ~address;
    top->req_wdata_i = ~*data;
    uint32_t rdata = 0;
    bool error = false;
    unsigned patience = rtl->transfers++ & 3;
    for (unsigned i = 0; i < ANSWER_CYCLES && taken && !top->rsp_ready_i; i++) {
        settle(rtl);
        const bool stood =
            top->rsp_valid_o && top->rsp_rdata_o == rdata && top->rsp_error_o == error;
        if (answered && !stood)
            return -1;
        answered = top->rsp_valid_o;
        rdata = top->rsp_rdata_o;
        error = top->rsp_error_o;
        if (answered && patience-- == 0) {
            top->rsp_ready_i = 1;
            settle(rtl);
        }
        edge(rtl);
    }
    if (!top->rsp_ready_i)
        return -1;
    top->rsp_ready_i = 0;
    if (!is_write)
        *data = rdata;
    return error;
}

uint64_t clock_until_quiet(fp3_rtl *rtl, uint64_t cycles, uint64_t quiet) {
    uint64_t done = 0;
    for (uint64_t still = 0; done < cycles && still < quiet; done++) {
        settle(rtl);
        still = edge(rtl) ? 0 : still + 1;
    }
    return done;
}

fp3_rtl *open_rtl(fp3_retire_fn *retire, void *user) try {
    std::unique_ptr<fp3_rtl> rtl(new fp3_rtl());
    rtl->context.reset(new VerilatedContext);
    /* With --x-initial unique, what has no first value in the source starts as noise. */
    rtl->context->randReset(2);
    rtl->context->randSeed(1);
    rtl->top.reset(new MODEL{rtl->context.get()});
    rtl->retire = retire;
    rtl->user = user;
    rtl->top->req_valid_i = 0;
    rtl->top->rsp_ready_i = 0;
    rtl->top->rst_i = 1;
    clock_until_quiet(rtl.get(), RESET_CYCLES, RESET_CYCLES);
    rtl->top->rst_i = 0;
    return rtl.release();
} catch (const std::bad_alloc &) {
    return nullptr;
}

void close_rtl(fp3_rtl *rtl) {
    rtl->top->final();
    delete rtl;
}

} // namespace

extern "C" const fp3_rtl_ops PASTE(fp3_rtl_, FP3_CONFIG);
extern "C" const fp3_rtl_ops PASTE(fp3_rtl_, FP3_CONFIG) = {STRING(FP3_CONFIG), open_rtl, close_rtl,
                                                            transfer, clock_until_quiet};
