#!/usr/bin/env bash
# Builds with the address and undefined-behaviour sanitizers, and runs all tests.
# Arguments are passed on to ctest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh sanitize
ctest --preset sanitize "$@"
