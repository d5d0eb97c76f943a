# Needs stable Rust, Python 3.10 or later with its venv module, and make. Everything else goes
# into .venv and target.

# A failure anywhere in a pipe is a failure.
SHELL := /bin/bash -o pipefail

VENV := .venv
PYTHON ?= python3
RUST := $(shell find crates -name '*.rs' -path '*/src/*') \
	$(shell find crates -name Cargo.toml) Cargo.toml Cargo.lock
RUSTFMT := rustfmt --edition 2021
RUST_FILES = find $(wildcard crates benches examples firmware) -name '*.rs' -not -path '*/target/*'

PYTHON_CODE := python simulator benches docs examples release

SANITIZED := $(or $(CARGO_TARGET_DIR),target)/sanitized

MADE := $(VENV)/.made
BUILT := $(VENV)/.built
TOOLS := $(VENV)/.tools
MUTANTS := $(VENV)/.mutants

# A stamp without its extension or its command is stale.
ifeq ($(and $(wildcard python/jbf/_core*.so),$(wildcard $(VENV)/bin/jbf)),)
$(shell rm -f $(BUILT))
endif

.PHONY: help venv quick demo docs figures generated test test-extended lint format bench counts bits bits-table fuzz miri sanitize supply faults mutation firmware \
	sbom coverage licences publish-check semver wheel wheel-test reproducible lowest free-threaded clean

help:
	@echo "make demo    the whole story on shipped data, in under a minute"
	@echo "make docs    the site, in target/site/html; every snippet of every page is run"
	@echo "make figures  every picture and generated table of the docs anew, from this commit"
	@echo "make generated  everything generated anew: figures, reference pages, tables, the table of bits"
	@echo "make test    Rust and Python tests: before every pull request"
	@echo "make test-extended  what takes minutes: statistical studies, long simulations, all seeds"
	@echo "make lint    formatting, clippy, ruff, codespell, gitlint, mypy, rustdoc"
	@echo "make format  formats Rust and Python"
	@echo "make bench   criterion benchmarks"
	@echo "make counts  instructions of every step, against benches/counts.txt (valgrind)"
	@echo "make faults  30 deliberate faults, one at a time: which do the fast tests notice?"
	@echo "make mutation  random mutants, a few of each package: which share do the fast tests notice?"
	@echo "make coverage  lines of python/jbf that no fast test runs, file by file (pytest-cov)"
	@echo "make fuzz    fuzzer-generated input to every property of jbf-properties, a minute each or FOR=seconds (nightly, cargo-fuzz)"
	@echo "make miri    a few tests under Rust's own interpreter: no undefined behaviour (nightly)"
	@echo "make sanitize  a C program over every function of jbf.h under ASan and UBSan (gcc or clang)"
	@echo "make supply  licences, sources and known faults of every dependency; the workflows (cargo-deny, pip-audit, zizmor)"
	@echo "make sbom    what an installed jbf consists of, as CycloneDX, into target/sbom"
	@echo "make licences  THIRD_PARTY.md: the texts of what is linked into a wheel"
	@echo "make publish-check  packs every crate that is published, as the registry would"
	@echo "make semver  the public items of the crates against the last release, or BASE=REVISION (cargo-semver-checks)"
	@echo "make wheel   source archive, and the wheel from it, into dist"
	@echo "make wheel-test  that wheel in a new environment: first diagnosis, tests against what is installed"
	@echo "make reproducible  builds both again in another folder: the same bytes?"
	@echo "make lowest  that wheel with the oldest versions that pyproject.toml allows"
	@echo "make free-threaded PYTHON=python3.14t  tests in four threads at once, without the interpreter lock"
	@echo "make bits    the same bits in debug, release, std and native builds"
	@echo "make firmware  the loop on a Cortex-M4F in QEMU: instructions, sizes, bits, no panic"
	@echo "make venv    the extension, the jbf command and all tools of a developer in $(VENV)"
	@echo "make quick   a lightly optimised extension to try a change of Rust: same numbers, slower"
	@echo "make clean   removes $(VENV), dist, target and the built extension"

venv: $(TOOLS)

# cosmic-ray makes the mutants and applies the faults; no other target needs it.
$(MUTANTS): | $(TOOLS)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check 'cosmic-ray>=8.4'
	@touch $@

# Little optimised, without wide instructions, and only what changed: then .venv/bin/jbf and
# .venv/bin/python -m pytest by hand. Deletes .built, so that any other target builds the release.
quick: $(MADE)
	@rm -f $(BUILT)
	VIRTUAL_ENV="$(CURDIR)/$(VENV)" $(VENV)/bin/maturin develop --quiet --extras dev \
		--profile quick --no-default-features

