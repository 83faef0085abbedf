"""The promises of the control modules, each stated in a specification beside this file, proved by induction."""

import tile
import values
from subject import Subject, TIMING, configurations, latency

import master_bugs


# ---- the scoreboard -----------------------------------------------------------------------------

def scoreboard(reg_w, bypass, chain, add, mul):
    return {"REG_W": reg_w, "BYPASS": bypass, "CHAIN": chain, "ADD_LATENCY": add, "MUL_LATENCY": mul}


def used(row):
    """The scoreboard of a configuration. A multiply-add that is rounded once is as late as a sum, and nothing is chained."""
    add, mul = latency(row, "add"), latency(row, "mul")
    if row["fused"]:
        return scoreboard(row["registers"].bit_length(), row["bypass"], 0, mul + add - TIMING["solo_fused"]["cycles"], mul)
    return scoreboard(row["registers"].bit_length(), row["bypass"], int(any(row[key] for key in ("chain", "select", "estimate", "round"))), add, mul)


USED = {tuple(used(row).items()) for row in configurations(interleave=0)}
EDGES = [scoreboard(3, *rest) for rest in
         [(1, 1, 1, 2), (1, 1, 2, 1), (1, 0, 1, 1), (1, 1, 3, 5), (0, 1, 1, 1), (0, 0, 1, 1), (0, 1, 5, 3)]]
SHORT, LONG, BARE = scoreboard(3, 1, 1, 1, 2), scoreboard(3, 1, 1, 3, 5), scoreboard(3, 0, 0, 1, 2)

SCOREBOARD = Subject(
    "scoreboard_spec", ("fp3_scoreboard.v",),
    "latencies {ADD_LATENCY} and {MUL_LATENCY}, bypass {BYPASS}, chain {CHAIN}, {REG_W} bits",
    [dict(shape) for shape in sorted(USED)] + EDGES, [
        ("bypass from the other unit", "{mul_q[1], !mul_q[1]}", "{!mul_q[1], mul_q[1]}", SHORT),
        ("bypass of c by b's name", "c_bypass_o = c_i ==", "c_bypass_o = b_i ==", SHORT),
        ("bypass a cycle late", "a_bypass_o = a_i == d_q[1]", "a_bypass_o = a_i == d_q[0]", SHORT),
        ("a's flag ignored", "|| busy_q[a_i]", "", LONG),
        ("c's flag ignored", "|| (busy_q[c_i] && reads_c_i)", "", LONG),
        ("c's flag counts for all", "(busy_q[c_i] && reads_c_i)", "busy_q[c_i]", LONG),
        ("a flagged destination issues", "assign blocked_o = busy_q[d_i] ||", "assign blocked_o =", LONG),
        ("a flag for what nobody waits for", "BYPASS != 0 ? |(insert >> FREE) : issue_i", "issue_i", SHORT),
        ("a flag falls with the wrong result", "one << d_q[FREE]", "one << d_q[0]", LONG),
        ("a flag falls a cycle early", "BYPASS != 0 ? 2 : 0;", "BYPASS != 0 ? 3 : 0;", LONG),
        ("a flag falls a cycle late", "BYPASS != 0 ? 2 : 0;", "BYPASS != 0 ? 1 : 0;", LONG),
        ("without bypass a flag falls early", "BYPASS != 0 ? 2 : 0;", "BYPASS != 0 ? 2 : 1;", BARE),
        ("a flag survives reset", "if (rst_i) busy_q <= {(1<<REG_W){1'b0}};", "if (1'b0) busy_q <= 0;", SHORT),
        ("a result survives reset", "if (rst_i) valid_q <= {LONGEST+1{1'b0}};", "if (1'b0) valid_q <= 0;", LONG),
        ("a write in reset", "valid_q[0] && !rst_i", "valid_q[0]", SHORT),
        ("taken never", "|(slot & (valid_q >> 1))", "1'b0", SHORT),
        ("taken always", "|(slot & (valid_q >> 1))", "1'b1", SHORT),
        ("taken a cycle late", "|(slot & (valid_q >> 1))", "|(slot & valid_q)", SHORT),
        ("a product in a sum's slot", "to_mul_i}                 << MUL_LATENCY",
         "to_mul_i}                 << ADD_LATENCY", SHORT),
        ("a chain a cycle short", "CHAIN_LATENCY = MUL_LATENCY + ADD_LATENCY", "CHAIN_LATENCY = MUL_LATENCY + ADD_LATENCY - 1",
         SHORT),
        ("write_mul a cycle early", "write_mul_o = mul_q[0]", "write_mul_o = mul_q[1]", SHORT),
        ("write_mul for a chain", "mul_q[k] <= to_mul_i;", "mul_q[k] <= !to_add_i;", SHORT),
        ("the name of the next result", "write_d_o   = d_q[0]", "write_d_o   = d_q[1]", SHORT),
        ("names do not move on", "d_q[k]   <= d_q[k+1];", "d_q[k]   <= d_q[k];", SHORT),
        ("empty too soon", "empty_o     = ~|(valid_q >> 1)", "empty_o     = ~|(valid_q >> 2)", SHORT),
        ("empty too late", "empty_o     = ~|(valid_q >> 1)", "empty_o     = ~|valid_q", SHORT),
    ])


