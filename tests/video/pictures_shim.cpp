/* pictures_shim.cpp - clocks a Verilated fp3_pictures, between a host and a processor. */
#include "pictures.h"

#include <Vfp3_pictures.h>
#include <deque>
#include <verilated.h>

const unsigned RESET_CYCLES = 4, ANSWER_CYCLES = 100000;
const unsigned SLVERR = 2;

struct answer {
    uint64_t due;
    uint32_t data;
    unsigned response;
};

struct noisy_context : VerilatedContext {
    noisy_context() {
        threads(1);
        /* With --x-initial unique, what has no first value in the source starts as noise. */
        randReset(2);
        randSeed(1);
    }
};

struct pictures {
    noisy_context context;
    Vfp3_pictures top{&context};
    pictures_processor processor;
    uint64_t noise, cycle = 0, busy = 0; /* busy: until then the processor has no time */
    std::deque<answer> reads, writes;
    bool reading = false, writing = false;
    uint32_t at = 0, word = 0; /* of a write whose halves come apart */
    bool has_at = false, has_word = false;

    bool waits() {
        if (!noise)
            return false;
        noise = noise * 6364136223846793005u + 1442695040888963407u;
        return noise >> 62 == 0;
    }

    void show() {
        const bool free = busy <= cycle;
        top.m_axi_arready = free && reads.size() < 16 && !waits();
        top.m_axi_awready = free && !has_at && writes.size() < 16 && !waits();
        top.m_axi_wready = free && !has_word && !waits();
        reading = reading || (!reads.empty() && reads[0].due <= cycle && !waits());
        writing = writing || (!writes.empty() && writes[0].due <= cycle && !waits());
        top.m_axi_rvalid = reading;
        top.m_axi_bvalid = writing;
        top.m_axi_rdata = reading ? reads[0].data : ~top.m_axi_rdata;
        top.m_axi_rresp = reading ? reads[0].response : SLVERR;
        top.m_axi_bresp = writing ? writes[0].response : SLVERR;
    }

    void ask(bool is_write, uint32_t address, uint32_t data) {
        uint64_t cycles = 1;
        const unsigned response = processor.access(is_write, address, &data, &cycles) ? SLVERR : 0;
        (is_write ? writes : reads).push_back({cycle + cycles, data, response});
        busy = cycle + cycles > busy ? cycle + cycles : busy;
    }

    void take() {
        if (top.m_axi_rvalid && top.m_axi_rready)
            reads.pop_front(), reading = false;
        if (top.m_axi_bvalid && top.m_axi_bready)
            writes.pop_front(), writing = false;
        const bool reads_one = top.m_axi_arvalid && top.m_axi_arready;
        if (top.m_axi_awvalid && top.m_axi_awready)
            at = top.m_axi_awaddr, has_at = true;
        if (top.m_axi_wvalid && top.m_axi_wready)
            word = top.m_axi_wstrb == 15 ? top.m_axi_wdata : ~top.m_axi_wdata, has_word = true;
        if (has_at && has_word) {
            has_at = has_word = false;
            ask(true, at, word);
        }
        if (reads_one)
            ask(false, top.m_axi_araddr, 0);
        if (busy <= cycle)
            processor.rest();
    }

    void tick() {
        show();
        top.clk_i = 0;
        top.eval();
        if (!top.rst_i)
            take();
        top.clk_i = 1;
        top.eval();
        cycle++;
    }
};

pictures *pictures_open(const pictures_processor *processor, uint64_t seed) {
    pictures *p = new pictures();
    p->processor = *processor;
    p->noise = seed;
    p->top.rst_i = 1;
    for (unsigned i = 0; i < RESET_CYCLES; i++)
        p->tick();
    p->top.rst_i = 0;
    return p;
}

void pictures_close(pictures *p) {
    p->top.final();
    delete p;
}

void pictures_clock(pictures *p, uint64_t cycles) {
    for (; cycles > 0; cycles--)
        p->tick();
}

int pictures_access(pictures *p, int is_write, uint32_t address, uint32_t *data) {
    Vfp3_pictures &top = p->top;
    bool is_asked = false, is_told = false;
    int refused = 0;
    if (is_write) {
        top.s_axi_awaddr = address;
        top.s_axi_wdata = *data;
        top.s_axi_wstrb = 15;
    } else {
        top.s_axi_araddr = address;
    }
    for (unsigned i = 0; i < ANSWER_CYCLES && !is_told; i++) {
        top.s_axi_awvalid = top.s_axi_wvalid = is_write && !is_asked;
        top.s_axi_arvalid = !is_write && !is_asked;
        top.s_axi_bready = top.s_axi_rready = 1;
        p->show();
        top.clk_i = 0;
        top.eval();
        is_asked =
            is_asked || (is_write ? top.s_axi_awready && top.s_axi_wready : top.s_axi_arready);
        if (is_write ? top.s_axi_bvalid : top.s_axi_rvalid) {
            is_told = true;
            refused = (is_write ? top.s_axi_bresp : top.s_axi_rresp) != 0;
            if (!is_write)
                *data = top.s_axi_rdata;
        }
        p->take();
        top.clk_i = 1;
        top.eval();
        p->cycle++;
    }
    top.s_axi_awvalid = top.s_axi_wvalid = top.s_axi_arvalid = 0;
    top.s_axi_bready = top.s_axi_rready = 0;
    return is_told ? refused : -1;
}

uint64_t pictures_frame(pictures *p, FILE *to, uint64_t pixels) {
    Vfp3_pictures &top = p->top;
    bool is_blank = false; /* the vertical sync was there */
    uint64_t last = 0, each = 0;
    while (pixels > 0) {
        p->tick();
        is_blank = is_blank || !top.vsync_o;
        if (!top.pixel_o || !is_blank || (!last && !top.visible_o))
            continue;
        if (last && each && p->cycle - last != each)
            return 0;
        each = last ? p->cycle - last : 0;
        last = p->cycle;
        const unsigned char pixel[4] = {
            static_cast<unsigned char>(top.rgb_o >> 16), static_cast<unsigned char>(top.rgb_o >> 8),
            static_cast<unsigned char>(top.rgb_o),
            static_cast<unsigned char>(top.visible_o | top.hsync_o << 1 | top.vsync_o << 2)};
        fwrite(pixel, 1, sizeof pixel, to);
        pixels--;
    }
    return each;
}
