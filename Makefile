# almesh: `make help` lists the targets that one needs first, `make help-all` the others too.
CXX       ?= g++
# PORTABLE=1: for every processor of that level, in a build of its own; on one processor both have the same bits.
BASELINE  ?= $(if $(filter x86_64,$(shell uname -m)),-march=x86-64-v2)
ifdef PORTABLE
CXXFLAGS  := -O3 $(BASELINE)
BUILD     := build-portable
endif
CXXFLAGS  ?= -O3 -march=native
BUILD     ?= build
# A student's export has the library, the program and the checks in build/, with the flags that they were built with in
# the file `prebuilt` (tests/lessons/student.py). Where they run they are not built; without that file all is.
PREBUILT  := $(if $(wildcard $(BUILD)/prebuilt),$(shell $(BUILD)/almesh --version >/dev/null 2>&1 && cat $(BUILD)/prebuilt))
ifneq ($(PREBUILT),)
CXXFLAGS  := $(PREBUILT)
endif
WARNINGS  := -Wall -Wextra -Wpedantic -Wshadow

# OpenMP where the compiler has it; without it the program builds and runs serially.
OPENMP    := $(shell echo 'int main() { return omp_get_max_threads() < 1; }' | \
               $(CXX) -fopenmp -include omp.h -x c++ - -o /dev/null 2>/dev/null && echo -fopenmp)
# g++'s OpenMP library goes into the program, so that it reads the environment after src/main.cpp has set it; where there
# is no such archive, the program waits as the library does by default.
GOMP      := $(if $(findstring clang,$(shell $(CXX) --version 2>/dev/null)),,$(if $(OPENMP),$(shell \
               echo 'int main() { return omp_get_max_threads() < 1; }' | $(CXX) -fopenmp -include omp.h -x c++ - \
               -o /dev/null -l:libgomp.a 2>/dev/null && echo -l:libgomp.a -Wl,--as-needed)))
NO_OPENMP := $(if $(OPENMP),,-Wno-unknown-pragmas)
VERSION   := 0.2.0
# Of a tarball (make dist) the file COMMIT has it.
COMMIT    := $(shell cat COMMIT 2>/dev/null || git describe --always --dirty --exclude '*' 2>/dev/null || echo unknown)

# Without errno a square root is one instruction, for all lanes of a register at once. A product and a sum are rounded
# apart, for the same bits with every compiler and processor; that costs some 5 % of the time.
# The same objects are in the program and in the shared library, which shows the functions of almesh.h alone.
FLAGS     := -std=c++20 -fno-math-errno -ffp-contract=off -fPIC -fvisibility=hidden $(CXXFLAGS) $(OPENMP) $(WARNINGS) $(WERROR) $(NO_OPENMP) -Isrc -Itests
SOURCES   := $(shell find src -name '*.cpp' -not -path 'src/lessons/*' -not -path 'src/examples/*' | sort)
OBJECTS   := $(SOURCES:%.cpp=$(BUILD)/%.o)
# Programs wait for what computes, and all else takes little time in a run: it needs little optimisation. Of an inline
# function that is not inlined the linker takes the first object's: an optimised one.
HOT       := linalg/% energy/% geometry/% check/certificate.o problem/corner_smoothing.o \
             $(addprefix constraint/,dirichlet.o sliding%.o surface.o quadric.o mesh_surface.o height_patch.o) \
             $(addprefix method/,newton.o line_search.o local_%.o lbfgs.o)
COMPUTING := $(filter $(addprefix $(BUILD)/src/,$(HOT)),$(OBJECTS))
WAITING   := $(filter-out $(COMPUTING),$(OBJECTS))
LIBRARY   := $(filter-out $(BUILD)/src/main.o,$(COMPUTING) $(WAITING))
ifneq ($(PREBUILT),)
COMPUTING :=
WAITING   :=
LIBRARY   :=
endif
TESTS     := $(shell find tests -name '*.cpp' -not -path 'tests/bench/*' -not -path 'tests/lessons/*' \
               -not -name libfuzzer.cpp | sort)
# The tests of a room are compiled together, each file in a namespace of its own behind what all of them include: that
# takes half the time that it takes file by file. JOINED=no: each by itself, for the loop of an edit.
JOINED    ?= yes
TOGETHER  := $(if $(filter yes,$(JOINED)),$(shell find tests -mindepth 2 -name '*_test.cpp' | sort))
ROOMS     := $(sort $(foreach test,$(TOGETHER),$(word 2,$(subst /, ,$(test)))))
UNITS     := $(ROOMS:%=$(BUILD)/tests/rooms/%.cpp)
TEST_OBJECTS := $(patsubst %.cpp,$(BUILD)/%.o,$(filter-out $(TOGETHER),$(TESTS))) $(UNITS:.cpp=.o) \
               $(BUILD)/tests/library/c_client.o
