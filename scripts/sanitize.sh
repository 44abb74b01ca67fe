#!/usr/bin/env bash
# Builds with the address and undefined-behaviour sanitizers of clang, whose instrumented code takes some 60 % of GCC's time
# to compile, and runs the tests but those that CMakePresets.json leaves out.
# Arguments are passed on to ctest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh clang
scripts/build.sh sanitize
ctest --preset sanitize "$@"
