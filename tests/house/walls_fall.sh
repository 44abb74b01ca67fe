#!/usr/bin/env bash
# Does scripts/check_house.sh find what it is there for? A small house, sound; then one breach at a time, each of which has
# to be told with its file, line and remedy, and to be the only one: tests/house/walls_fall.sh
set -euo pipefail
script=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/scripts/check_house.sh
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
cd "$root"
failed=0
planted=()

# FILE LINE...: a source of these lines.
put() {
  [[ $1 != */* || -d ${1%/*} ]] || mkdir -p "${1%/*}"
  printf '%s\n' "${@:2}" >"$1"
  planted+=("$1")
}

# CLAIM MESSAGE, after a breach was planted: the script says MESSAGE and nothing else, and fails. The breach is taken away.
falls() {
  local said
  if said=$(scripts/check_house.sh 2>&1) || [[ $said != "$2" ]]; then
    printf '%s\n  expected: %s\n  found:    %s\n' "$1" "$2" "${said:-nothing}"
    failed=1
  fi
  rm "${planted[@]}"
  planted=()
}

mkdir scripts
cp "$script" scripts
put CMakeLists.txt 'set(SLIPMODE_MODULES core fem dynamics orbits diagnostics scene results)'
put core/errors.hpp '#pragma once' '#include <string>'
put fem/structure.hpp '#pragma once' '#include <slipmode/core/errors.hpp>'
put fem/structure.cpp '#include <slipmode/fem/structure.hpp>' '#include "fem/internal/modes.hpp"'
put fem/internal/modes.hpp '#pragma once'
put dynamics/system.hpp '#pragma once' '#include <slipmode/fem/structure.hpp>'
put orbits/shooting.hpp '#pragma once' '#include <slipmode/dynamics/system.hpp>'
put orbits/balance/balance.hpp '#pragma once' '#include <slipmode/orbits/shooting.hpp>'
put orbits/mixed/mixed.cpp '#include <slipmode/orbits/balance/balance.hpp>'
put orbits/branches/continuation.hpp '#pragma once' '#include <slipmode/orbits/balance/balance.hpp>'
put diagnostics/series/series.hpp '#pragma once' '#include <slipmode/core/errors.hpp>'
put diagnostics/model.hpp '#pragma once' '#include <slipmode/orbits/shooting.hpp>'
put diagnostics/exponents/lyapunov.hpp '#pragma once' '#include <slipmode/diagnostics/model.hpp>'
put diagnostics/attractors/driven.hpp '#pragma once' '#include <slipmode/diagnostics/exponents/lyapunov.hpp>'
put diagnostics/validation/cost.cpp '#include <slipmode/diagnostics/attractors/driven.hpp>'
put results/version.hpp.in '#pragma once'
put results/store.cpp '#include <hdf5.h>' '#include "results/version.hpp"'
put cli/verbs.hpp '#pragma once'
put cli/run.cpp '#include "cli/verbs.hpp"' '#include <slipmode/scene/scene.hpp>'
put scene/scene.hpp '#pragma once'
put tests/fixtures/chain.hpp '#pragma once'
put tests/cli/run_test.cpp '#include "cli/verbs.hpp"' '#include "fem/internal/modes.hpp"' '#include "fixtures/chain.hpp"'
put examples/one.cpp '#include <slipmode/fem/structure.hpp>'
put build/generated.h
put elsewhere/CMakeCache.txt
put elsewhere/compiler.c
scripts/check_house.sh || { echo "a sound house is refused"; exit 1; }
planted=()

put fem/early.cpp '' '#include <slipmode/orbits/shooting.hpp>'
falls "a room that comes later" \
  'fem/early.cpp:2: includes orbits/shooting.hpp, but fem may not use orbits; move what both need to a room before fem'

put orbits/tangent.cpp '#include "cli/verbs.hpp"'
falls "the executable" \
  'orbits/tangent.cpp:1: includes cli/verbs.hpp, but orbits may not use cli; move what both need to a room before orbits'

put fem/probe.cpp '#include "fixtures/chain.hpp"'
falls "a fixture of the tests" \
  'fem/probe.cpp:1: includes tests/fixtures/chain.hpp, but fem may not use tests; move what both need to a room before fem'

put fem/early.cpp '#include "../orbits/shooting.hpp"'
falls "a room that comes later, from beside" \
  'fem/early.cpp:1: includes "../orbits/shooting.hpp"; write <slipmode/orbits/shooting.hpp>
fem/early.cpp:1: includes orbits/shooting.hpp, but fem may not use orbits; move what both need to a room before fem'

put dynamics/flow.cpp '#include <slipmode/fem/../fem/structure.hpp>'
falls "a way round within a name" \
  'dynamics/flow.cpp:1: includes <slipmode/fem/../fem/structure.hpp>; write <slipmode/fem/structure.hpp>'

put fem/beam.cpp '#include "fem/structure.hpp"'
falls "an installed header in quotes" \
  'fem/beam.cpp:1: includes "fem/structure.hpp"; write <slipmode/fem/structure.hpp>'

put fem/beam.cpp '#include "structure.hpp"'
falls "an installed header from beside" \
  'fem/beam.cpp:1: includes "structure.hpp"; write <slipmode/fem/structure.hpp>'

put fem/beam.cpp '#include <fem/structure.hpp>'
falls "an installed header without the project" \
  'fem/beam.cpp:1: includes <fem/structure.hpp>; write <slipmode/fem/structure.hpp>'

put fem/beam.cpp '#include <slipmode/fem/internal/modes.hpp>'
falls "an internal header as if it were installed" \
  'fem/beam.cpp:1: includes <slipmode/fem/internal/modes.hpp>; write "fem/internal/modes.hpp"'

put fem/beam.cpp '#include "fem/beam.hpp"'
falls "a header that is not there" \
  'fem/beam.cpp:1: includes "fem/beam.hpp", which is not there; mend the path'

put dynamics/flow.cpp '#include "fem/internal/modes.hpp"'
falls "what is internal to another room" \
  'dynamics/flow.cpp:1: includes fem/internal/modes.hpp, which is internal to fem; use a header that fem offers'

put fem/beam.hpp '#include "fem/internal/modes.hpp"'
falls "an installed header that needs an internal one" \
  'fem/beam.hpp:1: is installed and includes fem/internal/modes.hpp, which is not; include it in the source'

put thermal/heat.cpp '#include <slipmode/fem/structure.hpp>'
falls "a folder that is no room" \
  'thermal/heat.cpp: thermal is no room; move it to one, or name its folder in SLIPMODE_MODULES of CMakeLists.txt or in scripts/check_house.sh'

put fem/beam.h
falls "a header with another ending" 'fem/beam.h: is neither .hpp nor .cpp; rename it'

put examples/two.cpp '' '' '#include "cli/verbs.hpp"'
falls "an example that needs the executable" \
  'examples/two.cpp:3: includes cli/verbs.hpp; examples use what is installed only'

put orbits/file.cpp '#include <hdf5.h>'
falls "HDF5 outside its room" 'orbits/file.cpp:1: includes <hdf5.h>; only results uses it: call results instead'

put diagnostics/series/reads.cpp '#include <slipmode/fem/structure.hpp>'
falls "more than core in diagnostics/series" \
  'diagnostics/series/reads.cpp:1: includes fem/structure.hpp; diagnostics/series uses core only'

put diagnostics/exponents/spectrum.cpp '#include <slipmode/diagnostics/attractors/driven.hpp>'
falls "a folder of diagnostics that comes later" \
  'diagnostics/exponents/spectrum.cpp:1: includes diagnostics/attractors/driven.hpp, but diagnostics/exponents may not use diagnostics/attractors; move what both need to a room before diagnostics/exponents'

put orbits/guess.cpp '#include <slipmode/orbits/balance/balance.hpp>'
falls "a folder of orbits from what lies above all of them" \
  'orbits/guess.cpp:1: includes orbits/balance/balance.hpp, but orbits may not use orbits/balance; move what both need to a room before orbits'

put orbits/balance/internal/hill.cpp '#include <slipmode/orbits/branches/continuation.hpp>'
falls "a folder of orbits that comes later" \
  'orbits/balance/internal/hill.cpp:1: includes orbits/branches/continuation.hpp, but orbits/balance may not use orbits/branches; move what both need to a room before orbits/balance'

put fem/beam.hpp '#include <slipmode/fem/plate.hpp>'
put fem/plate.hpp '#include <slipmode/fem/beam.hpp>'
falls "headers that include each other" \
  'fem/beam.hpp: these include each other: fem/beam.hpp fem/plate.hpp; move what both need to a header of its own'

scripts/check_house.sh || { echo "what was planted stayed"; exit 1; }
exit "$failed"