# The comparison is a program of its own, the only one that needs CHOLMOD.
COMPARISON := $(BUILD)/tests/bench/compare_cholmod.o
BENCH     := $(shell find tests -path 'tests/bench/*.cpp' -not -name compare_cholmod.cpp | sort)
BENCH_OBJECTS := $(BENCH:%.cpp=$(BUILD)/%.o)
# The course: a program for each lesson that is code, and its exercises, checked with the answers of the templates
# (src/lessons/exercises/, where students write) or with the solutions.
LESSON_PROGRAMS := $(patsubst src/%.cpp,$(BUILD)/%,$(wildcard src/lessons/*.cpp))
EXAMPLES  := $(patsubst src/%.cpp,$(BUILD)/%,$(wildcard src/examples/*.cpp)) $(BUILD)/examples/shapes
CHECKED   := $(sort $(patsubst tests/lessons/%_check.cpp,%,$(wildcard tests/lessons/*_check.cpp)))
SOLVED    := $(patsubst src/lessons/solutions/%.cpp,$(BUILD)/lessons/solved-%,$(wildcard src/lessons/solutions/*.cpp))
JUDGE     := $(BUILD)/tests/lessons/exercise.o $(BUILD)/tests/lessons/child.o $(BUILD)/libalmesh.a
CHECKS    := $(CHECKED:%=$(BUILD)/tests/lessons/%_check.o) $(CHECKED:%=$(BUILD)/tests/lessons/%_registry.o) $(JUDGE) \
             $(BUILD)/src/lessons/own/almesh.o $(BUILD)/src/lessons/own/rehearsal.o
RUNS      := $(sort $(shell find inputs -name '*.deck' -not -path 'inputs/lessons/*'))
# Only `make fuzz` has libFuzzer's entry; the harnesses are in the tests too.
FUZZ      := $(filter-out tests/fuzz/%_test.cpp,$(wildcard tests/fuzz/*.cpp)) tests/support/meshes.cpp
FUZZ_OBJECTS := $(FUZZ:%.cpp=$(BUILD)/%.o)
LESSON_OBJECTS := $(patsubst %.cpp,$(BUILD)/%.o,$(shell find src/lessons src/examples tests/lessons -name '*.cpp'))

# Threads that wait soon sleep: spinning ones are slow on a machine with other work to do (src/main.cpp).
ifndef OMP_WAIT_POLICY
export OMP_WAIT_POLICY := passive
export GOMP_SPINCOUNT ?= 1000
endif
# Compile on all cores; a make started by this one shares them.
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || sysctl -n hw.ncpu 2>/dev/null || echo 2)
endif

PYTHON    ?= $(firstword $(foreach p,python3 /usr/bin/python3,$(shell $(p) -c 'import numpy, matplotlib' 2>/dev/null && echo $(p))) python3)

# A line for each step; V=1 shows the commands.
Q         := $(if $(V),,@)
said       = $(if $(V),,@printf '%-5s %s\n' '$(1)' '$(2)')

.DEFAULT_GOAL := all
.PHONY: all quick run-quick-tests oracle run help test test-page page wasm test-wasm run-tests run-oracle run-patch patch long-tests \
        doctest python numpy asan fuzz bench compare compare-cholmod compare-gmsh compare-improve \
        cad-models cad-examples cholmod paper gauntlet generated untangle improve slurm certificates defaults \
        derivatives drift coupling calculix judges run-fast-tests run-fast-app-tests run-fast-other-tests matrix \
        reproduce lib wheel install uninstall dist test-install run-python doors proofs run-proofs mutants check-targets figures meshes lessons readmes check-lessons slides student student-export with-solutions wrong-answers animation \
        quality clean examples help-all FORCE

all: almesh ## build the program ./almesh

almesh: $(BUILD)/almesh
	@cp $< $@.new && mv -f $@.new $@

$(BUILD)/almesh: $(COMPUTING) $(WAITING)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ $(GOMP) -o $@

# Warnings are kept beside the object, for `make test`, which takes them for errors.
define compile
	@mkdir -p $(@D)
	$(call said,CXX,$<)
	$(Q)$(CXX) $(FLAGS) $(OWN_FLAGS) -MMD -MP -c $< -o $@ 2> $@.log; code=$$?; cat $@.log >&2; exit $$code
endef
$(BUILD)/%.o: %.cpp $(BUILD)/flags
	$(compile)
$(BUILD)/tests/rooms/%.o: $(BUILD)/tests/rooms/%.cpp $(BUILD)/flags
	$(compile)
$(BUILD)/%.o: %.c src/almesh.h
	@mkdir -p $(@D)
	$(call said,CC,$<)
	$(Q)$(CC) -std=c99 -Wall -Wextra -pedantic -Werror -O1 -Isrc -Itests -c $< -o $@
$(UNITS): $(BUILD)/tests/rooms/%.cpp: FORCE
	@mkdir -p $(@D)
	@{ grep -h '^#include' $(filter tests/$*/%,$(TOGETHER)) | sort -u; for test in $(filter tests/$*/%,$(TOGETHER)); do \
	  printf 'namespace %s {\n#include "%s"\n}\n' "$$(basename $$test .cpp)" $$test; done; } > $@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