demo: $(BUILT)
	$(VENV)/bin/jbf demo

# Two pages at a time: most of them diagnose something.
docs: $(TOOLS)
	$(VENV)/bin/python docs/site/build.py
	$(VENV)/bin/python -m pytest docs/site/tests -n 2 --dist worksteal --durations 5

# ONLY="docs/laws.py ..." makes those alone; the page then tells which stand as they were.
figures: $(TOOLS)
	$(VENV)/bin/python docs/site/figures.py $(ONLY)

# Every file that a program writes into the repository. Afterwards `git diff` shows what a change alters.
generated: $(TOOLS)
	$(MAKE) bits-table licences
	$(VENV)/bin/python benches/promises.py
	$(MAKE) figures

# The extension (jbf-predict, jbf-py) is tested from Python; `make lint` compiles the benches.
NO_RUST_TESTS := $(addprefix --exclude ,jbf-predict jbf-py jbf-py-module jbf-benches)

test: $(TOOLS)
	cargo test --quiet --workspace $(NO_RUST_TESTS)
	$(VENV)/bin/python -m pytest -n auto --dist worksteal

# What takes minutes: statistical studies, long simulations, all seeds.
test-extended: $(TOOLS) $(MUTANTS)
	cargo test --release -p jbf-core --test control_tracking --test endless -- --ignored --nocapture
	cargo test --release -p jbf-core --features serde --test serde_state
	cargo test --release -p jbf-predict
	JBF_ALL=1 cargo test --release -p jbf-properties
	$(VENV)/bin/python -m pytest -n auto -m extended

