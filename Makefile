# What people type; CMakeLists.txt says how it is built. `make help` lists the verbs.

SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build

JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
SEED ?= 1
# Seconds that one test may take.
TIMEOUT ?= 600
# Seconds that each fuzz target runs.
FUZZ_SECONDS ?= 60

CONFIGURE = cmake -S . -G Ninja >/dev/null
# Even a quiet ninja says that it has nothing to do, and CMake that it has looked again.
COMPILE = cmake --build $(1) -j $(JOBS) -- --quiet | { grep -vE '^(ninja: no work to do|-- )' || true; }
CTEST = ctest --test-dir $(1) --output-on-failure --no-tests=error --timeout $(TIMEOUT) -j $(JOBS)

# The verbs share build folders.
.NOTPARALLEL:
.PHONY: build run test check-all bench train train-a3c fuzz asan tsan valgrind tidy checkabi storeabi \
    check-arm64 docs deb check-packages format install clean help

build: build/build.ninja
	@$(call COMPILE,build)

# Tests are left out until they are asked for, so that a build needs no test packages.
build/build.ninja:
	@.ci/setup build
	@echo "building packcell in build/"
	@$(CONFIGURE) -B build -DPACKCELL_TESTS=OFF

build/tests/CTestTestfile.cmake: | build/build.ninja
	@.ci/setup build test bindings
	@$(CONFIGURE) -B build -DPACKCELL_TESTS=ON

run: build
	@mkdir -p out
	@build/bin/packcell-sim --cell ur5e --scenario D-R5A3O1 --rotation on --repack full --count 3 --seed $(SEED) \
	    --out out --episodes out/episodes.jsonl
	@echo
	@echo "to open in a browser: $$(echo out/bin-000[1-3]/replay.html)"

test: build/tests/CTestTestfile.cmake build
	@$(call CTEST,build)

check-all:
	@PACKCELL_CHECK_ALL=1 $(MAKE) --no-print-directory test TIMEOUT=3600
	@$(MAKE) --no-print-directory asan tsan valgrind tidy

bench: build
	@build/bin/packcell-bench random --bins 500 --baseline-bins 50 --seed $(SEED)
	@echo
	@build/bin/packcell-bench full --sets 200 --preset table --seed $(SEED)
	@echo
	@build/bin/packcell-bench repack-time --bins 40 --budgets 10 --seed $(SEED)
	@echo
	@build/bin/packcell-bench selection --sets 100 --seed $(SEED)
	@echo
	@build/bin/packcell-bench bound --bins 50 --seed $(SEED)
	@echo
	@build/bin/packcell-bench offline --sets 10 --seed $(SEED)
	@echo
	@build/bin/packcell-bench large --sets 3 --seed $(SEED)

# Assertions are live in the instrumented builds. Their warnings are judged in the plain build alone:
# instrumentation makes GCC guess wrong.
INSTRUMENTED = $(CONFIGURE) -B build/$@ -DCMAKE_BUILD_TYPE=Debug -DPACKCELL_TESTS=ON -DPACKCELL_WERROR=OFF

asan:
	@.ci/setup build test
	@$(INSTRUMENTED) -DPACKCELL_SANITIZE=address
	@$(call COMPILE,build/asan)
	@$(call CTEST,build/asan)

# GCC 12's thread sanitizer does not cope with much address randomisation; setarch -R, where it is
# allowed, turns it off.
tsan:
	@.ci/setup build test
	@$(INSTRUMENTED) -DPACKCELL_SANITIZE=thread
	@$(call COMPILE,build/tsan)
	@$$(setarch -R true 2>/dev/null && echo setarch -R) $(call CTEST,build/tsan)

# The tests that count allocations have an operator new of their own, which valgrind takes for free().
valgrind:
	@.ci/setup build test
	@$(INSTRUMENTED) -DPACKCELL_PROGRAMS=OFF -DCMAKE_CXX_FLAGS_DEBUG="-g -O1" \
	    "-DPACKCELL_TEST_LAUNCHER=valgrind;--quiet;--error-exitcode=99;--leak-check=full;--show-mismatched-frees=no"
	@$(call COMPILE,build/valgrind)
	@$(call CTEST,build/valgrind) --label-regex '^(api|unit)$$'

# The recipes of docs/training.md; both go on where they were stopped. The first takes about a quarter
# of an hour on two cores.
train: build
	@mkdir -p out
	@build/bin/packcell-train --learner afterstate --rotation mixed --seed $(SEED) --updates 60000000 \
	    --every 2000000 --measure-bins 4000 --name default --checkpoint out/default-$(SEED).pkt \
	    --out out/default-$(SEED).pkw --csv out/default-$(SEED).csv --svg out/default-$(SEED).svg

train-a3c: build
	@mkdir -p out
	@build/bin/packcell-train --learner a3c --seed $(SEED) --workers 2 --updates 80000 --gamma 0.95 \
	    --every 1000 --measure-bins 4000 --checkpoint out/a3c-$(SEED).pkt \
	    --out out/a3c-$(SEED).pkw --csv out/a3c-$(SEED).csv --svg out/a3c-$(SEED).svg