# Tests wait for the library too, and so does the course. What most files include of other people's headers is read
# once, but with ccache, which keeps nothing of what was compiled so. Most tests run for less time than it takes to
# optimise them; those of check/ take many samples.
LITTLE    := $(if $(filter -O2 -O3,$(CXXFLAGS)),-O1)
OF_TESTS  := $(LITTLE:-O1=-O0) -DDOCTEST_CONFIG_SUPER_FAST_ASSERTS
# not main.cpp of the tests, which includes more of doctest, nor the harnesses, which `make fuzz` links without doctest
PREFIXED  := $(filter-out $(BUILD)/tests/main.o $(FUZZ_OBJECTS),$(TEST_OBJECTS))
SAMPLING  := $(filter $(BUILD)/tests/rooms/check.o $(BUILD)/tests/check/%,$(TEST_OBJECTS))
READ_ONCE := $(if $(findstring ccache,$(CXX))$(PREBUILT),,$(BUILD)/prefix)
$(WAITING) $(LESSON_OBJECTS): OWN_FLAGS = $(LITTLE) $(READ_ONCE:%=-include %/waiting.hpp)
$(COMPUTING) $(BENCH_OBJECTS): OWN_FLAGS = $(READ_ONCE:%=-include %/computing.hpp)
$(TEST_OBJECTS): OWN_FLAGS = $(OF_TESTS)
$(PREFIXED): OWN_FLAGS = $(OF_TESTS) -iquote . $(READ_ONCE:%=-include %/tests.hpp)
$(SAMPLING): OWN_FLAGS = $(OF_TESTS) $(LITTLE) -iquote . $(READ_ONCE:%=-include %/waiting.hpp)
$(WAITING) $(LESSON_OBJECTS) $(SAMPLING): $(READ_ONCE:%=%/waiting.hpp.gch)
$(COMPUTING) $(BENCH_OBJECTS): $(READ_ONCE:%=%/computing.hpp.gch)
$(PREFIXED): $(READ_ONCE:%=%/tests.hpp.gch)
$(BUILD)/prefix/waiting.hpp.gch: OF_PREFIX = $(LITTLE)
$(BUILD)/prefix/tests.hpp.gch: OF_PREFIX = $(OF_TESTS) -include doctest/doctest.h
$(BUILD)/prefix/%.hpp.gch: tests/support/prefix.hpp $(BUILD)/flags
	@mkdir -p $(@D) && cp $< $(@:.gch=)
	$(call said,CXX,$@)
	$(Q)$(CXX) $(FLAGS) $(OF_PREFIX) -x c++-header $< -o $@

# Only this file knows the commit; it is rebuilt when that changes.
$(BUILD)/src/base/version.o: OWN_FLAGS += -DALMESH_VERSION='"$(VERSION)"' -DALMESH_COMMIT='"$(COMMIT)"' -DALMESH_FLAGS='"$(CXXFLAGS) $(OPENMP)"'
$(BUILD)/src/base/version.o: $(BUILD)/commit
$(BUILD)/commit: FORCE
	@mkdir -p $(BUILD)
	@echo '$(COMMIT)' | cmp -s - $@ || echo '$(COMMIT)' > $@

# Everything is rebuilt when the compiler or its flags change.
$(BUILD)/flags: FORCE
	@mkdir -p $(BUILD)
	@echo '$(CXX) $(FLAGS)' | cmp -s - $@ || echo '$(CXX) $(FLAGS)' > $@

run: almesh ## move the circle of section 4.1 and print its table
	./almesh inputs/circle.deck

test: doctest python numpy ## build with warnings as errors and run the tests (LONG=1: the long ones too; installs doctest)
	tests/mutants/mutants.py --check
	$(MAKE) $(if $(LONG),long-tests) run-fast-tests run-python run-oracle run-patch run-proofs lessons \
	  $(BUILD)/almesh-bench
	@! find $(BUILD) -name '*.o.log' -size +0 | grep . || { echo 'the compiler warned: see these files'; exit 1; }
	@tests/house.py

# For the loop of an edit, a build of its own with little optimisation. The tests whose paths contain a word of ONLY run,
# or else the fast ones: all but those of app/ and problem/ and some that take seconds.
QUICK_FLAGS := -O1 -march=native
CCACHE     = $(if $(findstring ccache,$(CXX)),,$(shell command -v ccache >/dev/null && echo ccache))
QUICK_OUT  = *both assemblies agree*,random steps of curved*,240 random*,fuzzing*,the same bits*,$\
             large graphs*,*killed at some*
quick: doctest ## after an edit: build with -O1 and run the fast tests, or those of some files (ONLY="newton polish")
	$(MAKE) BUILD=build-quick CXX='$(strip $(CCACHE) $(CXX))' CXXFLAGS='$(QUICK_FLAGS)' WERROR=-Werror JOINED=no run-quick-tests
run-quick-tests: $(BUILD)/almesh-tests
	$(BUILD)/almesh-tests $(if $(ONLY),-sf="$$(printf '*tests/*%s*,' $(notdir $(basename $(ONLY))))", \
	  -tse=long -tce='$(QUICK_OUT)' -sfe='*tests/app/*,*tests/problem/*')

oracle: almesh numpy ##check look for false sentences: what runs say against what their meshes are (DECKS="circle crack"; numpy)
	tests/oracle/self_test.py
	tests/oracle/run.py $(DECKS)

mutants: doctest python ##check plant errors in the source, one at a time, and list those that no test notices (ONLY='words')
	CXX='$(CXX)' tests/mutants/mutants.py $(ONLY)

# Without the long tests: minutes become hours.
asan: doctest ##check run the tests, but for those of large decks, under the address and undefined-behaviour sanitizers
	$(MAKE) BUILD=build-asan WERROR=-Werror CXXFLAGS='-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all' \
	  run-fast-tests

