# make demo: a simulated gyro, the service, and a live view.   make test: format, lint, types and all tests.
# Both create a virtual environment in .venv and install the packages of pyproject.toml.

VENV := .venv
BIN := $(VENV)/bin
# Many tests wait for a device in real time, so three processes are needed to keep two cores busy.
WORKERS := $(shell echo $$(( ($$(nproc) * 3 + 1) / 2 )))

.PHONY: demo test types tests packaging release release-check docs docs-versions links build lock bench evaluate faults soak overload crash fuzz mutate audit pictures clean

demo: $(VENV)/ready
	@$(BIN)/gyrodrift demo

test: $(VENV)/ready-to-test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	@$(MAKE) --no-print-directory -j3 types tests packaging

types: $(VENV)/ready-to-test
	$(BIN)/mypy

# The documentation as a site: build/docs/index.html. A warning is an error, and so is a link to a page, heading or file
# that does not exist. `make links` also asks the servers that the pages link to.
SITE := -m sphinx --fail-on-warning --keep-going --nitpicky --quiet --conf-dir docs
docs: $(VENV)/ready-to-test
	$(BIN)/python $(SITE) . build/docs

# The site of each release and of this clone: build/site/VERSION, with a list of the versions beside each page.
DOCS_VERSIONS = main $(shell git tag --list 'v*' --sort=-version:refname)
docs-versions: $(VENV)/ready-to-test
	rm -rf build/site build/tags
	for tag in $(wordlist 2,99,$(DOCS_VERSIONS)); do \
	  git worktree add --quiet build/tags/$$tag $$tag && \
	  (cd build/tags/$$tag && DOCS_VERSIONS='$(DOCS_VERSIONS)' ../../../$(BIN)/python $(SITE) . ../../site/$$tag); \
	  git worktree remove --force build/tags/$$tag; done
	DOCS_VERSIONS='$(DOCS_VERSIONS)' $(BIN)/python $(SITE) . build/site/main
	echo '<!doctype html><meta http-equiv="refresh" content="0; url=main/README.html">' > build/site/index.html
	cp build/site/main/404.html build/site/404.html

links: $(VENV)/ready-to-test
	$(BIN)/python $(SITE) --builder linkcheck . build/links

