# SPDX-License-Identifier: GPL-3.0-or-later
# Each command first sets up what it needs (tools/setup.sh): on a fresh Debian 12 or 13 that takes minutes, later
# seconds.
PYTHON := .venv/bin/python
.DEFAULT_GOAL := help
.PHONY: help demo test matrix nightly lint bench extension repository release docs

help: ## List the commands
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: ## Pose a cutout character in Blender; pictures and demo.blend in out/
	@tools/setup.sh demo
	@$(PYTHON) examples/demo.py

test: ## All tests: native (three builds), Python, Blender data, Blender window
	@tools/run_suites.py test

matrix: ## The Blender tests in every supported Blender
	@tools/run_suites.py matrix

nightly: ## All of it whole: what .ci/run shortens, too (it runs test, matrix and lint before a change lands)
	@tools/run_suites.py nightly

lint: ## Formatting, clang-tidy, ruff, mypy, shellcheck, what imports what, and the add-on's registration
	@tools/setup.sh lint
	@tools/lint.sh

bench: ## Tables of the solver's speed, of a drag's cost in Blender's window, and beside libigl
	@tools/bench.sh

# Or linux, windows, macos-arm64, macos-x64; no module for macOS has ever run, see docs/platforms.md.
PLATFORM ?= all
extension: dist/.built-$(PLATFORM) ## dist/planar_deform-*.zip, to be installed in Blender; PLATFORM=linux for that alone

# What is packed or compiled, with its folders, whose dates tell of files that were added or removed.
EXTENSION_SOURCES := $(shell find addon native CMakeLists.txt pyproject.toml LICENSE tools/build_extension* \
    tools/cross tools/requirements -not -name __pycache__ -not -name '*.pyc')
dist/.built-%: $(EXTENSION_SOURCES)
	@tools/build_extension.sh $*
	@touch $@

repository: extension ## dist/repository/, for any web server: Blender installs and updates from it
	@tools/setup.sh demo
	@$(PYTHON) tools/build_repository.py

release: ## Check that all states one version, and build what is to be published in dist/repository/
	@tools/setup.sh demo
	@$(PYTHON) tools/release.py

docs: ## The pictures of the docs pages
	@tools/setup.sh demo
	@tools/docs.sh