# Fuzz targets and firmware are not part of the workspace: rustfmt is given every file. COMMITS is the
# range of commits whose messages are checked, such as main..HEAD; without it none is.
lint: $(TOOLS)
	$(RUSTFMT) --check $$($(RUST_FILES))
	cargo clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace
	$(VENV)/bin/ruff check $(PYTHON_CODE)
	$(VENV)/bin/ruff format --check $(PYTHON_CODE)
	$(VENV)/bin/codespell
	$(if $(COMMITS),$(VENV)/bin/gitlint --commits $(COMMITS))
	$(VENV)/bin/mypy
	$(VENV)/bin/stubtest jbf._core
	$(VENV)/bin/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(VENV)/bin/check-jsonschema --builtin-schema vendor.github-issue-forms \
		$(filter-out %/config.yml,$(wildcard .github/ISSUE_TEMPLATE/*.yml))
	$(VENV)/bin/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff

format: $(TOOLS)
	$(RUSTFMT) $$($(RUST_FILES))
	$(VENV)/bin/ruff check --fix $(PYTHON_CODE)
	$(VENV)/bin/ruff format $(PYTHON_CODE)

bench:
	cargo bench -p jbf-benches --bench '*'

# Instructions of every step against the committed baseline; needs valgrind.
counts:
	$(PYTHON) benches/counts.py

# The bits of every step, in each build that a user may make, against the committed table.
bits:
	cargo run --quiet -p jbf-trace --example table | tail -n 1
	cargo run --quiet --release -p jbf-trace --example table | tail -n 1
	cargo run --quiet --release -p jbf-trace --features std --example table | tail -n 1
	RUSTFLAGS="-C target-cpu=native" cargo run --quiet --release --target-dir target/native \
		-p jbf-trace --example table | tail -n 1

# After a change that is meant to change numbers.
bits-table:
	cargo run --quiet --release -p jbf-trace --example table -- --write crates/jbf-trace/src/table.rs

# 30 faults in physics, likelihood, estimation and verdict, inserted one at a time; ONLY=WORDS.
faults: $(TOOLS) $(MUTANTS)
	$(VENV)/bin/python benches/mutation/faults.py --only '$(ONLY)' --least $(or $(LEAST),30)

# Random mutants, SAMPLE of each PACKAGE by SEED; fails where a smaller share than LEAST is noticed.
mutation: $(TOOLS) $(MUTANTS)
	$(VENV)/bin/python benches/mutation $(if $(PACKAGE),--package $(PACKAGE)) --sample $(or $(SAMPLE),2) \
		--seed $(or $(SEED),1) --budget $(or $(BUDGET),60) --least $(or $(LEAST),0.58)

coverage: $(TOOLS)
	$(VENV)/bin/python -m pytest -n auto --dist worksteal --cov=jbf --cov-report=term-missing:skip-covered

# Needs nightly Rust and cargo-fuzz. Begins with the inputs that were bred before; FOR=seconds a target.
fuzz:
	cd crates/jbf-core && mkdir -p fuzz/corpus && tar -xJf fuzz/corpus.tar.xz -C fuzz/corpus && \
		for target in $$(cargo +nightly fuzz list); do \
		cargo +nightly fuzz run $$target -- -max_total_time=$(or $(FOR),60) -timeout=60 || exit 1; done

# Needs nightly Rust with miri. What it can run in minutes: an interpreter is a thousand times slower.
# It knows no assembly, so it plays a processor for which `libm` has none.
MIRI := cargo +nightly miri test --target riscv64gc-unknown-linux-gnu
miri: export MIRIFLAGS := -Zmiri-disable-isolation
miri:
	@if cargo +nightly miri --version >/dev/null 2>&1; then \
		$(MIRI) -p jbf-core --lib -- controller compensator page error && \
		JBF_EACH=20 $(MIRI) -p jbf-properties --test seeded -- encoder observers interface; \
	else echo "SKIPPED: rustup toolchain install nightly --component miri"; fi

# The compiler's checks in the program, and in the library too where there is nightly Rust.
HOST = $(shell rustc -vV | sed -n 's/^host: //p')
sanitize:
	@if ! echo 'int main(void){return 0;}' | \
		$(CC) -x c - -fsanitize=address,undefined -o /dev/null 2>/dev/null; then \
		echo "SKIPPED: $(CC) has no -fsanitize=address,undefined"; exit 0; fi; \
	if cargo +nightly --version >/dev/null 2>&1; then \
		toolchain=+nightly flags=-Zsanitizer=address; \
	else echo "no nightly Rust: only the C side is watched"; toolchain= flags=; fi; \
	RUSTFLAGS=$$flags CARGO_TARGET_DIR=$(SANITIZED) \
		cargo $$toolchain build --quiet -p jbf-c --target $(HOST) && \
	$(CC) -std=c11 -g -O1 -Wall -Wextra -Werror -fsanitize=address,undefined \
		-fno-sanitize-recover=all -I crates/jbf-c/include crates/jbf-c/tests/every_function.c \
		$(SANITIZED)/$(HOST)/debug/libjbf_c.a -lm -lpthread -ldl \
		-o $(SANITIZED)/every_function && \
	$(SANITIZED)/every_function

# Known faults are on a server: without it licences, bans and sources are looked at alone.
supply:
	@if command -v cargo-deny >/dev/null; then \
		cargo deny --all-features check bans licenses sources && \
		{ cargo deny fetch db >/dev/null 2>&1 && cargo deny check advisories || \
			echo "SKIPPED: the database of advisories cannot be had here"; }; \
	else echo "SKIPPED: cargo install cargo-deny"; fi
	@$(MAKE) --no-print-directory $(AUDIT)/.made
	@told=$$($(AUDIT)/bin/pip-audit --path $(AUDIT)/runtime/lib/python3*/site-packages 2>&1); code=$$?; \
	if [ $$code != 0 ] && grep -q "Fix Versions" <<<"$$told"; then echo "$$told"; exit $$code; fi; \
	if [ $$code != 0 ] || grep -q "could not be audited" <<<"$$told"; then \
		echo "SKIPPED: pip-audit cannot ask for known faults of every package here"; \
	else echo "$$told"; fi
	@if [ -x $(AUDIT)/bin/zizmor ]; then $(AUDIT)/bin/zizmor --offline --quiet .github; \
	else echo "SKIPPED: pip has no zizmor for this machine"; fi

# In environments of their own: what a user installs, and the tools that look at it.
AUDIT := target/audit
$(AUDIT)/.made: pyproject.toml | $(BUILT)
	@rm -rf $(AUDIT) && $(VENV)/bin/python -m venv $(AUDIT) && $(VENV)/bin/python -m venv $(AUDIT)/runtime
	@$(AUDIT)/bin/pip install --quiet --disable-pip-version-check pip-audit cyclonedx-bom
	@-$(AUDIT)/bin/pip install --quiet --disable-pip-version-check --only-binary zizmor zizmor
	@$(VENV)/bin/python -c 'import tomlkit; p = tomlkit.parse(open("pyproject.toml").read())["project"]; \
		print("\n".join(p["dependencies"]))' > $(AUDIT)/runtime.txt
	@$(AUDIT)/runtime/bin/pip install --quiet --disable-pip-version-check -r $(AUDIT)/runtime.txt
	@touch $@

# The crates are read from the lock file where cargo-cyclonedx is installed.
sbom: $(AUDIT)/.made
	@mkdir -p target/sbom
	$(AUDIT)/bin/cyclonedx-py environment --pyproject pyproject.toml --mc-type library \
		--output-file target/sbom/python.cdx.json $(AUDIT)/runtime/bin/python
	@if cargo cyclonedx --version >/dev/null 2>&1; then \
		cargo cyclonedx --quiet --format json --override-filename rust.cdx \
			--manifest-path crates/jbf-py/Cargo.toml && \
		mv crates/jbf-py/rust.cdx.json target/sbom/ && \
		find crates benches -name rust.cdx.json -delete; \
	else echo "SKIPPED: cargo install cargo-cyclonedx (Cargo.lock names every crate and its hash)"; fi

# What is linked into a wheel, with its licences; and whether THIRD_PARTY.md is as Cargo.lock.
licences:
	$(PYTHON) release/licences.py

# Every crate but those that say `publish = false`. In a new folder each time: cargo takes a package of
# the same name, version and place as unchanged, and would build one crate on last week's other.
publish-check:
	$(PYTHON) release/licences.py --check
	folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && \
		CARGO_TARGET_DIR="$$folder" cargo publish --dry-run --quiet --allow-dirty --workspace

# The crates whose items docs/versions.md promises to keep, against the newest release on crates.io or,
# with BASE=REVISION, against a commit of this repository.
semver:
	@if ! cargo semver-checks --version >/dev/null 2>&1; then \
		echo "SKIPPED: cargo install --locked cargo-semver-checks"; exit 0; fi; \
	if [ -z "$(BASE)" ] && ! found=$$(cargo info --quiet --registry crates-io jbf-core 2>&1); then \
		echo "SKIPPED: no release to compare with ($${found##*error: }); BASE=REVISION names a commit"; \
		exit 0; fi; \
	cargo semver-checks --package jbf-core --package jbf-batch $(if $(BASE),--baseline-rev $(BASE))

# The archive is packed, and the wheel built from it in an empty folder: nothing of this tree helps.
wheel: $(MADE)
	rm -rf dist
	$(VENV)/bin/python release/build.py --out dist

wheel-test: wheel
	$(VENV)/bin/python release/wheel_test.py dist

# After `make wheel`.
reproducible: $(MADE)
	$(VENV)/bin/python release/reproducible.py dist

lowest: $(MADE)
	$(VENV)/bin/python release/lowest.py dist

# Needs a free-threaded interpreter: PYTHON=python3.14t. Each test of some files in four threads at once.
FREE := target/free-threaded
free-threaded:
	@$(PYTHON) -c 'import sys; sys.exit(sys._is_gil_enabled())' 2>/dev/null || \
		{ echo "SKIPPED: $(PYTHON) has an interpreter lock; PYTHON=python3.14t names one without"; exit 0; }; \
	$(PYTHON) -m venv $(FREE) && \
	$(FREE)/bin/pip install --quiet --disable-pip-version-check pytest pytest-run-parallel hypothesis filelock . && \
	$(FREE)/bin/python -m pytest -q python/tests/cli/test_parallel_calls.py && \
	$(FREE)/bin/python -m pytest -q --parallel-threads=4 $(addprefix python/tests/, \
		estimation/test_trajectory_fit.py models/test_batch.py models/test_model.py \
		estimation/test_held_out.py estimation/test_held_out_comparison.py diagnosis/test_level.py)

# Needs qemu-system-arm and the target thumbv7em-none-eabihf; says so where one is missing.
firmware: $(TOOLS)
	$(VENV)/bin/python examples/firmware/report.py

clean:
	rm -rf $(VENV) dist target examples/firmware/target examples/rtic/target python/jbf/_core*.so

$(MADE):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "$(PYTHON) is missing or older than 3.10; say make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
		{ echo "$(PYTHON) cannot make environments: apt-get install python3-venv" >&2; exit 1; }
	@command -v cargo >/dev/null || \
		{ echo "cargo is missing: install stable Rust from https://rustup.rs" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check 'maturin>=1.9,<2' setuptools wheel
	@touch $@

# What a user runs. The build uses .venv's own tools (no isolation), so that a rebuild is cargo's alone.
$(BUILT): $(MADE) pyproject.toml $(RUST)
	PATH="$(CURDIR)/$(VENV)/bin:$$PATH" pip install --quiet --disable-pip-version-check \
		--no-build-isolation --editable '.[workbench]'
	@$(VENV)/bin/python -m jbf.workbench.vendored || \
		echo "SKIPPED: the workbench has nothing to draw with; python -m jbf.workbench.vendored fetches it"
	@touch $@

# What a developer needs in addition: tests, lints, documentation.
$(TOOLS): pyproject.toml | $(BUILT)
	PATH="$(CURDIR)/$(VENV)/bin:$$PATH" pip install --quiet --disable-pip-version-check \
		--no-build-isolation --editable '.[dev]'
	@touch $@