# The sdist and the wheel in dist/, checked as an index checks them.
build: $(VENV)/ready-to-test
	rm -rf dist
	$(BIN)/python -m hatchling build
	$(BIN)/twine check --strict dist/*
	$(BIN)/check-wheel-contents dist/*.whl

# The files of a release in dist/: wheel, sdist, .deb, C library, SBOM and checksums. The .deb needs Debian's tools.
release: $(VENV)/ready-to-test
	PYTHONPATH=. $(BIN)/python .ci/release.py dist

# uv.lock: the newest versions that pyproject.toml allows. Run it after each change of a dependency.
lock: $(VENV)/ready-to-test
	$(BIN)/uv lock --upgrade --default-index https://pypi.org/simple

# Each test process uses one thread of linear algebra, like the commands. More threads would wait for each other.
tests: $(VENV)/collected
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n $(WORKERS) --dist loadgroup -m "not packaging and not evaluation"

# The bytecode of all tests, which the test processes share. Without it each of them would compile all tests.
unexport PYTHONDONTWRITEBYTECODE
$(VENV)/collected: | $(VENV)/ready-to-test
	@$(BIN)/pytest --collect-only --quiet > $@.txt || { tail $@.txt; false; }
	@touch $@

# Tests that build the wheel and install it. They run in a fresh clone, and again when these files have changed.
packaging: $(VENV)/packaging-passed
$(VENV)/packaging-passed: pyproject.toml benchmark/pyproject.toml uv.lock Makefile $(wildcard tests/*distribution*.py) tests/test_wheel.py | $(VENV)/ready-to-test
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -m packaging tests/test_wheel.py tests/test_distributions.py
	@touch $@

# All checks of a release: files built twice, lintian, the .deb installed, upgraded and purged (as root), plug-ins.
RELEASE_TOOLS := dpkg-dev debhelper lintian mandoc
release-check: $(VENV)/ready-to-test
	@if command -v apt-get > /dev/null && ! dpkg --status $(RELEASE_TOOLS) > /dev/null 2>&1; then \
	  as_root=$$( [ "$$(id -u)" = 0 ] || echo sudo -n ); $$as_root apt-get update -qq > /dev/null 2>&1; \
	  $$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends $(RELEASE_TOOLS) > /dev/null 2>&1 || \
	  echo "no $(RELEASE_TOOLS): checks of the .deb are skipped; apt-get install them" >&2; fi
	rm -f $(VENV)/packaging-passed
	@$(MAKE) --no-print-directory packaging build
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -m packaging tests/release

bench: $(VENV)/ready-to-test
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest benchmark/bench -s -p no:randomly --timeout 600

# Slow cases of tests that others resemble first. Then compares results over many random cases with the committed figures,
# and fails if one is worse. All rows of the blind check take hours; EVALUATE="diagnose --count 50" selects some. An
# interrupted run continues.
evaluate: $(VENV)/ready-to-test
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n $(WORKERS) --dist loadgroup -m evaluation
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmark evaluate $(EVALUATE)

# Robustness campaigns: every fault of the simulated device (FAULT_SEED); HOURS of device time at 1 kHz (PACE=1: in real
# time); overload.
faults: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark robustness faults $(if $(FAULT_SEED),--seed $(FAULT_SEED))

soak: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark robustness soak --hours $(or $(HOURS),24) $(if $(MINUTES),--minutes $(MINUTES)) $(if $(PACE),--pace $(PACE))

overload: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark robustness overload

# Fuzzes all inputs for FUZZ_S seconds of processor time: guided by coverage if atheris has a wheel, else at random.
FUZZ_S := 1800
fuzz: $(VENV)/ready-to-test
	@$(BIN)/python -m pip install --quiet --editable '.[fuzz]' || echo "no atheris: inputs are random" >&2
	$(BIN)/python -m benchmark fuzz --seconds $(FUZZ_S)

# Mutation test: a test must catch each deliberate fault. FAULTS selects areas or faults.
mutate: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark mutate $(FAULTS)

# Kills every writer at random moments, KILLS times each.
KILLS := 20
crash: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark crash --kills $(KILLS)

# Checks the packages of .venv against the public list of vulnerabilities. An unknown package is a failure, too.
AUDIT := $(VENV)/audit
audit: $(VENV)/ready
	@$(BIN)/python -m venv $(AUDIT) && $(AUDIT)/bin/python -m pip install --quiet pip-audit
	@$(BIN)/python -m pip freeze --exclude-editable --exclude pip --exclude setuptools > $(AUDIT)/packages.txt
	$(AUDIT)/bin/pip-audit --strict --disable-pip --no-deps --requirement $(AUDIT)/packages.txt

pictures: $(VENV)/ready-to-test
	$(BIN)/python -m benchmark pictures moving-demo docs/demo-moving.svg
	$(BIN)/python -m benchmark pictures comparison docs/comparison.svg
	$(BIN)/python -m benchmark pictures reports docs/reports
	$(BIN)/gyrodrift demo --svg docs/demo.svg
	$(BIN)/python -m benchmark pictures.effects --out docs/effects
	$(BIN)/python -m benchmark pictures.restlevel --out docs/restlevel.png
	$(BIN)/python -m benchmark pictures.live_page docs

clean:
	rm -rf $(VENV)

$(VENV)/ready: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

# Firmware tests need compilers, also for AVR, the Arduino core with its builder, a simulated AVR, and CMake.
FIRMWARE := gcc g++ clang clang-tidy libclang-rt-dev gcc-avr avr-libc arduino-core-avr arduino-builder libsimavr-dev \
  cmake
# Clients to test the outputs, and shells to test completion. RUNLEVEL=1 tells Debian not to start their services.
CLIENTS := gpsd gpsd-clients mosquitto mosquitto-clients prometheus ser2net socat chromium xvfb x11-utils \
  netcat-openbsd zsh fish

# MAVProxy is a test client, installed without the packages for its maps and plots. Clients of npm are installed at the
# same time, without their optional packages.
$(VENV)/ready-to-test: pyproject.toml benchmark/pyproject.toml tests/clients/package-lock.json tests/clients/signalk/package-lock.json | $(BIN)/python
	@{ ! command -v npm > /dev/null || for place in tests/clients tests/clients/signalk; do \
	  npm ci --silent --no-audit --no-fund --ignore-scripts --omit=optional --prefix $$place > /dev/null || \
	  echo "no clients of npm in $$place: their tests are skipped" >&2; done; } & npm=$$!; \
	$(BIN)/python -m pip install --quiet --editable '.[lab,cluster,docs,foxglove,logs,mavlink,mqtt,networktables,nmea,parquet,prometheus,ros,simulators,websocket,test]' --editable benchmark; failed=$$?; \
	$(BIN)/python -m pip install --quiet --no-deps 'MAVProxy>=1.8.70' || echo "no MAVProxy: its test is skipped" >&2; \
	wait $$npm; exit $$failed
	@if command -v apt-get > /dev/null && ! dpkg --status $(FIRMWARE) $(CLIENTS) > /dev/null 2>&1; then \
	  as_root=$$( [ "$$(id -u)" = 0 ] || echo sudo -n ); $$as_root apt-get update -qq > /dev/null 2>&1; \
	  for package in $(FIRMWARE) $(CLIENTS); do dpkg --status $$package > /dev/null 2>&1 || \
	    $$as_root env RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends $$package > /dev/null 2>&1 || \
	    echo "no $$package: tests that need it are skipped; apt-get install it" >&2; done; fi
	@touch $@ $(VENV)/ready

# Debian and Ubuntu have the venv module in a separate package.
$(BIN)/python:
	@set -e; for python in $(PYTHON) python3.13 python3.12 python3.11 python3; do \
	  if $$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then echo "gyrodrift needs Python 3.11 or later; give it as make PYTHON=/path/to/python" >&2; exit 1; fi; \
	$$found -m venv $(VENV) || { \
	  echo "the venv module of $$found is incomplete; installing the system package python3-venv" >&2; \
	  rm -rf $(VENV); $$( [ "$$(id -u)" = 0 ] || echo sudo ) apt-get install -y python3-venv; $$found -m venv $(VENV); }
