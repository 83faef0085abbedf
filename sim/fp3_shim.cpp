/* fp3_shim.cpp - clocks one Verilated configuration; compile with -DFP3_CONFIG=<name>.
 *
 * A cycle: the inputs are set, the low phase settles what depends on them and is where outputs are
 * looked at, the rising edge ends it.
 */
#define PASTE_(a, b) a##b
#define PASTE(a, b) PASTE_(a, b)
#define STRING_(a) #a
#define STRING(a) STRING_(a)
#define HARDWARE PASTE(Vfp3_, FP3_CONFIG)
#define HEADER STRING_HEADER(HARDWARE)
#define STRING_HEADER(a) STRING(a.h)
#include HEADER

#include "fp3_rtl.h"

#include "gen/configs.h"
#include <memory>
#include <new>
#include <verilated.h>

struct fp3_rtl {
    std::unique_ptr<VerilatedContext> context;
    std::unique_ptr<HARDWARE> top;
    fp3_rtl_watch watch;
    uint64_t cycle;
    unsigned transfers;
};

namespace {

const unsigned RESET_CYCLES = 4;
const unsigned ANSWER_CYCLES = 1000;

/* How many parts the trace ports have: as many as this build has schedulers, and lanes in each. */
struct shape {
    unsigned schedulers, lanes;
};

constexpr bool same(const char *a, const char *b) {
    return *a == *b && (!*a || same(a + 1, b + 1));
}
constexpr shape find_shape() {
    shape found = {0, 0};
#define X(name, doc, schedulers, lanes)                                                            \
    if (same(#name, STRING(FP3_CONFIG)))                                                           \
        found = {schedulers, lanes};
    FP3_CONFIGS(X)
#undef X
    return found;
}
constexpr shape SHAPE = find_shape();
static_assert(SHAPE.schedulers > 0, "a configuration of isa/configs.toml");

/* Part n, WIDTH bits wide, of a port: an integer up to 64 bits, an array of 32-bit words beyond. */
template <unsigned WIDTH, typename Port> uint32_t part(const Port &port, unsigned n) {
    return static_cast<uint32_t>(static_cast<uint64_t>(port) >> n * WIDTH) &
           static_cast<uint32_t>((uint64_t{1} << WIDTH) - 1);
}
template <unsigned WIDTH, std::size_t WORDS> uint32_t part(const VlWide<WORDS> &port, unsigned n) {
    const unsigned low = n * WIDTH, word = low / 32, shift = low % 32;
    uint64_t bits = port[word];
    if (shift + WIDTH > 32)
        bits |= static_cast<uint64_t>(port[word + 1]) << 32;
    return static_cast<uint32_t>(bits >> shift) & static_cast<uint32_t>((uint64_t{1} << WIDTH) - 1);
}

template <typename Port> bool is_zero(const Port &port) { return port == 0; }
template <std::size_t WORDS> bool is_zero(const VlWide<WORDS> &port) {
    for (std::size_t i = 0; i < WORDS; i++)
        if (port[i])
            return false;
    return true;
}

void settle(fp3_rtl *rtl) {
    rtl->top->clk_i = 0;
    rtl->top->eval();
}

void tell_issues(const fp3_rtl *rtl) {
    const HARDWARE *top = rtl->top.get();
    for (unsigned scheduler = 0; scheduler < SHAPE.schedulers; scheduler++) {
        if (!part<1>(top->issue_valid_o, scheduler))
            continue;
        fp3_rtl_issue what = {};
        what.cycle = rtl->cycle;
        what.scheduler = scheduler;
        what.context = part<16>(top->issue_context_o, scheduler);
        what.pc = part<16>(top->issue_pc_o, scheduler);
        what.word = part<32>(top->issue_word_o, scheduler);
        rtl->watch.issue(rtl->watch.user, &what);
    }
}

void tell_ends(const fp3_rtl *rtl) {
    const HARDWARE *top = rtl->top.get();
    for (unsigned n = 0; n < SHAPE.schedulers * SHAPE.lanes; n++) {
        fp3_rtl_end end = {};
        end.outcome = static_cast<fp3_outcome>(part<2>(top->retire_end_o, n));
        if (!end.outcome)
            continue;
        end.has_result = part<1>(top->retire_valid_o, n);
        fp3_retirement &what = end.result;
        what.cycle = rtl->cycle;
        what.object = part<32>(top->retire_object_o, n);
        what.reg = part<6>(top->retire_register_o, n);
        what.bits = part<32>(top->retire_value_o, n);
        what.flags = part<5>(top->retire_flags_o, n);
        what.context = part<16>(top->retire_context_o, n);
        what.scheduler = n / SHAPE.lanes;
        what.lane = n % SHAPE.lanes;
        rtl->watch.end(rtl->watch.user, &end);
    }
}

/* Ends the cycle that settle began. Whether something issued or retired in it. */
bool edge(fp3_rtl *rtl) {
    HARDWARE *top = rtl->top.get();
    const bool issued = !is_zero(top->issue_valid_o) && !top->rst_i;
    const bool retired = !is_zero(top->retire_valid_o) && !top->rst_i;
    if (issued && rtl->watch.issue)
        tell_issues(rtl);
    if (rtl->watch.end && !is_zero(top->retire_end_o) && !top->rst_i)
        tell_ends(rtl);
    top->clk_i = 1;
    top->eval();
    rtl->cycle++;
    return issued || retired;
}

/* The host holds its request until it is taken, and lets the response wait for 0 to 3 cycles, in
 * which it must stand still. */
int transfer(fp3_rtl *rtl, int is_write, uint32_t address, uint32_t *data) {
    HARDWARE *top = rtl->top.get();
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

void clock_until_quiet(fp3_rtl *rtl, uint64_t cycles, uint64_t quiet) {
    for (uint64_t still = 0; cycles > 0 && still < quiet; cycles--) {
        settle(rtl);
        still = edge(rtl) ? 0 : still + 1;
    }
}

uint64_t cycles_so_far(const fp3_rtl *rtl) { return rtl->cycle; }

fp3_rtl *open_rtl(const fp3_rtl_watch *watch) try {
    std::unique_ptr<fp3_rtl> rtl(new fp3_rtl());
    rtl->context.reset(new VerilatedContext);
    /* With --x-initial unique, what has no first value in the source starts as noise. */
    rtl->context->randReset(2);
    rtl->context->randSeed(1);
    rtl->top.reset(new HARDWARE{rtl->context.get()});
    rtl->watch = *watch;
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
    /* Verilator looks for the scopes of the hardware in the context that the thread used last, which may be
     * that of another engine, and closed by now. */
    Verilated::threadContextp(rtl->context.get());
    delete rtl;
}

} // namespace

extern "C" __attribute__((visibility("default"))) const fp3_rtl_ops fp3_rtl_table;
extern "C" const fp3_rtl_ops fp3_rtl_table = {
    FP3_RTL_VERSION, sizeof(fp3_rtl_ops), STRING(FP3_CONFIG), open_rtl, close_rtl,
    transfer,        clock_until_quiet,   cycles_so_far,
};