# ---- the arbiter ---------------------------------------------------------------------------------

def arbiter(n, patience, sweep, drops=0):
    return {"N": n, "PATIENCE": patience, "SWEEP": sweep, "DROPS": drops}


DUEL, TRIO, STOPS = arbiter(2, 5, 4), arbiter(3, 5, 4), arbiter(3, 5, 4, 1)

ARBITER = Subject(
    "arbiter_spec", ("fp3_arbiter.v",), "{N} schedulers, patience {PATIENCE}, sweeps of {SWEEP}, stops {DROPS}",
    [arbiter(n, 127, 24) for n in range(2, 8)] + [arbiter(n, 127, 24, 1) for n in range(2, 9)] + [TRIO], [
        ("nobody is urgent", "urgent[i] = waited_q[8*i +: 8] == PATIENCE_8", "urgent[i] = 1'b0", DUEL),
        ("the urgent come last", "urgent[i] ? level == 0", "urgent[i] ? level == 2", DUEL),
        ("urgent a cycle early", "== PATIENCE_8", "== PATIENCE_8 - 8'd1", DUEL),
        ("urgent after the sweep", "if (rst_i || over[m])", "if (rst_i)", DUEL),
        ("a grant does not end waiting", "grant_q[m] ? 8'd0 : waited_q[8*m +: 8] + 1'b1", "waited_q[8*m +: 8] + 1'b1", DUEL),
        ("the adder twice", "adder_free      = adder_free && !adds_i[i];", "", DUEL),
        ("the multiplier twice", "multiplier_free = multiplier_free && !muls_i[i];", "", DUEL),
        ("both with one of them free", "&& (multiplier_free || !muls_i[i])", "", TRIO),
        ("additions first", "muls_i[i] ? level == 1 : level == 2", "muls_i[i] ? level == 2 : level == 1", DUEL),
        ("the adder wasted", "adder_free && !adds_i[i]", "1'b0", DUEL),
        ("a grant for a sweep that is over", "stays = needs & ~over", "stays = needs", DUEL),
        ("a grant for whoever does not ask", "== rank && stays[i]", "== rank && !over[i]", DUEL),
        ("who needs nothing waits", "grant_q | ~needs", "grant_q", DUEL),
        ("whose sweep has ended comes first", "(over[m] && !over[n])  before_q[N*m + n] <= 1'b1", "(over[m] && !over[n])  before_q[N*m + n] <= 1'b0",
         DUEL),
        ("the order survives reset", "if (rst_i)                     before_q", "if (1'b0)                     before_q", DUEL),
        ("a grant in reset", "rst_i ? {N{1'b0}} : grant", "grant", STOPS),
    ], depth=2)


# ---- the pause rule ------------------------------------------------------------------------------

def pace(contexts, gap):
    return {"CONTEXTS": contexts, "GAP": gap}


def gap(row):
    shared = TIMING["share"]["cycles"] if row["schedulers"] > 1 else 0
    return latency(row, "add") + latency(row, "mul") + shared + TIMING["gap"]["cycles"]


TAKES_TURNS = {(row["contexts"], gap(row)) for row in configurations(interleave=1, dual=0)}
FEW, MANY = pace(4, 6), pace(4, 3)