# What libFuzzer finds worth keeping stays in build/fuzz/corpus; an input that breaks a rule is left
# in build/fuzz, and the verb fails.
fuzz:
	@.ci/setup build test fuzz
	@CC=clang CXX=clang++ $(INSTRUMENTED) -DPACKCELL_SANITIZE=address -DPACKCELL_LIBFUZZER=ON \
	    -DCMAKE_CXX_FLAGS=-fsanitize=fuzzer-no-link
	@$(call COMPILE,build/fuzz --target fuzz_blob fuzz_gateway fuzz_calls)
	@mkdir -p build/fuzz/corpus/blob build/fuzz/corpus/gateway build/fuzz/corpus/calls
	@cp tests/golden/*.pkw build/fuzz/corpus/blob
	@cd build/fuzz && for target in blob gateway calls; do \
	    tests/fuzz_$$target -max_total_time=$(FUZZ_SECONDS) -print_final_stats=1 corpus/$$target; done

# clang-tidy counts the warnings that it does not show on stderr, where only its failures matter.
tidy: build
	@.ci/setup tidy
	@find src examples -name '*.cpp' -print0 \
	    | xargs -0 -n 1 -P $(JOBS) clang-tidy -p build --quiet 2>build/tidy.log \
	    || { grep -v 'warnings generated' build/tidy.log; exit 1; }

# The interface as the debug information has it; a difference to the stored one is to be a deliberate
# one. `make test` compares too.
checkabi storeabi: build/tests/CTestTestfile.cmake
	@.ci/setup build bindings
	@$(call COMPILE,build --target packcell_abi)
	@tests/abi/check.sh $(if $(filter storeabi,$@),--store) build/lib/abi/libpackcell.so.0 .

# The tests of the library on a processor of another kind, emulated and so some thirty times slower;
# what both machines print is compared.
check-arm64: TIMEOUT = 3600
check-arm64: build/tests/CTestTestfile.cmake
	@.ci/setup build test arm64
	@$(CONFIGURE) -B build/arm64 -DPACKCELL_PROGRAMS=OFF -DPACKCELL_TESTS=ON \
	    --toolchain $(CURDIR)/tests/arm64/toolchain.cmake -DPACKCELL_TEST_LAUNCHER=qemu-aarch64
	@$(call COMPILE,build/arm64)
	@$(call CTEST,build/arm64) --label-regex '^(api|unit)$$'
	@$(call COMPILE,build --target arm64_report)
	@tests/arm64/check.sh build build/arm64

# The API's reference, from the public headers.
docs:
	@.ci/setup docs
	@docs/doxygen_filter.py --check include/packcell.h
	@mkdir -p build/docs
	@doxygen docs/Doxyfile
	@doxygen docs/Doxyfile-cpp
	@echo "build/docs/html/index.html"

# Debian packages; the second verb installs them into a fresh root, which takes root and minutes.
deb:
	@.ci/setup build deb
	@debian/make-packages build/deb $(JOBS)
	@ls build/deb/*.deb

check-packages: deb
	@.ci/setup packages
	@PACKCELL_PACKAGES=build/deb tests/packages/test_packages.sh build .

format:
	@.ci/setup test
	@tests/house/test_format.sh --fix .

# The program loader learns of a new library by ldconfig; a staged tree is not for this machine.
install: build
	@$(CONFIGURE) -B build -DCMAKE_INSTALL_PREFIX=$(PREFIX)
	@$(call COMPILE,build)
	@DESTDIR=$(DESTDIR) cmake --install build >/dev/null
	@if [ -z "$(DESTDIR)" ] && [ "$$(id -u)" = 0 ]; then ldconfig; fi
	@echo "installed under $(DESTDIR)$(PREFIX)"

clean:
	@rm -rf build out

help:
	@echo "make              build the library and the programs in build/"
	@echo "make run          pack bins by the two arms of a cell; replays and drawings in out/ (SEED=$(SEED))"
	@echo "make test         run every test"
	@echo "make check-all    tests with full counts, asan, tsan, valgrind, tidy"
	@echo "make bench        our figures beside the paper's, short counts"
	@echo "make train        train the default policy; policy and curves in out/ (SEED=$(SEED))"
	@echo "make train-a3c    train the paper's network likewise"
	@echo "make fuzz         libFuzzer on weight blobs, gateway and calls, FUZZ_SECONDS=$(FUZZ_SECONDS) each"
	@echo "make asan         tests with the address and undefined-behaviour sanitizers"
	@echo "make tsan         tests with the thread sanitizer"
	@echo "make valgrind     unit and api tests under valgrind"
	@echo "make tidy         clang-tidy over src/ and examples/"
	@echo "make checkabi     compare the library's interface with the stored one"
	@echo "make storeabi     store it anew, after a deliberate change"
	@echo "make check-arm64  cross-build, tests under qemu; plans and networks beside this machine's"
	@echo "make docs         the API's reference in build/docs/html"
	@echo "make deb          Debian packages in build/deb; check-packages installs them in a fresh root"
	@echo "make format       clang-format over all sources"
	@echo "make install      install (PREFIX=$(PREFIX) DESTDIR=)"
	@echo "make clean        remove build/ and out/"
	@echo "JOBS=$(JOBS) sets the number of parallel jobs, TIMEOUT=$(TIMEOUT) the seconds a test may take."
