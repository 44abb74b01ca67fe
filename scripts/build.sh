#!/usr/bin/env bash
# Usage: scripts/build.sh PRESET [TARGET...]    (release, debug or sanitize; default: all targets)
# Installs what is missing, configures and builds. Prints the build's output only when it fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:?usage: scripts/build.sh PRESET [TARGET...]}
shift

scripts/install_packages.sh

log=$(mktemp)
trap 'rm -f "$log"' EXIT
step() {
  "$@" </dev/null >"$log" 2>&1 || {
    cat "$log" >&2
    echo "build.sh: '$*' failed" >&2
    exit 1
  }
}

[[ -e build/$preset/build.ninja ]] || echo "Building preset $preset for the first time; this takes some minutes"
step cmake --preset "$preset"
step cmake --build --preset "$preset" ${1:+--target "$@"}
