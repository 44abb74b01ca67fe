#!/usr/bin/env bash
# Installs what is missing, builds the executable (no tests), and runs the ten-mass chain on a belt from scene to figures.
# Arguments are passed on to `slipmode run`, for example: scripts/run.sh --set drive.speed=0.25
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release slipmode_cli
exec build/release/cli/slipmode run datasets/chain10/scene.toml -o out/chain10 "$@"