PACE = Subject(
    "pace_spec", ("fp3_pace.v",), "{CONTEXTS} contexts, {GAP} cycles apart",
    [pace(*shape) for shape in sorted(TAKES_TURNS)] + [pace(2, 9), pace(5, 4)], [
        ("a pause too short", "GAP_C - least_q", "GAP_C - least_q - 1'b1", FEW),
        ("a pause too long", "GAP_C - least_q", "GAP_C - least_q + 1'b1", FEW),
        ("half of the contexts counted", "count_q    <= low_q + high_q", "count_q    <= low_q", MANY),
        ("the greater of two sweeps", "count_q < before_q ? count_q : before_q", "count_q < before_q ? before_q : count_q", FEW),
        ("the sweep before forgotten", "else if (take_i) before_q <= count_q;", "", FEW),
        ("a pause that a long sweep has", "over_i && unpaused_q", "over_i", FEW),
        ("no sweep follows without a gap", "over_i && unpaused_q", "1'b0", MANY),
        ("one context short of enough", "least_q >= GAP_C", "least_q + 1'b1 >= GAP_C", pace(4, 5)),
        ("a pause counted a cycle too soon", "(busy_i ? ZERO : since_q) + 1'b1", "since_q + 1'b1", FEW),
        ("may before the pause is known", "known_o = valid_i && age_q[4]", "known_o = valid_i && age_q[3]", FEW),
        ("a mask that has gone is known", "age_q      <= valid_i && !rst_i ?", "age_q      <= !rst_i ?", FEW),
        ("the first sweep pauses", "else if (start_i)          since_q <= GAP_C;", "", FEW),
        ("nothing ever starts", "rested_q   <= (busy_i ? ZERO : since_q) + 1'b1 >= pause_q", "rested_q   <= 1'b0", FEW),
    ])


# A sum and a product are as late as the slower of the two.
AT_ONCE = {(row["contexts"], max(latency(row, "add"), latency(row, "mul")) + TIMING["early"]["cycles"] + TIMING["gap"]["cycles"]) for row in configurations(dual=1)}
BRIEF, WIDE = pace(3, 10), pace(9, 6)

DUAL_PACE = Subject(
    "dual_pace_spec", ("fp3_dual_pace.v",), "{CONTEXTS} contexts, {GAP} cycles apart",
    [pace(*shape) for shape in sorted(AT_ONCE)] + [BRIEF, WIDE], [
        ("sweeps a cycle too near", "since_q >= GAP_C - 1'b1", "since_q >= GAP_C - 2'd2", BRIEF),
        ("sweeps as if there were no other unit", "&& since_q >= GAP_C - 1'b1", "", BRIEF),
        ("a sum while the adder is busy", "(!adds_q || adder_i)", "1'b1", WIDE),
        ("a product while the multiplier is busy", "(!muls_q || multiplier_i)", "1'b1", WIDE),
        ("the first sweep waits", "since_q  <= start_i ? GAP_C : since;", "since_q  <= since;", BRIEF),
        ("half of all contexts counted", "count_q  <= low_q | high_q", "count_q  <= low_q", WIDE),
        ("may before the size is known", "known_o = valid_i && age_q[4]", "known_o = valid_i && age_q[3]", BRIEF),
        ("a size that has gone is known", "age_q    <= valid_i && !rst_i ?", "age_q    <= !rst_i ?", BRIEF),
        ("what there is not is swept", "&& legal_i", "", BRIEF),
        ("may before its size is known", "(age_q[4] || age_q[3])", "age_q[3:2] != 2'd0", BRIEF),
    ])


# ---- the bus --------------------------------------------------------------------------------------

QUICK, SLOW, FOUR = ({"PATIENCE": patience, "PLACES_W": places} for patience, places in ((0, 1), (1, 1), (0, 2)))