# Without OpenMP: what one thread does can be repeated to the last bit.
FUZZ_FLAGS := -O1 -g -march=native -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize-recover=all
MINUTES   ?= 1
FUZZ_CXX  ?= clang++
fuzz: ##check feed random input to readers and runs, a minute each (MINUTES=12, HARNESSES="msh run"; clang++)
	$(MAKE) BUILD=build-fuzz CXX='$(FUZZ_CXX)' OPENMP= WERROR=-Werror CXXFLAGS='$(FUZZ_FLAGS)' build-fuzz/almesh-fuzz
	tests/fuzz/fuzz.sh build-fuzz/almesh-fuzz $(MINUTES) $(HARNESSES)

$(BUILD)/almesh-fuzz: $(FUZZ_OBJECTS) $(LIBRARY)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) -fsanitize=fuzzer $^ -o $@

# Tests, and decks against their reference, with all compilers; reproduce: all decks with the program as built here.
matrix: doctest python ##check build and test with all compilers and libraries that are here: a table (QUICK=1, ONLY=libc++)
	tests/matrix.py $(if $(QUICK),--quick) $(ONLY)

reproduce: almesh python ##check run every deck and compare with tests/reference: a table (QUICK=1: those of seconds; THREADS=1,2,3)
	tests/reproduce.py $(if $(QUICK),--quick) $(if $(THREADS),--threads $(THREADS))

# The fast ones in two parts at a time. UNDER: what runs the program, where that is an emulator.
run-tests: run-fast-tests long-tests
long-tests: $(BUILD)/almesh-tests ##check the tests of many seconds: large decks and CAD, bits with more threads, few steps and iterations
	$(UNDER) $(BUILD)/almesh-tests -ts=long
run-oracle: $(BUILD)/almesh
	tests/oracle/self_test.py
	tests/oracle/run.py --program $(BUILD)/almesh --quick
run-patch: $(BUILD)/almesh
	tests/patch.py --program $(BUILD)/almesh --most 60000 inputs/meshes tests/io/data tests/fuzz/seeds
