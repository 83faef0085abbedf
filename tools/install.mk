# Installs libfp3, what it loads, the command, and the driver's sources; the Makefile includes this.
#
#   make install                        below /usr/local
#   make install PREFIX=/usr DESTDIR=x  for /usr, but put below x/
#   make uninstall                      with the same PREFIX, LIBDIR and DESTDIR

PREFIX  ?= /usr/local
LIBDIR  ?= $(PREFIX)/lib
INCDIR  := $(DESTDIR)$(PREFIX)/include/fp3
MAN     := $(DESTDIR)$(PREFIX)/share/man/man1/fp3.1
BASH    := $(DESTDIR)$(PREFIX)/share/bash-completion/completions/fp3
# Where zsh looks: below /usr is Debian's place for packages.
ZSH     := $(DESTDIR)$(PREFIX)/share/zsh/$(if $(filter /usr,$(PREFIX)),vendor-completions,site-functions)/_fp3
COMMAND := $(DESTDIR)$(PREFIX)/bin/fp3
BARE    := $(DESTDIR)$(PREFIX)/share/fp3/bare
RTL_DIR := $(DESTDIR)$(LIBDIR)/fp3
VERSION  = $(shell sed -n 's/^.define FP3_VERSION "\(.*\)"/\1/p' sw/include/fp3/status.h)