AXI_LITE = Subject(
    "axi_lite_spec", ("fp3_axi_lite.v", "fp3_responses.v"), "2^{PLACES_W} places, a host port that takes and answers within {PATIENCE} cycles",
    [{"PATIENCE": 1, "PLACES_W": places} for places in (1, 2, 4)], [
        ("a write without its data", "write_next    = aw_q && w_q &&", "write_next    = aw_q &&", QUICK),
        ("an address changes while it waits", "if (s_axi_awready) awaddr_q", "awaddr_q", QUICK),
        ("write without room", "aw_q && w_q && write_room &&", "aw_q && w_q &&", QUICK),
        ("read without room", "read_next     = ar_q && read_room &&", "read_next     = ar_q &&", QUICK),
        ("reads wait for bready", "ar_q && read_room && !write_next", "ar_q && read_room && !s_axi_bvalid && !write_next", QUICK),
        ("writes wait for rready", "aw_q && w_q && write_room &&", "aw_q && w_q && write_room && !s_axi_rvalid &&", QUICK),
        ("writes come first", "!(ar_q && read_room && write_q)", "1'b1", QUICK),
        ("reads come first", "!(ar_q && read_room && write_q)", "!(ar_q && read_room)", QUICK),
        ("some bytes are a word", "whole         = &wstrb_q", "whole         = |wstrb_q", QUICK),
        ("write of some bytes is none", "skip ? |wstrb_q", "skip ? 1'b0", QUICK),
        ("some bytes overtake a word", "write_streams = whole && |(awaddr_q & STREAM)", "write_streams = |(awaddr_q & STREAM)", SLOW),
        ("errors of reads are lost", "{read_error_i, rdata_i}", "{1'b0, rdata_i}", QUICK),
        ("write's address for a read", "write_next ? awaddr_q : araddr_q", "araddr_q", QUICK),
        ("what is alone does not wait", "write_next && (idle_q || (write_streams && !alone_q))", "write_next", SLOW),
        ("write beside what is alone", "(write_streams && !alone_q)", "write_streams", SLOW),
        ("read beside what is alone", "(read_streams && !alone_q)", "read_streams", SLOW),
        ("reads are never alone", " || (read_goes && !read_streams)", "", SLOW),
        ("idle while a read is under way", "write_idle && read_idle && !write_goes", "write_idle && !write_goes", SLOW),
        ("idle when a request goes", "read_idle && !write_goes && !read_goes", "read_idle", QUICK),
        ("an address is lost", "awready = !aw_q || write_goes", "awready = 1'b1", QUICK),
        ("read is asked twice", "(ar_q && !read_goes)  || s_axi_arvalid", "ar_q || s_axi_arvalid", QUICK),
        ("request survives reset", "{aw_q, w_q, ar_q, idle_q, alone_q, write_q} <= 6'd0", "{aw_q, w_q, idle_q, alone_q, write_q} <= 5'd0", QUICK),
    ], depth=4)

RESPONSES = AXI_LITE._replace(sources=("fp3_responses.v", "fp3_axi_lite.v"), shapes=[], bugs=[
        ("a response before its answer", "valid_o = filled_q != taken_q", "valid_o = gone_q != taken_q", SLOW),
        ("response waits for ready", "valid_o = filled_q != taken_q", "valid_o = filled_q != taken_q && ready_i", QUICK),
        ("newest response first", "value_q[taken_q[", "value_q[filled_q[", QUICK),
        ("two responses in one place", "value_q[filled_q[DEPTH_W-1:0]] <= value_i", "value_q[0] <= value_i", QUICK),
        ("data change while they stand", "if (answered_i) value_q", "value_q", QUICK),
        ("room for one too many", "!kept[DEPTH_W] && !(&kept[DEPTH_W-1:0])", "!kept[DEPTH_W]", QUICK),
        ("only the lowest bit of a place's number", "value_q[filled_q[DEPTH_W-1:0]] <= value_i", "value_q[filled_q[DEPTH_W-1:0] & {{DEPTH_W-1{1'b0}}, 1'b1}] <= value_i", FOUR),
        ("half of the places stay empty", "!(&kept[DEPTH_W-1:0])", "!kept[DEPTH_W-1]", FOUR),
        ("response is repeated", "if (take)       taken_q", "if (take && room_q) taken_q", QUICK),
        ("response survives reset", "{gone_q, filled_q, taken_q} <= {3*(DEPTH_W+1){1'b0}}", "{gone_q, taken_q} <= {2*(DEPTH_W+1){1'b0}}", QUICK),
        ("idle waits for the master", "idle_o  = gone_q == filled_q", "idle_o  = gone_q == taken_q", QUICK),
    ])


# ---- the board's bus -----------------------------------------------------------------------------

ANY, NONE = {"ADDRESS_W": 24, "PATIENCE": 1}, {"ADDRESS_W": 24, "PATIENCE": 0}