APP_TESTS := *tests/app/*,*tests/deck/*,*tests/problem/*,*tests/report/*
run-fast-tests: run-fast-app-tests run-fast-other-tests
run-fast-app-tests: $(BUILD)/almesh-tests
	$(UNDER) $(BUILD)/almesh-tests -tse=long -sf='$(APP_TESTS)'
run-fast-other-tests: $(BUILD)/almesh-tests
	$(UNDER) $(BUILD)/almesh-tests -tse=long -sfe='$(APP_TESTS)'

# The library first: an inline function that both have is then the library's.
$(BUILD)/almesh-tests: $(LIBRARY) $(TEST_OBJECTS)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ -o $@

bench: almesh $(BUILD)/almesh-bench ##check time kernels and decks: outputs/bench.csv (QUICK=1: the cheap ones)
	$(BUILD)/almesh-bench $(if $(QUICK),quick)

$(BUILD)/almesh-bench: $(BENCH_OBJECTS) $(LIBRARY)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ -o $@

compare-cholmod: cholmod $(BUILD)/almesh-compare-cholmod ##compare the sparse Cholesky factorisation beside SuiteSparse's
	$(BUILD)/almesh-compare-cholmod $(SYSTEMS)

$(BUILD)/almesh-compare-cholmod: $(COMPARISON) $(LIBRARY)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ -lcholmod -ldl -o $@

$(COMPARISON): | cholmod

cholmod:
	@CXX='$(CXX)' .ci/find-cholmod

doctest:
	@CXX='$(CXX)' .ci/install-doctest

python:
	@.ci/install-python

numpy:
	@.ci/install-python numpy

# The library in one file, so that the programs of the course are linked quickly.
$(BUILD)/libalmesh.a: $(LIBRARY)
	@rm -f $@
	$(call said,AR,$@)
	$(Q)$(AR) rcs $@ $^

SONAME    := libalmesh.so.0
SHARED    := $(BUILD)/libalmesh.so.$(VERSION)
lib: $(SHARED) $(BUILD)/libalmesh.a ## build the libraries for C, build/libalmesh.so.*, and C++, libalmesh.a (PORTABLE=1)

$(SHARED): $(LIBRARY)
	$(call said,LINK,$@)
	@echo '{ global: almesh_*; local: *; };' > $(BUILD)/almesh.map
	$(Q)$(CXX) $(FLAGS) -shared -Wl,-soname,$(SONAME) -Wl,--version-script=$(BUILD)/almesh.map -Wl,-z,defs $^ -o $@

wheel: python ## make almesh-VERSION-py3-none-PLATFORM.whl, for Python, of the portable library
	$(MAKE) PORTABLE=1 build-portable/libalmesh.so.$(VERSION)
	packaging/wheel.py build-portable/libalmesh.so.$(VERSION) $(VERSION) .

# The module with numpy and without it.
run-python: $(SHARED)
	$(PYTHON) tests/python.py --library $(SHARED)
	ALMESH_NO_NUMPY=1 $(PYTHON) tests/python.py --library $(SHARED)
doors: $(SHARED) $(BUILD)/almesh python ##check meshes of decks by the module, and so by the C interface, have the bits of the program's
	$(PYTHON) tests/python.py --library $(SHARED) --program $(BUILD)/almesh --bits $(DECKS)

PREFIX    ?= /usr/local
DESTDIR   ?=
TO        := $(DESTDIR)$(PREFIX)
no_blanks  = $(if $(word 2,$(TO)),$(error PREFIX and DESTDIR have no blanks: make would take '$(TO)' for several folders))
CLIENTS   := src/examples/shapes.c src/examples/first.cpp src/examples/circle.cpp src/examples/ring.hpp
INSTALLED := bin/almesh include/almesh.h include/almesh.hpp share/almesh/python/almesh.py lib/libalmesh.a lib/$(notdir $(SHARED)) lib/$(SONAME) \
             lib/libalmesh.so lib/pkgconfig/almesh.pc lib/pkgconfig/almesh-c++.pc share/man/man1/almesh.1 \
             share/bash-completion/completions/almesh $(addprefix share/almesh/examples/,$(notdir $(CLIENTS)) circle.deck circle.msh)

# $(1): a name, what it is and how it is linked.
pc         = printf 'Name: %s\nDescription: %s\nVersion: $(VERSION)\nCflags: -I$(PREFIX)/include\nLibs: %s\n' $(1)
install: $(BUILD)/almesh lib ## install program, libraries, headers, manual, completion and examples (PREFIX=, DESTDIR=, PORTABLE=1)
	$(no_blanks)
	mkdir -p $(addprefix $(TO)/,$(sort $(dir $(INSTALLED))))
	cp $(BUILD)/almesh $(TO)/bin/almesh
	cp src/almesh.h src/almesh.hpp $(TO)/include/
	cp src/almesh.py $(TO)/share/almesh/python/
	cp $(BUILD)/libalmesh.a $(SHARED) $(TO)/lib/
	ln -sf $(notdir $(SHARED)) $(TO)/lib/$(SONAME)
	ln -sf $(SONAME) $(TO)/lib/libalmesh.so
	$(call pc,almesh 'meshes that follow their boundary: C' '-L$(PREFIX)/lib -lalmesh') > $(TO)/lib/pkgconfig/almesh.pc
	$(call pc,almesh-c++ 'meshes that follow their boundary: C++' '$(PREFIX)/lib/libalmesh.a $(OPENMP)') \
	  > $(TO)/lib/pkgconfig/almesh-c++.pc
	packaging/man.sh $(BUILD)/almesh > $(TO)/share/man/man1/almesh.1
	cp packaging/almesh.bash $(TO)/share/bash-completion/completions/almesh
	cp $(CLIENTS) inputs/circle.deck inputs/meshes/circle.msh $(TO)/share/almesh/examples/
	sed -i 's,meshes/,,' $(TO)/share/almesh/examples/circle.deck

uninstall: ## remove just what make install has put there (PREFIX=, DESTDIR=)
	$(no_blanks)
	rm -f $(addprefix $(TO)/,$(INSTALLED))
	-rmdir $(addprefix $(TO)/share/almesh/,examples python .)

# Of what is committed; it builds, and its tests run, without git and without a network.
dist: ##check make almesh-VERSION.tar.gz of what is committed, which builds and tests itself offline
	rm -rf $(BUILD)/almesh-$(VERSION)
	mkdir -p $(BUILD)
	git archive --prefix=almesh-$(VERSION)/ HEAD | tar -x -C $(BUILD)
	git rev-parse --short HEAD > $(BUILD)/almesh-$(VERSION)/COMMIT
	tar -c --sort=name --owner=0 --group=0 --mtime=@$$(git log -1 --format=%ct) -C $(BUILD) almesh-$(VERSION) | gzip -n \
	  > almesh-$(VERSION).tar.gz
	rm -rf $(BUILD)/almesh-$(VERSION)

test-install: python ##check install, use, uninstall: clients for C, C++ and Python use what is installed alone (QEMU=1: on the baseline)
	tests/install.py $(if $(QEMU),--qemu)

.SECONDARY: $(LESSON_OBJECTS) $(SOLVED:=.so)

# The judge of a lesson's answers, and a shared object with the solutions and the table in which it finds them.
$(BUILD)/lessons/solved-%: $(BUILD)/tests/lessons/%_check.o $(JUDGE) | $(BUILD)/lessons/solved-%.so
	@mkdir -p $(@D)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ $(GOMP) -ldl -o $@

$(BUILD)/lessons/solved-%.so: $(BUILD)/src/lessons/solutions/%.o $(BUILD)/tests/lessons/%_registry.o $(BUILD)/libalmesh.a
	@mkdir -p $(@D)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) -shared $^ -o $@

$(BUILD)/tests/lessons/%_registry.o: tests/lessons/registry.cpp tests/lessons/registry.hpp tests/lessons/each.hpp tests/lessons/%_check.cpp src/lessons/exercises/%.hpp $(BUILD)/flags
	@mkdir -p $(@D)
	$(call said,CXX,$@)
	$(Q)$(CXX) $(FLAGS) $(LITTLE) -DHEADER='"lessons/exercises/$*.hpp"' -DNAMES='$(shell tests/lessons/answers.py --names $*)' -c $< -o $@

$(BUILD)/examples/%: $(BUILD)/src/examples/%.o $(BUILD)/libalmesh.a
	@mkdir -p $(@D)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ $(GOMP) -o $@

$(BUILD)/lessons/%: $(BUILD)/src/lessons/%.o $(BUILD)/libalmesh.a
	@mkdir -p $(@D)
	$(call said,LINK,$@)
	$(Q)$(CXX) $(FLAGS) $^ $(GOMP) -o $@

lesson-%: almesh FORCE ## run the commands of a lesson's handout and draw its picture: make lesson-01
	@$(MAKE) --silent $(patsubst src/%.cpp,$(BUILD)/%,$(wildcard src/lessons/$*_*.cpp)) $(if $(filter 05,$*),$(EXAMPLES)) $(if $(filter 08,$*),$(BUILD)/lessons/almesh_in_one_file) $(filter %/solved-$*,$(SOLVED)) $(if $(filter 12,$*),$(CHECKS))
	@tests/documents.py --show --build $(BUILD) $*
	@if $(PYTHON) -c 'import numpy, matplotlib' 2>/dev/null; then $(PYTHON) $(wildcard plot/lessons/$*_*.py); else \
	  echo 'no picture without numpy and matplotlib: apt-get install python3-numpy python3-matplotlib (or pip)'; fi

check-lesson-%: FORCE ## check your answers to exercises: make check-lesson-01 (SHOW=2: what your answer to 1.2 prints)
	@$(MAKE) --silent $(filter %/$*_check.o %/$*_registry.o,$(CHECKS)) $(JUDGE)
	@tests/lessons/answers.py --build $(BUILD) --lesson $* $(SHOW:%=--show %) $(or $(ANSWERS),exercises)

watch-%: FORCE ## check a lesson's answers at each save, and say what is next: make watch-04
	@$(MAKE) --silent $(filter %/$*_check.o %/$*_registry.o,$(CHECKS)) $(JUDGE)
	@tests/lessons/answers.py --build $(BUILD) --lesson $* --watch

hint-%: ## a hint for an exercise, here 4.2: make hint-04-2 (MORE=1: nearly the answer)
	@tests/lessons/hints.py $* $(if $(MORE),--more)

own-almesh: $(CHECKS) FORCE ##course link your answers into a solver and run the paper's circle (BORROW="solver trace": parts of almesh)
	@tests/lessons/own.py --build $(BUILD) $(if $(BORROW),--borrow '$(BORROW)') $(if $(UNCHECKED),--unchecked) \
	  $(or $(ANSWERS),exercises) $(if $(RUN),--run $(RUN))
	@if $(PYTHON) -c 'import numpy, matplotlib' 2>/dev/null; then $(PYTHON) plot/lessons/own_almesh.py; else \
	  echo 'no picture without numpy and matplotlib: apt-get install python3-numpy python3-matplotlib (or pip)'; fi

examples: $(EXAMPLES) ## build the programs that use the library, src/examples/

slides: ##course slides of all lessons as HTML and PDF, outputs/slides/ (pandoc, chromium)
	plot/lessons/slides.py

student: with-solutions ##course export the course without solutions, with the library, as a folder that stands alone: make student TO=../course
	@$(MAKE) --silent PORTABLE=1 student-export

student-export: $(CHECKS) $(BUILD)/almesh
	@tests/lessons/student.py --build $(BUILD) --flags '$(CXXFLAGS)' --parts '$(CHECKS)' $(TO)

ifneq ($(PREBUILT),)
$(filter %.o,$(CHECKS)): | $(BUILD)/flags ;
endif

check-lessons: $(CHECKS) ##course check the answers to all exercises: a table (ANSWERS=solutions)
	@tests/lessons/answers.py --build $(BUILD) $(or $(ANSWERS),exercises)

lessons: with-solutions python $(BUILD)/almesh $(SHARED) $(EXAMPLES) $(LESSON_PROGRAMS) $(SOLVED) $(CHECKS) ##check run the commands of all documents that take seconds; check the solutions of the course
	tests/lessons/answers.py --build $(BUILD) --self-test
	tests/lessons/hints.py --self-test
	tests/lessons/slides.py --self-test
	tests/lessons/slides.py
	tests/lessons/times.py --check
	tests/lessons/student.py --build $(BUILD) --flags '$(CXXFLAGS)' --parts '$(CHECKS)' --self-test
	tests/lessons/wrong.py --build $(BUILD)
	tests/lessons/wrong_grades.py --build $(BUILD)
	tests/lessons/one_file.py --build $(BUILD)
	tests/lessons/wrong_own.py --build $(BUILD)
	tests/documents.py --build $(BUILD) --self-test
	tests/documents.py --build $(BUILD)

with-solutions:
	@test -d src/lessons/solutions || { echo 'this is for the course with solutions; here: make lesson-01, make check-lessons'; exit 1; }

wrong-answers: with-solutions $(CHECKS) $(BUILD)/lessons/almesh_in_one_file ##course try all wrong answers to the exercises and a hundred broken ones: each must be refused
	tests/lessons/wrong.py --build $(BUILD) --all
	tests/lessons/wrong_own.py --build $(BUILD) --all

readmes: almesh lib $(EXAMPLES) python ##check run all commands of README.md and */*.md, also those of minutes, and compare (ONLY=plot/README.md)
	tests/documents.py --build $(BUILD) --slow $(or $(ONLY),README.md */*.md)

paper: almesh ## run the paper's decks and compare with its tables: outputs/paper/tables.md
	@decks=$$($(PYTHON) plot/paper_tables.py --decks) && for deck in $$decks; do \
	  ./almesh inputs/$$deck.deck; code=$$?; echo; \
	  if [ $$code -ne 0 ]; then \
	    echo "make paper: inputs/$$deck.deck ended with exit code $$code"; exit 1; fi; \
	done
	$(PYTHON) plot/paper_tables.py

gauntlet: almesh ##compare the decks of large motions, inputs/gauntlet/: a table
	@for deck in inputs/gauntlet/*.deck; do ./almesh $$deck vtk=none; echo; done
	$(PYTHON) plot/gauntlet.py

slurm: almesh python ##check run a sweep as a job array of Slurm, with a job that is killed (root; slurm-wlm)
	$(PYTHON) tests/slurm.py --program ./almesh

certificates: $(BUILD)/almesh-tests ##check the certificate beside dense samples of ten thousand elements of each type and degree (ELEMENTS=100000)
	ALMESH_ELEMENTS=$(or $(ELEMENTS),10000) $(BUILD)/almesh-tests -sf='*certificate_samples_test.cpp'

proofs: almesh $(BUILD)/almesh-tests python ##check proofs: of all cells and degrees, false ones, decks (DECKS="inputs/circle.deck") and meshes (MESHES="outputs/*/final.msh")
	tests/proofs.py $(or $(MESHES),$(wildcard inputs/meshes/*.msh)) --program ./almesh --tests $(BUILD)/almesh-tests \
	  $(if $(QUICK),--quick) --decks $(or $(DECKS),$(if $(QUICK),inputs/circle.deck inputs/cells/kinds-2.deck,$(RUNS))) \
	  --improve $(if $(QUICK),inputs/meshes/square.msh,$(wildcard inputs/meshes/*.msh))
run-proofs: $(BUILD)/almesh $(BUILD)/almesh-tests python
	tests/proofs.py --program $(BUILD)/almesh --tests $(BUILD)/almesh-tests --quick

untangle: almesh ##check improve some 200 generated meshes with inverted elements (ONLY="tri-random hole")
	$(PYTHON) tests/untangle.py $(ONLY)

improve: almesh ##check improve all meshes in inputs/ and some by gmsh: none may become worse (ONLY="gmsh cube"; python3-gmsh)
	$(PYTHON) tests/improve.py $(ONLY)

records: almesh ##check improve the meshes of a folder, measured by a script that shares nothing (MESHES=folder; SECONDS=N; CORNERS=1; scipy)
	$(PYTHON) tests/records.py $(if $(SECONDS),--seconds $(SECONDS)) $(if $(CORNERS),--corners) $(MESHES)

patch: almesh python ##check meshes of a folder come back the same byte by byte, and moved with other coordinates alone (MESHES=folder)
	tests/patch.py $(or $(MESHES),inputs tests/io/data tests/fuzz/seeds)

judges: almesh ##check VTK's readers, gmsh and meshio find files the same but for the nodes (python3-vtk9, python3-gmsh, python3-meshio)
	$(PYTHON) tests/judges.py $(ONLY)

generated: almesh python ##check run a hundred generated cases, twisted, bent, squeezed: a table (ONLY=17,23)
	$(PYTHON) tests/generated.py --almesh ./almesh $(if $(ONLY),--only $(ONLY))

compare-gmsh: almesh ##compare curved CAD meshes repaired, beside gmsh's optimisers (python3-gmsh, numpy; ONLY=torus)
	$(PYTHON) plot/compare_gmsh.py $(ONLY)

compare-improve: almesh ##compare bad meshes improved, beside gmsh, Netgen, tetgen and others (QUICK=1; python3-gmsh, scipy)
	$(PYTHON) plot/compare_improve.py $(if $(QUICK),--quick)

cad-models: almesh ##compare the CAD models of a folder meshed and curved, beside gmsh (MODELS=folder; python3-gmsh)
	$(PYTHON) plot/cad_models.py $(MODELS)

cad-examples: almesh ##compare the same for models that OpenCASCADE and gmsh ship (ONLY=component8; occt-misc, gmsh-doc)
	$(PYTHON) plot/cad_models.py $(wildcard /usr/share/opencascade/data/*/*.brep /usr/share/opencascade/data/*/*.step \
	  /usr/share/doc/gmsh-doc/doc/gmsh/demos/*/*.st*p.gz) --edges 12 --turn 0 --output cad-examples $(ONLY:%=--only %)

# Each says so where its program is not installed. dolfinx is there for Debian's Python alone.
coupling: almesh lib ##compare meshes moved for dolfinx, VTK, CalculiX and OpenFOAM, those that are installed
	@for client in heat sinking shape grid calculix openfoam piston; do \
	  python=$$(for p in $(PYTHON) /usr/bin/python3; do $$p -c 'import dolfinx' 2>/dev/null && echo $$p && break; done); \
	  $${python:-$(PYTHON)} plot/coupling/$$client.py || exit 1; echo; done

calculix: almesh ##compare CAD parts that CalculiX refuses, mended, and input files as they come back (calculix-ccx, python3-gmsh; INPUTS=folder)
	$(PYTHON) plot/coupling/calculix_parts.py $(ONLY)
	$(PYTHON) plot/coupling/calculix_decks.py $(INPUTS)

drift: almesh $(BUILD)/examples/comparators ##compare ten periods of a moving plate, beside elasticity and radial basis functions (scipy)
	$(PYTHON) plot/drift.py

derivatives: almesh ##compare derivatives of the moved mesh beside differences of runs (ONLY=circle)
	$(PYTHON) plot/derivatives.py $(ONLY)

defaults: almesh ##compare the table behind the defaults of objective and weight_exponent (ONLY=grown)
	$(PYTHON) plot/defaults.py $(ONLY)

page: almesh ## run a deck and show its results in a browser: make page DECK=inputs/aircraft.deck (npm)
	$(if $(RESULTS),,./almesh $(DECK) output=outputs/page $$(grep -sq '^ *frames *=' $(DECK) || echo iterates=1); \
	  code=$$?; [ $$code -eq 0 ] || [ $$code -ge 3 ] || exit $$code)
	$(PYTHON) plot/page.py $(or $(RESULTS),outputs/page)
page: DECK ?= inputs/circle.deck

test-page: $(BUILD)/almesh python ##check use pages of results in a headless Chromium, and look for errors (chromium, npm)
	tests/page.py --build $(BUILD)
	tests/lesson_pages.py

# Without threads, with two numbers in a register. An object of clang takes no precompiled header after another include.
WASM      := -O2 -msimd128 -fwasm-exceptions -fno-PIC -include plot/viewer/to_chars.hpp
ENTRIES    = $(shell sed -nE 's/^ALMESH_API [a-z ]*\**(almesh_[a-z_]+).*/_\1,/p' src/almesh.h | tr -d '\n')_page_faces,_malloc
wasm: python ## make outputs/almesh.html: almesh in a browser, in one page that needs nothing else (emscripten, npm)
	@command -v em++ >/dev/null || { echo 'there is no em++ here (Debian: emscripten)'; exit 1; }
	$(MAKE) BUILD=build-wasm CXX=em++ AR=emar OPENMP= READ_ONCE= CXXFLAGS='$(WASM)' build-wasm/almesh.js
	$(PYTHON) plot/app.py build-wasm/almesh.js outputs/almesh.html

$(BUILD)/almesh.js: $(LIBRARY) $(BUILD)/plot/viewer/faces.o
	$(call said,LINK,$@)
	$(Q)NODE_PATH=/usr/share/nodejs $(CXX) -O1 -msimd128 -fwasm-exceptions $^ -o $@ -sMODULARIZE -sEXPORT_NAME=almesh \
	  -sSINGLE_FILE -sALLOW_MEMORY_GROWTH -sMAXIMUM_MEMORY=4GB -sTOTAL_STACK=8MB -sALLOW_TABLE_GROWTH \
	  -sEXPORTED_FUNCTIONS=$(ENTRIES) -sEXPORTED_RUNTIME_METHODS=FS,ccall,addFunction,UTF8ToString

test-wasm: wasm $(BUILD)/almesh ##check use that page in a headless Chromium: the program's meshes, errors, cancel (emscripten, chromium, npm)
	tests/wasm.py --build $(BUILD) outputs/almesh.html

quality: ##compare the quality of elements before and after almesh improve, drawn (RESULTS=outputs/tangled; matplotlib)
	$(PYTHON) plot/quality.py $(RESULTS)

animation: almesh ##compare moving pictures of a run (RESULTS=outputs/frames/pitch: its frames; matplotlib, Pillow)
	$(PYTHON) plot/animation.py $(RESULTS)

compare: almesh $(BUILD)/examples/comparators ##compare other ways to move a mesh beside the augmented Lagrangian method (matplotlib)
	$(PYTHON) plot/compare.py

figures: ##compare the paper's figures beside ours, from outputs/ (numpy, matplotlib; ONLY=fig02): outputs/figures/
	$(PYTHON) plot/figures.py $(ONLY)

meshes: ##compare make the meshes of inputs/meshes again (gmsh 4.8)
	inputs/meshes/generate.sh

check-targets: almesh python ##check run each target of make help-all once, at its smallest size (QUICK=1, ALL=1, TARGETS="bench page")
	+tests/targets.py --python '$(PYTHON)' --logs $(BUILD)/targets $(if $(QUICK),--quick) $(if $(ALL),--all) $(TARGETS)

clean: ## remove what was built
	rm -rf build build-* almesh almesh-*.tar.gz

# A target's line has `##` and what it does; `##check`, `##compare` or `##course` where only help-all lists it.
listed     = grep -hE '^[a-z%-]+:.*\#\#$(1) ' $(MAKEFILE_LIST) | sed -E 's/%/NN/; s/:.*\#\#$(1) /\t/' | expand -t 17

help: ## list these targets, which one needs first
	@$(call listed,)

help-all: help ## list the others too: long checks, comparisons, the rest of the course
	@echo; echo 'Long checks'; $(call listed,check)
	@echo; echo 'Comparisons, pictures and meshes'; $(call listed,compare)
	@echo; echo 'The rest of the course'; $(call listed,course)

-include $(OBJECTS:.o=.d) $(TEST_OBJECTS:.o=.d) $(BENCH_OBJECTS:.o=.d) $(COMPARISON:.o=.d) $(LESSON_OBJECTS:.o=.d) $(FUZZ_OBJECTS:.o=.d)
