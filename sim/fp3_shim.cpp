// SPDX-License-Identifier: Apache-2.0
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
#include "gen/registers.h"
#include "memory_port.h"
#include <memory>
#include <new>
#include <verilated.h>

struct fp3_rtl {
    std::unique_ptr<VerilatedContext> context;
    std::unique_ptr<HARDWARE> top;
    fp3_rtl_watch watch;
    uint64_t cycle;
    uint64_t noise; /* 0: the master never lets anything wait */
    memory_port memory;
};

namespace {

const unsigned RESET_CYCLES = 4;
const unsigned ANSWER_CYCLES = 10000;

/* How many parts the trace ports have: as many as this build has schedulers, and lanes in each; so
 * many times as instructions may issue at once in one. */
struct shape {
    unsigned schedulers, lanes, streams, space_bit, master;
};

constexpr bool same(const char *a, const char *b) {
    return *a == *b && (!*a || same(a + 1, b + 1));
}
constexpr shape find_shape() {
    shape found = {0, 0, 0, 0, 0};
#define X(name, doc, schedulers, lanes, streams, space_bit, master)                                \
    if (same(#name, STRING(FP3_CONFIG)))                                                           \
        found = {schedulers, lanes, streams, space_bit, master};
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

/* How many cycles the master lets each channel wait: 0 to 3, none in a plain run; noise after a
 * seed. */
unsigned patience(fp3_rtl *rtl) {
    if (!rtl->noise)
        return 0;
    rtl->noise = rtl->noise * 6364136223846793005u + 1442695040888963407u;
    return static_cast<unsigned>(rtl->noise >> 62);
}

void settle(fp3_rtl *rtl) {
    rtl->top->s_axi_aclk = 0;
    if constexpr (SHAPE.master > 0)
        rtl->memory.show(rtl->top.get(), rtl->cycle, [rtl] { return patience(rtl) > 1; });
    rtl->top->eval();
}

void tell_issues(const fp3_rtl *rtl) {
    const HARDWARE *top = rtl->top.get();
    for (unsigned n = 0; n < SHAPE.schedulers * SHAPE.streams; n++) {
        if (!part<1>(top->issue_valid_o, n))
            continue;
        fp3_rtl_issue what = {};
        what.cycle = rtl->cycle;
        what.scheduler = n / SHAPE.streams;
        what.context = part<16>(top->issue_context_o, n);
        what.pc = part<16>(top->issue_pc_o, n);
        what.word = part<32>(top->issue_word_o, n);
        rtl->watch.issue(rtl->watch.user, &what);
    }
}

void tell_ends(const fp3_rtl *rtl) {
    const HARDWARE *top = rtl->top.get();
    for (unsigned n = 0; n < SHAPE.schedulers * SHAPE.lanes * SHAPE.streams; n++) {
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
        what.scheduler = n / SHAPE.streams / SHAPE.lanes;
        what.lane = n / SHAPE.streams % SHAPE.lanes;
        rtl->watch.end(rtl->watch.user, &end);
    }
}

/* Ends the cycle that settle began. Whether something issued or retired in it. */
bool edge(fp3_rtl *rtl) {
    HARDWARE *top = rtl->top.get();
    const bool issued = !is_zero(top->issue_valid_o) && top->s_axi_aresetn;
    const bool retired = !is_zero(top->retire_valid_o) && top->s_axi_aresetn;
    if (issued && rtl->watch.issue)
        tell_issues(rtl);
    if (rtl->watch.end && !is_zero(top->retire_end_o) && top->s_axi_aresetn)
        tell_ends(rtl);
    if constexpr (SHAPE.master > 0)
        if (top->s_axi_aresetn)
            rtl->memory.take(top, rtl->cycle);
    top->s_axi_aclk = 1;
    top->eval();
    rtl->cycle++;
    return issued || retired;
}

/* ---- the bus: a master of AXI4-Lite ---- */

constexpr unsigned address_bits() {
    unsigned bits = SHAPE.space_bit + FP3_ADDRESS_SPACE_BITS;
    for (unsigned n = SHAPE.schedulers; SHAPE.schedulers > 1 && n; n >>= 1)
        bits++;
    return bits;
}
constexpr uint32_t WINDOW = static_cast<uint32_t>((uint64_t{1} << address_bits()) - 1);

/* Whether the bus leads an address to the processor. */
bool is_in_window(uint32_t address) { return address <= WINDOW; }

const unsigned OKAY = 0;

/* What the master does on one channel: the word that is its turn, and how long that one still
 * waits. */
struct channel {
    std::size_t at;
    unsigned wait;
    bool is_up() { return wait == 0 || wait-- == 0; }
};

/* A response channel: what stands must stand still. */
struct response {
    bool stands;
    uint64_t stood;
    bool is_still(bool valid, uint64_t value) {
        const bool still = !stands || (valid && value == stood);
        stands = valid;
        stood = value;
        return still;
    }
};

/* The master sends all writes and all reads in their order, as soon as the bus takes them, and
 * waits for no response. */
struct master {
    fp3_rtl *rtl;
    fp3_rtl_word *words;
    std::size_t count;
    channel aw, w, ar, b, r;
    response written, got;

    /* The next word of this kind that the bus leads to the processor. */
    channel next(bool is_write, std::size_t from) {
        while (from < count &&
               (words[from].is_write != is_write || !is_in_window(words[from].address)))
            from++;
        return {from, from < count ? patience(rtl) : 0};
    }
    void begin() {
        aw = next(true, 0), w = next(true, 0), b = next(true, 0);
        ar = next(false, 0), r = next(false, 0);
        for (std::size_t i = 0; i < count; i++)
            words[i].is_refused = !is_in_window(words[i].address);
    }
    bool is_over() const { return b.at == count && r.at == count; }

    /* What is not valid may be anything. */
    void ask() {
        HARDWARE *top = rtl->top.get();
        top->s_axi_awvalid = aw.at < count && aw.is_up();
        top->s_axi_awaddr = top->s_axi_awvalid ? words[aw.at].address : patience(rtl);
        top->s_axi_wvalid = w.at < count && w.is_up();
        top->s_axi_wdata = top->s_axi_wvalid ? words[w.at].data : ~top->s_axi_wdata;
        top->s_axi_wstrb = top->s_axi_wvalid ? 15 : 0;
        top->s_axi_arvalid = ar.at < count && ar.is_up();
        top->s_axi_araddr = top->s_axi_arvalid ? words[ar.at].address : patience(rtl);
    }
    /* Whether the responses are as they must be: each to a request that was made, and still. */
    bool listen() {
        HARDWARE *top = rtl->top.get();
        const uint64_t told = top->s_axi_bresp;
        const uint64_t read = static_cast<uint64_t>(top->s_axi_rresp) << 32 | top->s_axi_rdata;
        if (!written.is_still(top->s_axi_bvalid, told) || !got.is_still(top->s_axi_rvalid, read) ||
            (top->s_axi_bvalid && !(b.at < aw.at && b.at < w.at)) ||
            (top->s_axi_rvalid && r.at >= ar.at))
            return false;
        top->s_axi_bready = top->s_axi_bvalid && b.is_up();
        top->s_axi_rready = top->s_axi_rvalid && r.is_up();
        return true;
    }
    /* What both sides agree on in this cycle. Whether there was something. */
    bool shake() {
        HARDWARE *top = rtl->top.get();
        const bool goes[] = {top->s_axi_awvalid && top->s_axi_awready,
                             top->s_axi_wvalid && top->s_axi_wready,
                             top->s_axi_arvalid && top->s_axi_arready};
        if (top->s_axi_bready) {
            words[b.at].is_refused = top->s_axi_bresp != OKAY;
            b = next(true, b.at + 1);
            written.stands = false;
        }
        if (top->s_axi_rready) {
            words[r.at].is_refused = top->s_axi_rresp != OKAY;
            words[r.at].data = top->s_axi_rdata;
            r = next(false, r.at + 1);
            got.stands = false;
        }
        if (goes[0])
            aw = next(true, aw.at + 1);
        if (goes[1])
            w = next(true, w.at + 1);
        if (goes[2])
            ar = next(false, ar.at + 1);
        return goes[0] || goes[1] || goes[2] || top->s_axi_bready || top->s_axi_rready;
    }
};

int transfer(fp3_rtl *rtl, fp3_rtl_word *words, std::size_t count) {
    HARDWARE *top = rtl->top.get();
    master m = {};
    m.rtl = rtl;
    m.words = words;
    m.count = count;
    m.begin();
    bool is_right = true;
    for (unsigned still = 0; is_right && !m.is_over() && still < ANSWER_CYCLES; still++) {
        m.ask();
        settle(rtl);
        is_right = m.listen();
        if (m.shake())
            still = 0;
        edge(rtl);
        top->s_axi_bready = top->s_axi_rready = 0;
    }
    top->s_axi_awvalid = top->s_axi_wvalid = top->s_axi_arvalid = 0;
    return is_right && m.is_over() ? 0 : -1;
}

void clock_until_quiet(fp3_rtl *rtl, uint64_t cycles, uint64_t quiet) {
    for (uint64_t still = 0; cycles > 0 && still < quiet; cycles--) {
        settle(rtl);
        still = edge(rtl) ? 0 : still + 1;
    }
}

uint32_t *put_memory(fp3_rtl *rtl, const fp3_rtl_memory *how) try {
    if (!SHAPE.master)
        return nullptr;
    rtl->memory.open(*how);
    return rtl->memory.words.data();
} catch (const std::bad_alloc &) {
    return nullptr;
}

uint64_t cycles_so_far(const fp3_rtl *rtl) { return rtl->cycle; }

fp3_rtl *open_rtl(const fp3_rtl_watch *watch, uint64_t waits) try {
    std::unique_ptr<fp3_rtl> rtl(new fp3_rtl());
    rtl->context.reset(new VerilatedContext);
    /* The model is of one thread. By default the context starts one for each other processor, which
     * aborts where no more processes are allowed, and waits for ever in a child after fork. */
    rtl->context->threads(1);
    /* With --x-initial unique, what has no first value in the source starts as noise. */
    rtl->context->randReset(2);
    rtl->context->randSeed(1);
    rtl->top.reset(new HARDWARE{rtl->context.get()});
    rtl->watch = *watch;
    rtl->noise = waits;
    rtl->top->s_axi_aresetn = 0;
    clock_until_quiet(rtl.get(), RESET_CYCLES, RESET_CYCLES);
    rtl->top->s_axi_aresetn = 1;
    return rtl.release();
} catch (const std::bad_alloc &) {
    return nullptr;
}

void close_rtl(fp3_rtl *rtl) {
    rtl->top->final();
    /* Verilator looks for the scopes of the hardware in the context that the thread used last,
     * which may be that of another engine, and closed by now. */
    Verilated::threadContextp(rtl->context.get());
    delete rtl;
}

} // namespace

extern "C" __attribute__((visibility("default"))) const fp3_rtl_ops fp3_rtl_table;
extern "C" const fp3_rtl_ops fp3_rtl_table = {
    FP3_RTL_VERSION, sizeof(fp3_rtl_ops), STRING(FP3_CONFIG), open_rtl,      close_rtl,
    transfer,        clock_until_quiet,   put_memory,         cycles_so_far,
};