TRANSACT = Subject(
    "transact_spec", ("fp3_transact.v",), "{ADDRESS_W} bits of address, a slave that answers within {PATIENCE} cycles",
    [ANY], [
        ("address of a write is taken back", "aw_q ? !m_axi_awready", "aw_q ? 1'b0", ANY),
        ("data are taken back", "w_q  ? !m_axi_wready", "w_q  ? 1'b0", ANY),
        ("address of a read is taken back", "ar_q ? !m_axi_arready", "ar_q ? 1'b0", ANY),
        ("address of a read stays when it is taken", "ar_q ? !m_axi_arready", "ar_q ? !m_axi_rvalid", ANY),
        ("address changes before it is taken", "if (state_q == WAIT && over) begin", "if (state_q == WAIT && (over || m_axi_wready)) begin", ANY),
        ("data change while they wait", "state_q == ANSWER ? word_at_i : word_q", "aw_q ? word_q : word_at_i", ANY),
        ("the next word before the response", "over    = write_i ? m_axi_bvalid", "over    = write_i ? !aw_q && !w_q", ANY),
        ("response to a write waits", "m_axi_bready  = state_q == WAIT && write_i", "m_axi_bready  = state_q == WAIT && write_i && !w_q", NONE),
        ("read's response is never taken", "m_axi_rready  = state_q == WAIT && !write_i", "m_axi_rready  = 1'b0", ANY),
        ("an error does not end it", "failed || word_q == last_i", "word_q == last_i", ANY),
        ("reads have no errors", ": m_axi_rresp[1]", ": 1'b0", ANY),
        ("one word too many", "failed || word_q == last_i", "failed || number == last_i + 2", ANY),
        ("half of a word", "m_axi_wstrb   = 4'b1111", "m_axi_wstrb   = 4'b0011", ANY),
        ("address without its high bits", "outside = |address_q[31:ADDRESS_W]", "outside = 1'b0", ANY),
        ("outside, and sent", "state_q == FETCH && !outside;", "state_q == FETCH;", ANY),
        ("a write twice", "again ? ANSWER : FETCH", "FETCH", ANY),
        ("status of a write forgotten", "request_i && !again;", "request_i;", ANY),
        ("read before makes a write none", "kept_q <= write_i", "kept_q <= 1'b1", ANY),
        ("last write survives reset", "{state_q, aw_q, w_q, ar_q, kept_q} <= {IDLE, 4'b0000}", "{state_q, aw_q, w_q, ar_q} <= {IDLE, 3'b000}", ANY),
        ("transfer survives reset", "{state_q, aw_q, w_q, ar_q, kept_q} <= {IDLE, 4'b0000}", "{state_q, aw_q, w_q, kept_q} <= {IDLE, 3'b000}", ANY),
        ("status counts from nought", "over && failed) status_q <= number", "over && failed) status_q <= {1'b0, word_q}", ANY),
        ("the word that failed is answered", "status_q - 7'd1 :", "status_q :", ANY),
        ("read words at the wrong place", "store_i ? store_at_i : word_q", "store_i ? store_at_i : word_at_i", ANY),
        ("answered too soon", "!over ? WAIT : failed", "!over ? (word_q[1] ? ANSWER : WAIT) : failed", ANY),
    ], models=("one_word.v",))


# ---- the master of AXI4 ---------------------------------------------------------------------------

def seeded(file, shape):
    """The bugs that its bench sees, too."""
    return [(*bug, shape) for bug in master_bugs.BUGS[file]]


RANGE, TURNS, BOTH = {"WORDS_W": 24}, {"TURN": 64, "REST": 4}, {"ADDRESS_W": 20, "INSIDE": 18, "READS_W": 5}

BURSTS = Subject("bursts_spec", ("fp3_bursts.v",), "{WORDS_W} bits of a number of words", [RANGE], seeded("fp3_bursts.v", RANGE))

TURN_BY_TURN = Subject("turns_spec", ("fp3_turns.v",), "turns of {TURN} requests, {REST} cycles between",
                       [TURNS], seeded("fp3_turns.v", {"TURN": 4, "REST": 4}))

TRANSFER = Subject("transfer_spec", ("fp3_transfer.v", "fp3_bursts.v", "fp3_responses.v", "gen/registers.vh"), "2^{READS_W} reads of the processor",
                   [{"READS_W": 1}], seeded("fp3_transfer.v", {"READS_W": 1}), cycles=0)

MASTER = Subject("master_spec", ("fp3_master.v", "fp3_turns.v", "gen/registers.vh"), "{ADDRESS_W} bits of address, {INSIDE} of them of a scheduler",
                 [BOTH, {"ADDRESS_W": 24, "INSIDE": 20, "READS_W": 4}], seeded("fp3_master.v", BOTH), models=("any_transfer.v",))


# ---- the host -------------------------------------------------------------------------------------

def schedulers(n, quiet):
    return {"N": n, "QUIET": quiet}


ALONE, CROWD = schedulers(3, 2), schedulers(40, 0)

