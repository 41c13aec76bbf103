# almesh: `make help` lists the targets.
CXX       ?= g++
CXXFLAGS  ?= -O3 -march=native
BUILD     ?= build
WARNINGS  := -Wall -Wextra -Wpedantic -Wshadow -Werror

# OpenMP where the compiler has it; without it the program builds and runs serially.
OPENMP    := $(shell echo 'int main() { return omp_get_max_threads() < 1; }' | \
               $(CXX) -fopenmp -include omp.h -x c++ - -o /dev/null 2>/dev/null && echo -fopenmp)
NO_OPENMP := $(if $(OPENMP),,-Wno-unknown-pragmas)
VERSION   := 0.1.0
COMMIT    := $(shell git describe --always --dirty --exclude '*' 2>/dev/null || echo unknown)

FLAGS     := -std=c++20 $(CXXFLAGS) $(OPENMP) $(WARNINGS) $(NO_OPENMP) -Isrc -Itests
SOURCES   := $(shell find src -name '*.cpp' | sort)
OBJECTS   := $(SOURCES:%.cpp=$(BUILD)/%.o)
LIBRARY   := $(filter-out $(BUILD)/src/main.o,$(OBJECTS))
TESTS     := $(shell find tests -name '*.cpp' | sort)
TEST_OBJECTS := $(TESTS:%.cpp=$(BUILD)/%.o)

.DEFAULT_GOAL := all
.PHONY: all run help test asan clean FORCE

all: almesh ## build the program ./almesh

almesh: $(BUILD)/almesh
	cp $< $@

$(BUILD)/almesh: $(OBJECTS)
	$(CXX) $(FLAGS) $^ -o $@

$(BUILD)/%.o: %.cpp $(BUILD)/flags
	@mkdir -p $(@D)
	$(CXX) $(FLAGS) -MMD -MP -c $< -o $@

# Only this file knows the commit; it is rebuilt when that changes.
$(BUILD)/src/app/version.o: FLAGS += -DALMESH_VERSION='"$(VERSION)"' -DALMESH_COMMIT='"$(COMMIT)"' -DALMESH_FLAGS='"$(CXXFLAGS) $(OPENMP)"'
$(BUILD)/src/app/version.o: $(BUILD)/commit
$(BUILD)/commit: FORCE
	@mkdir -p $(BUILD)
	@echo '$(COMMIT)' | cmp -s - $@ || echo '$(COMMIT)' > $@

# Everything is rebuilt when the compiler or its flags change.
$(BUILD)/flags: FORCE
	@mkdir -p $(BUILD)
	@echo '$(CXX) $(FLAGS)' | cmp -s - $@ || echo '$(CXX) $(FLAGS)' > $@

run: almesh ## move the circle of section 4.1 and print its table
	./almesh inputs/circle.deck

test: doctest almesh $(BUILD)/tests ## run every test (installs doctest where it is missing)
	$(BUILD)/tests

$(BUILD)/tests: $(TEST_OBJECTS) $(LIBRARY)
	$(CXX) $(FLAGS) $^ -o $@

clean: ## remove what was built
	rm -rf build build-* almesh

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

-include $(OBJECTS:.o=.d) $(TEST_OBJECTS:.o=.d)
