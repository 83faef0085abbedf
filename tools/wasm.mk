# The command for WebAssembly, build/wasm/fp3.wasm; the Makefile includes this. zig has a compiler and a C library for WASI.

ZIG      := .venv/bin/python -m ziglang
WASM     := $(BUILD)/wasm
WASM_CC   = $(ZIG) cc -target wasm32-wasi -msimd128
# What needs other programs, other processes, loaded libraries, hardware or GSL: sw/cli/wasm/absent.c says so to whoever asks for it.
WASM_NOT := sw/engine/board/port.c $(wildcard sw/engine/fast/cache.c sw/engine/fast/native.c sw/engine/fast/text.c sw/engine/fast/write*.c) sw/base/cc.c sw/base/child.c sw/base/temporary.c \
    $(wildcard sw/engine/cluster/*.c sw/engine/chunks/*.c) sw/cli/run_ranks.c sw/engine/common/library.c sw/record/figure.c sw/record/gnuplot.c sw/record/plot.c \
    $(foreach c,bench_% board cmd_bench cmd_board cmd_compare cmd_doctor processor cmd_stress cmd_tune cmd_view compare_% json tune_% view_%,sw/cli/$(c).c)
WASM_C   := $(filter-out $(WASM_NOT),$(LIB_C) $(CLI_C)) $(wildcard sw/lab/check/*.c sw/lab/scene/*.c sw/cli/wasm/*.c)
WASM_O   := $(WASM_C:%.c=$(WASM)/obj/%.o)
WASM_TESTS := $(WASM)/obj/tests/everywhere/operations.o $(WASM)/obj/tests/bodies/stepped.o
WASM_SWEEPS := $(addprefix $(WASM)/obj/sw/engine/fast/sweep_,flushed.o cut.o flushed_cut.o finite.o words.o)
WASM_EMULATED := SIGNAL GETPID
WASM_CFLAGS := -std=c11 -D_GNU_SOURCE -O2 $(WARN) $(NUMBERS) -include sw/cli/wasm/posix.h -Isw/cli/wasm/include \
    $(WASM_EMULATED:%=-D_WASI_EMULATED_%) $(INCLUDES) -isystem $(WASM)/root/include
WASM_LIBS := -L$(WASM)/root/lib -lconfig -lz -lwasi-emulated-signal -lwasi-emulated-getpid

$(eval $(call NOTE,$(WASM)/flags,$(WASM_CC) $(WASM_CFLAGS)))

$(WASM)/root/done: tools/sysroot.sh | need-playground
	@tools/sysroot.sh wasm32-wasi $(@D)

$(WASM_O) $(WASM_TESTS): $(WASM)/obj/%.o: %.c $(WASM)/root/done $(WASM)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< (wasm)"
	@$(WASM_CC) $(WASM_CFLAGS) -MMD -MP -c -o $@ $<

$(WASM_SWEEPS): $(WASM)/obj/sw/engine/fast/sweep_%.o: sw/engine/fast/sweep.c $(WASM)/root/done $(WASM)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< (wasm, $*)"
	@$(WASM_CC) $(WASM_CFLAGS) -DFP3_SWEEP=fp3_sweep_$* $(SWEEP_$*) -MMD -MP -c -o $@ $<

# Parsing and compiling are recursive.
$(WASM)/fp3.wasm: $(WASM_O) $(WASM_SWEEPS)
	@echo "  LD   $@"
	@$(WASM_CC) -O2 -s -Wl,-z,stack-size=4194304 -o $@ $^ $(WASM_LIBS)

.PHONY: playground
playground: $(BUILD)/playground/index.html ## A page where models are edited and run, by WebAssembly: build/playground/index.html
	@echo "Open it with a browser: $<"

$(BUILD)/playground/index.html: tools/playground.py $(WASM)/fp3.wasm $(wildcard sw/playground/* programs/*.ode programs/integrators/*.cfg) sw/view/page/style.css
	@echo "  PAGE $@"
	@$(PYTHON) $< --wasm $(WASM)/fp3.wasm --output $@

$(WASM)/operations.wasm: $(WASM)/obj/tests/everywhere/operations.o
$(WASM)/stepped.wasm: $(WASM)/obj/tests/bodies/stepped.o
$(WASM)/operations.wasm $(WASM)/stepped.wasm: $(filter-out %/main.o,$(WASM_O)) $(WASM_SWEEPS)
	@echo "  LD   $@"
	@$(WASM_CC) -O2 -s -o $@ $^ $(WASM_LIBS)

-include $(shell find $(WASM)/obj -name '*.d' 2>/dev/null)
