#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests.
# Arguments are passed on to ctest, for example: scripts/test.sh -R Chain
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release
ctest --preset release "$@"
