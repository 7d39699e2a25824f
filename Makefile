# The verbs of the course. `make lab` opens it, `make test` checks it; `make help` lists the rest.
PYTHON ?= python3
RUN := .venv/bin/python
SOURCES := $(shell find fuzzynav -name '*.py')
WORKERS ?= 2

.PHONY: help lab test reproduce bench handout grade reset wheels notebooks clean

help:
	@echo "make lab             open the course in JupyterLab"
	@echo "make test            run every test and every notebook"
	@echo "make reproduce       run the studies that are missing or stale (FRESH=1: all), then print the ledger"
	@echo "make bench           measure speed against other programs"
	@echo "make handout         students' edition, without solutions, in handout/"
	@echo "make grade IN=folder grade folder/STUDENT/*.ipynb into grades.csv; also NB=05 OUT=file SECONDS=60 JOBS=2"
	@echo "make reset NB=03     restore one notebook, keeping a backup"
	@echo "make wheels          download all packages for seats without a network"
	@echo "make notebooks NB=03 run notebooks and store their results"
	@echo "make clean           remove what the other verbs made"

lab: .venv/kernels
	@echo "opening JupyterLab; stop it with Ctrl-C twice"
	@$(RUN) tools/lab.py notebooks/00_start_here.ipynb

test:
	@$(PYTHON) tools/environment.py --test
	@$(MAKE) --no-print-directory .venv/kernels
	@echo "running the tests and every notebook"
	@$(RUN) -m pytest -q -rs -n $(WORKERS) --dist loadfile --nbval tests fuzzynav notebooks

# the compiled kernels are cached beside the sources; anew only when a source changed
.venv/kernels: pyproject.toml constraints.txt $(SOURCES)
	@$(PYTHON) tools/environment.py
	@$(RUN) -m fuzzynav.warm
	@touch $@

reproduce: .venv/kernels
	@$(RUN) -m fuzzynav.studies $(if $(FRESH),--fresh)
	@$(RUN) -m fuzzynav.published

bench:
	@$(PYTHON) tools/environment.py --bench
	@$(RUN) tests/bench

handout: .venv/kernels
	@$(RUN) -m fuzzynav.course handout

grade: .venv/kernels
	@test -n "$(IN)" || { echo "fuzzynav: say which folder holds the students' folders: make grade IN=folder"; exit 2; }
	@$(RUN) -m fuzzynav.course grade "$(IN)" $(if $(NB),--notebook "$(NB)") $(if $(OUT),--out "$(OUT)") \
		$(if $(SECONDS),--seconds "$(SECONDS)") $(if $(JOBS),--jobs "$(JOBS)")

reset: .venv/kernels
	@test -n "$(NB)" || { echo "fuzzynav: say which notebook: make reset NB=03"; exit 2; }
	@$(RUN) -m fuzzynav.course reset "$(NB)"

wheels:
	@$(PYTHON) tools/environment.py --download

notebooks: .venv/kernels
	@$(RUN) tests/notebooks/store.py notebooks/$(NB)*.ipynb

clean:
	rm -rf .venv build handout .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
