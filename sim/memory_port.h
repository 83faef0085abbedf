// SPDX-License-Identifier: Apache-2.0
/* memory_port.h - a memory behind the master of AXI4 of Verilated hardware.
 *
 * Bursts are answered in order, in those of each channel. In each cycle: show() sets what the
 * memory says, the hardware settles, take() is what both sides agree on, the clock rises.
 */
#ifndef FP3_MEMORY_PORT_H
#define FP3_MEMORY_PORT_H

#include "fp3_rtl.h"
#include <deque>
#include <vector>

class memory_port {
  public:
    std::vector<uint32_t> words;

    void open(const fp3_rtl_memory &how) {
        words.assign(how.words, 0);
        of = how;
        credit = 0;
    }

    /* wait: whether a channel waits in this cycle. */
    template <typename Top, typename Wait> void show(Top *top, uint64_t cycle, Wait wait) {
        credit = credit + of.rate < 2 * WORD ? credit + of.rate : 2 * WORD;
        const bool may = credit >= WORD;
        top->m_axi_arready = reads.size() < BURSTS && !wait();
        top->m_axi_awready = writes.size() < BURSTS && !wait();
        top->m_axi_rvalid = reading || (!reads.empty() && reads[0].due <= cycle && may && !wait());
        reading = top->m_axi_rvalid;
        if (reading) {
            const burst &at = reads[0];
            top->m_axi_rdata = is_there(at.address) ? words[at.address / 4] : 0;
            top->m_axi_rresp = is_there(at.address) ? OKAY : DECERR;
            top->m_axi_rlast = at.left == 1;
        }
        top->m_axi_wready = !writes.empty() && credit >= WORD * (1 + reading) && !wait();
        top->m_axi_bvalid = telling || (!told.empty() && told[0].due <= cycle && !wait());
        telling = top->m_axi_bvalid;
        if (telling)
            top->m_axi_bresp = told[0].response;
    }

    template <typename Top> void take(Top *top, uint64_t cycle) {
        if (top->m_axi_rvalid && top->m_axi_rready) {
            reading = false;
            credit -= WORD;
            reads[0].address += 4;
            if (--reads[0].left == 0)
                reads.pop_front();
        }
        if (top->m_axi_bvalid && top->m_axi_bready) {
            telling = false;
            told.pop_front();
        }
        if (top->m_axi_wvalid && top->m_axi_wready) {
            credit -= WORD;
            burst &at = writes[0];
            if (!is_there(at.address))
                at.response = DECERR;
            else if (top->m_axi_wstrb)
                words[at.address / 4] = top->m_axi_wdata;
            at.address += 4;
            if (--at.left == 0) {
                at.due = cycle + of.latency;
                told.push_back(at);
                writes.pop_front();
            }
        }
        if (top->m_axi_arvalid && top->m_axi_arready)
            reads.push_back({top->m_axi_araddr, top->m_axi_arlen + 1u, cycle + of.latency, OKAY});
        if (top->m_axi_awvalid && top->m_axi_awready)
            writes.push_back({top->m_axi_awaddr, top->m_axi_awlen + 1u, 0, OKAY});
    }

  private:
    struct burst {
        uint32_t address, left;
        uint64_t due;
        uint8_t response;
    };
    static const uint32_t WORD = 1000;
    static const std::size_t BURSTS = 4;
    static const uint8_t OKAY = 0, DECERR = 3;
    fp3_rtl_memory of = {0, WORD, 1};
    std::deque<burst> reads, writes, told;
    uint32_t credit = 0;
    bool reading = false, telling = false; /* what is said stands until it is taken */

    bool is_there(uint32_t address) const { return address / 4 < words.size(); }
};

#endif
