#!/usr/bin/env bash
# Builds the library with the address and undefined-behaviour sanitizers of clang, whose instrumented code takes some 60 % of
# GCC's time to compile, links the release build's test cases to it, and runs those but what tests/left_out.cmake leaves out.
# Arguments are passed on to ctest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh clang
scripts/build.sh release
scripts/build.sh sanitize
ctest --preset sanitize "$@"