HUB = Subject(
    "hub_spec", ("fp3_hub.v", "host/answer.vh", "gen/registers.vh", "config/undefine.vh"), "{N} schedulers, quiet for {QUIET}",
    [schedulers(1, 0), schedulers(2, 14), schedulers(4, 12), ALONE, CROWD, schedulers(64, 1)], [
        ("all is the last scheduler", "|| who == ALL", "|| (who == ALL && NUMBER + 1 == N)", ALONE),
        ("a request of nobody is none", "(nobody ? FIRST : whom)", "whom", ALONE),
        ("nobody is somebody", "nobody ? NOWHERE : req_addr_i[23:0]", "req_addr_i[23:0]", ALONE),
        ("nobody shows interrupts", "pending_q <= !nobody &&", "pending_q <=", ALONE),
        ("schedulers from 32 on are shown twice", "addr_q[2] ? irqs[63:32] : irqs[31:0]", "irqs[31:0]", CROWD),
        ("interrupts in every answer", "pending & {32{pending_q}}", "pending", ALONE),
        ("the first answer is that of all", "answer = answer | answer_i[`FP3_ANSWER_W*k +: `FP3_ANSWER_W]", "answer = answer | answer_i[`FP3_ANSWER_W-1:0]", ALONE),
        ("schedulers are asked in reset", "req_valid_i && !rst_i &&", "req_valid_i &&", ALONE),
        ("a request is taken in reset", "req_ready_o = !rst_i && takes", "req_ready_o = takes", ALONE),
        ("a write is answered in reset", "{answer_wrote && !rst_i,", "{answer_wrote,", ALONE),
        ("a read is answered in reset", "answer_read && !rst_i,", "answer_read,", ALONE),
        ("a start soon after a list's last number", "takes = quiet || streams", "takes = 1'b1", ALONE),
        ("what streams waits, too", "takes = quiet || streams", "takes = quiet", ALONE),
        ("a cycle too soon", "left_q <= QUIET[W-1:0]", "left_q <= QUIET[W-1:0] - 1'b1", ALONE),
        ("a read is as loud as a write", "req_valid_i && req_write_i && streams", "req_valid_i && streams", ALONE),
        ("address and data do not stand", "if (req_valid_i && takes) {write_q", "{write_q", ALONE),
    ])


ONE_RUN = {"CONFIG": "many"}

HOST_PORT = Subject(
    "host_port_spec", ("fp3_host_port.v", "fp3_host_decode.v", "fp3_delay.v"), "", [ONE_RUN, {"CONFIG": "world_keep"}], [
        ("a refused setting is set", "else if (to_q && ok_q) value_q", "else if (to_q) value_q", ONE_RUN),
        ("a refused start begins a run", "start        = to_control_q && ok_q && wants_start", "start        = to_control_q && wants_start", ONE_RUN),
        ("a refused write reaches a memory", "access_q  <= check_q && ok && in_memory", "access_q  <= check_q && in_memory", ONE_RUN),
        ("a refused word reaches the program", "load_q    <= check_q && ok && in_program", "load_q    <= check_q && in_program", ONE_RUN),
        ("a write is answered as a read, too", "ours_q    <= check_q && !write_q && ours", "ours_q    <= check_q && ours", ONE_RUN),
        ("a read of a memory is answered a cycle early", ".N(MEMORY_LATENCY)) u_fetched (", ".N(MEMORY_LATENCY-1)) u_fetched (", ONE_RUN),
        ("a stop without a run", "ok_q && wants_stop && running_i", "ok_q && wants_stop", ONE_RUN),
    ], depth=5, models=("any_counters.v",), cycles=16)

# What a run needs is set with pauses that are too long for a run from reset.
HOST_PORT_RUN = HOST_PORT._replace(shapes=[], cycles=0, bugs=[
        ("a start without steps clears no counter", "clear_q    <= start;", "clear_q    <= start && !no_steps_q;", ONE_RUN),
        ("a stop in the cycle of an illegal word is a reason, too", "if (stop_o && !illegal_i && !illegal_q", "if (stop_o && !illegal_q", ONE_RUN),
        ("an illegal word behind a stop is a reason, too", "if (illegal_i && !stopped_q && !no_room_q)", "if (illegal_i && !no_room_q)", ONE_RUN),
        ("a start without steps begins a run", "start && !no_steps_q && !rst_i", "start && !rst_i", ONE_RUN),
    ])


def cases():
    """(name, action of yosys and files) for every proof and every seeded bug."""
    for subject in (SCOREBOARD, ARBITER, PACE, DUAL_PACE, AXI_LITE, RESPONSES, TRANSACT, BURSTS, TURN_BY_TURN, TRANSFER, MASTER, HUB, HOST_PORT, HOST_PORT_RUN, *tile.SUBJECTS, *values.SUBJECTS):
        yield from subject.cases()
