# Every target sets up what it needs, and is quick when that is there. README.md names the prerequisites.
SHELL := /bin/bash
PYTHON ?= python3
ARGS ?=

BIN := .venv/bin
DONE := .venv/done
WEB := client/web
WEB_PACKAGES := $(WEB)/node_modules/.package-lock.json
WEB_BUILD := $(WEB)/dist/index.html
SOLVER := server/culet/simulation/solver
WEB_SOURCES := $(shell find $(WEB)/src $(WEB)/element $(WEB)/docs protocol/typescript -type f) $(addprefix $(WEB)/,index.html tsconfig.json vite.config.ts vite.element.config.ts)

# Or each of hundreds of processes compiles its modules, and each of pytest's workers its tests, anew.
unexport PYTHONDONTWRITEBYTECODE

# Node.js from the Python index, if the system's is missing or too old (.ci/node).
export PATH := $(CURDIR)/.venv/node/bin:$(PATH)

# Kernels compiled for tests are kept here, apart from the user's own.
test check-kernels validate soak reliability: export POCL_CACHE_DIR ?= $(CURDIR)/.cache/kernels

.PHONY: setup serve wheel test check check-python check-kernels check-protocol check-web check-docs docs format validate soak reliability bench delay study compose-test lock digests compilers opencl browser llvm node
.DELETE_ON_ERROR:

setup: $(DONE)/dev opencl $(DONE)/solver $(WEB_BUILD)
	@echo "Ready. make serve | wheel | test | check | docs | validate | soak | bench | study | compose-test"

serve: opencl $(DONE)/solver $(WEB_BUILD)
	@exec $(BIN)/culet serve $(ARGS)

# One file that `pip install` makes a server with its page of.
wheel: $(DONE)/base $(DONE)/solver $(WEB_BUILD)
	$(BIN)/pip wheel --quiet --no-deps --wheel-dir dist .
	@ls -1 dist/culet-*.whl

test: $(DONE)/dev opencl $(DONE)/solver compilers browser $(WEB_BUILD)
	.ci/test $(ARGS)

# Each in its own target, so that `make -k check` finds all there is to find.
check: check-python check-kernels check-protocol check-web check-docs

check-python: $(DONE)/docs
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