# A place that the command, the library and pkg-config can name: make, pc files and -D options break at
# blanks and quotes, and what is installed is used from other directories.
NAMED = $(if $(filter 1,$(words $(1))),$(if $(strip $(foreach c,' " \ $$ : ; & | < > ( ) * ? `,$(findstring $(c),$(1)))),,$(1)))
ifneq ($(filter install uninstall,$(MAKECMDGOALS)),)
$(foreach v,PREFIX LIBDIR,$(if $(filter /%,$(call NAMED,$($(v)))),,$(error $(v) is '$($(v))': expected an absolute path without blanks, quotes and other signs of the shell)))
$(if $(DESTDIR),$(if $(call NAMED,$(DESTDIR)),,$(error DESTDIR is '$(DESTDIR)': expected a path without blanks, quotes and other signs of the shell)))
endif

# One object knows where the library lives, below /usr/local. For another place that object, and what is linked with it, are made in a directory
# of their own, so that an installation changes nothing that tests or other installations use.
KNOWS := $(call obj,sw/engine/common/install.c)
ifeq ($(LIBDIR),/usr/local/lib)
AT := $(BUILD)
else
AT := $(BUILD)/at$(call NAMED,$(LIBDIR))
AT_O := $(AT)/install.o $(filter-out $(KNOWS),$(LIB_O))

$(AT)/install.o: sw/engine/common/install.c sw/engine/common/install.h $(BUILD)/flags | $(BUILD)/ready
	@mkdir -p $(@D)
	@echo "  CC   $< ($(LIBDIR))"
	@$(CCACHE) $(CC_FOR) $(CFLAGS) -DFP3_INSTALL_RTL_DIR='"$(LIBDIR)/fp3"' $(INCLUDES) -c -o $@ $<

$(AT)/lib/libfp3.a: $(AT_O)
$(AT)/lib/libfp3_lab.a: $(AT_O) $(call obj,$(LAB_C))
$(AT)/lib/libfp3.a $(AT)/lib/libfp3_lab.a:
	$(archive)

$(AT)/lib/$(notdir $(LIB_SO)): $(AT_O) $(EXPORTS)
	$(link_library)

$(AT)/bin/fp3: $(call obj,$(CLI_C)) $(MEASURE_LIB) $(AT)/lib/libfp3_lab.a
	$(link_command)
endif
AT_LIB := $(patsubst $(BUILD)/%,$(AT)/%,$(LIB) $(LAB) $(LIB_SO))

$(BUILD)/fp3.1: tools/manpage.py $(BUILD)/bin/fp3
	@$(PYTHON) $^ >$@.new && mv $@.new $@

$(BUILD)/completion.%: tools/completion.py tools/manpage.py $(BUILD)/bin/fp3
	@$(PYTHON) $< $* $(BUILD)/bin/fp3 >$@.new && mv $@.new $@

# What is installed is what the tests ran, asserts included: a contradiction within FP3 ends a program instead of
# giving it a wrong number.
INSTALLED := $(AT_LIB) $(AT)/bin/fp3 $(BUILD)/fp3.1 $(BUILD)/completion.bash $(BUILD)/completion.zsh

# The loader looks below /usr/lib and /lib by itself. Elsewhere a program has to carry the place.
RPATH = $(if $(filter /usr/lib% /lib%,$(LIBDIR)),, -Wl$(comma)-rpath$(comma)$${libdir})
comma := ,

define FP3_PC
prefix=$(PREFIX)
includedir=$${prefix}/include
libdir=$(patsubst $(PREFIX)/%,$${prefix}/%,$(LIBDIR))

Name: fp3
Description: Integrates equations of motion on FP3, the field-programmable physics processor
Version: $(VERSION)
Cflags: -I$${includedir}
Libs: -L$${libdir}$(RPATH) -lfp3
Requires.private: libconfig zlib
Libs.private: -lm
endef

# All of libfp3, and the truth and the tuner, which need GSL: a program links one of the two. Only static.
define FP3_LAB_PC
prefix=$(PREFIX)
includedir=$${prefix}/include
libdir=$(patsubst $(PREFIX)/%,$${prefix}/%,$(LIBDIR))

Name: fp3_lab
Description: FP3, and what measures its error against the truth
Version: $(VERSION)
Requires: gsl libconfig zlib
Cflags: -I$${includedir}
Libs: -L$${libdir} -lfp3_lab -lm
endef

.PHONY: install uninstall
install: export FP3_PC := $(FP3_PC)
install: export FP3_LAB_PC := $(FP3_LAB_PC)
install: $(INSTALLED) $(HARDWARE) $(HDF5) $(MPI) ## Install library, headers, command with man page and completion, driver; PREFIX=/usr/local, DESTDIR=
	@install -d $(INCDIR) $(RTL_DIR) $(DESTDIR)$(LIBDIR)/pkgconfig $(dir $(MAN)) $(dir $(BASH)) $(dir $(ZSH)) $(dir $(COMMAND)) $(BARE)/gen $(BARE)/fp3
	@install -m 644 sw/include/fp3/*.h $(INCDIR)
	@install -m 644 $(AT_LIB) $(DESTDIR)$(LIBDIR)
	@ln -sf $(notdir $(LIB_SO)) $(DESTDIR)$(LIBDIR)/libfp3.so
	@install -m 644 $(HARDWARE) $(HDF5) $(MPI) $(RTL_DIR)
	@echo "$$FP3_PC" >$(AT)/fp3.pc
	@echo "$$FP3_LAB_PC" >$(AT)/fp3_lab.pc
	@install -m 644 $(AT)/fp3.pc $(AT)/fp3_lab.pc $(DESTDIR)$(LIBDIR)/pkgconfig
	@install -m 644 $(BUILD)/fp3.1 $(MAN)
	@install -m 644 $(BUILD)/completion.bash $(BASH)
	@install -m 644 $(BUILD)/completion.zsh $(ZSH)
	@install $(AT)/bin/fp3 $(COMMAND)
	@install -m 644 sw/bare/*.c sw/bare/*.h $(BARE)
	@install -m 644 sw/gen/registers.h $(BARE)/gen
	@install -m 644 sw/include/fp3/status.h sw/include/fp3/image.h sw/include/fp3/isa.h $(BARE)/fp3

# Directories that other programs share stay.
uninstall: ## Remove what install put there
	@rm -rf $(INCDIR) $(RTL_DIR) $(dir $(BARE))
	@rm -f $(DESTDIR)$(LIBDIR)/libfp3.a $(DESTDIR)$(LIBDIR)/libfp3_lab.a $(DESTDIR)$(LIBDIR)/libfp3.so $(DESTDIR)$(LIBDIR)/$(notdir $(LIB_SO)) \
	    $(DESTDIR)$(LIBDIR)/pkgconfig/fp3.pc $(DESTDIR)$(LIBDIR)/pkgconfig/fp3_lab.pc $(MAN) $(BASH) $(ZSH) $(COMMAND)

# ---- within a Python package: setup.py ----------------------------------------------------------

# The library, what it loads and the command, as they lie below $(PREFIX), so that they find each other.
.PHONY: python-native
python-native: $(LIB_SO) $(BUILD)/bin/fp3 $(HARDWARE) $(HDF5)
	@$(if $(NATIVE),,echo "python-native: NATIVE names the directory; pip install . calls this" >&2; exit 1)
	@install -d $(NATIVE)/bin $(NATIVE)/lib/fp3
	@install -m 644 $(LIB_SO) $(NATIVE)/lib
	@install -m 644 $(HARDWARE) $(HDF5) $(NATIVE)/lib/fp3
	@install -s $(BUILD)/bin/fp3 $(NATIVE)/bin

# ---- packages -----------------------------------------------------------------------------------

.PHONY: packages
packages: need-packages ## Debian packages, a Python wheel and its sources: build/packages/
	@+$(MAKE) -s $(INSTALLED) $(HARDWARE) $(HDF5)
	@PYTHON=$(PYTHON) tools/packages.sh $(BUILD)/packages