check-kernels: $(DONE)/dev opencl
	$(BIN)/clang-format --dry-run --Werror kernels/culet_kernels/*.cl $(SOLVER)/*.c $(SOLVER)/*.h
	$(BIN)/python .ci/compile_kernels.py

check-protocol: $(DONE)/dev
	$(BIN)/pytest -q tests/protocol/test_generate.py

check-web: $(WEB_PACKAGES) $(DONE)/dev
	cd $(WEB) && npm run check
	$(BIN)/python -m culet.gateway.document | node $(WEB)/rest-types.mjs --check

check-docs: docs

# A site that can be searched, without a server: open docs/_build/html/index.html. Nothing is fetched.
docs: $(DONE)/docs
	$(BIN)/sphinx-build --builder html --fresh-env --nitpicky --fail-on-warning --keep-going --quiet docs docs/_build/html

format: $(DONE)/dev $(WEB_PACKAGES)
	$(BIN)/ruff check --fix
	$(BIN)/ruff format
	$(BIN)/clang-format -i kernels/culet_kernels/*.cl $(SOLVER)/*.c $(SOLVER)/*.h
	$(BIN)/python .ci/default_scene.py
	$(BIN)/python -m culet.gateway.document | node $(WEB)/rest-types.mjs
	cd $(WEB) && npm run format

# Without ARGS only the files that have such tests are read. pytest ends with 5 if it has found no test.
validate: $(DONE)/validation opencl $(DONE)/solver compilers llvm browser $(WEB_BUILD)
	$(BIN)/pytest -m "validation and not soak" --numprocesses 2 --dist loadfile --no-loadscope-reorder \
	$(or $(ARGS),$$(grep -rlE 'mark\.validation|video_extra' tests --include='test_*.py')) || [ $$? -eq 5 ]

# What is long by nature, and bounded: load, chaos, whole searches. Not part of .ci/run.
soak: $(DONE)/soak opencl $(DONE)/solver
	$(BIN)/pytest -m soak $(ARGS)

# Writes what the hostile trials find into the documentation.
reliability: $(DONE)/soak opencl
	PYTHONPATH=tests $(BIN)/python -m hostile.reliability --into docs/explanation/reliability.md $(ARGS)

bench: opencl
	$(BIN)/culet bench --against tests/benchmarks/baseline.jsonl $(ARGS)

# From a key that is pressed to pixels that have changed, in a browser.
delay: $(DONE)/dev opencl browser $(DONE)/solver $(WEB_BUILD)
	PYTHONPATH=tests $(BIN)/python -m e2e.control_to_photon $(ARGS)

study: $(DONE)/study opencl
	$(BIN)/culet study rendering $(ARGS)

compose-test: $(DONE)/dev browser
	.ci/compose-test $(ARGS)

# What the images install of the Python index, by hashes. `make lock` follows pyproject.toml, `make lock ARGS=--upgrade` takes the newest.
LOCK := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --custom-compile-command "make lock"

lock: $(DONE)/base
	$(BIN)/pip install --quiet uv
	$(LOCK) $(ARGS) --output-file docker/requirements.txt pyproject.toml
	$(LOCK) $(ARGS) --extra batch --constraint docker/requirements.txt --output-file docker/requirements-batch.txt pyproject.toml
	$(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")' | \
	$(LOCK) $(ARGS) --output-file docker/requirements-build.txt -

# What the images rest on, with its digest of today: for CULET_BASE of Compose, or `docker build --build-arg BASE=`.
BASE ?= $(shell sed -n 's/^ARG BASE=//p' docker/Dockerfile)

digests:
	@digest=$$(docker buildx imagetools inspect --format '{{json .Manifest.Digest}}' $(BASE)) && \
	echo "$(BASE)@$$(tr -d '"' <<<"$$digest")"

$(DONE)/venv:
	@PYTHON=$(PYTHON) .ci/need venv
	$(PYTHON) -m venv .venv
	@mkdir -p $(DONE) && touch $@

$(DONE)/base: pyproject.toml | $(DONE)/venv
	$(BIN)/pip install --quiet --editable .
	@touch $@

$(DONE)/dev: pyproject.toml | $(DONE)/base
	$(BIN)/pip install --quiet --editable '.[dev]'
	@touch $@

$(DONE)/soak: pyproject.toml | $(DONE)/dev
	$(BIN)/pip install --quiet --editable '.[soak]'
	@touch $@

$(DONE)/docs: pyproject.toml | $(DONE)/dev
	$(BIN)/pip install --quiet --editable '.[docs]'
	@touch $@

$(DONE)/study: pyproject.toml | $(DONE)/base
	$(BIN)/pip install --quiet --editable '.[study]'
	@touch $@

# The programs to compare with are optional: where one cannot be installed, its tests are skipped and say so. pip installs
# all or none of what it is given, so what it cannot install together it is given one by one.
VALIDATION := import tomllib; project = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	print(*project["optional-dependencies"]["validation"], sep="\n")

$(DONE)/validation: pyproject.toml | $(DONE)/dev
	@if $(BIN)/pip install --quiet --editable '.[validation]'; then touch $@; \
	else $(BIN)/python -c '$(VALIDATION)' | while read -r program; do $(BIN)/pip install --quiet "$$program" || \
	echo "validate: $$program could not be installed; comparisons with it are skipped" >&2; done; fi

# Compiles what moves several stones, beside its sources.
$(DONE)/solver: $(wildcard $(SOLVER)/*.c $(SOLVER)/*.h) $(SOLVER)/build.py | $(DONE)/base
	@.ci/need compiler
	$(BIN)/python $(SOLVER)/build.py
	@touch $@

# Tests compile the solver by both of them.
compilers:
	@.ci/need gcc clang || echo "make: what is shown of a compiler that is missing is skipped" >&2

opencl: $(DONE)/base
	@.ci/need opencl

llvm: $(DONE)/validation
	@.ci/need llvm || echo "make: Mitsuba has no LLVM, and takes three times as long" >&2

browser:
	@.ci/need chromium curl

node: | $(DONE)/venv
	@.ci/node

$(WEB_PACKAGES): $(WEB)/package.json $(WEB)/package-lock.json | node
	cd $(WEB) && npm ci --no-audit --no-fund
	@touch $@

$(WEB_BUILD): $(WEB_PACKAGES) $(WEB_SOURCES) | node
	cd $(WEB) && npm run build
	@touch $@
