#!/usr/bin/env bash
# What builds and tests do not show: scripts/check_sources.sh [format] [alone] [tidy]; default: all three
#   format  clang-format finds nothing to change in any tracked source
#   alone   every source of library and executable, and every header without a source of its name, compiles by itself: the
#           builds join a dozen sources, which hides an include that is missing
#   tidy    clang-tidy on the sources that changed since the previous commit of main; what it has not reached after three
#           minutes stays unread
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
checks=("$@")
[[ ${#checks[@]} -gt 0 ]] || checks=(format alone tidy)
build=build/alone

configure() {
  cmake --preset release -B "$build" -DCMAKE_UNITY_BUILD=OFF -DSLIPMODE_TESTS=OFF >/dev/null
  ninja -C "$build" slipmode_version >/dev/null
}

check_format() { git ls-files -z '*.hpp' '*.cpp' | xargs -0 clang-format --dry-run -Werror; }

# The build's own compile commands without their outputs, one a line, SOURCE last.
commands() { ninja -C "$build" -t commands slipmode_cli | sed -nE 's/ -MD -MT .* -c / -fsyntax-only /p'; }

check_alone() {
  configure
  local header like headers=()
  while read -r header; do
    [[ -e ${header%.hpp}.cpp ]] || headers+=("$header")
  done < <(git ls-files '*.hpp' | grep -vE '^(tests|bench|fuzz)/|/kernels/')
  like=$(commands | grep '/cli/main.cpp$')
  {
    commands
    printf "echo '#include \"%s\"' | ${like% *} -x c++ -\n" "${headers[@]}"
  } | (cd "$build" && tr '\n' '\0' | xargs -0 -P "$(nproc)" -I{} bash -c '{}')
}

check_tidy() {
  local sources
  configure
  mapfile -t sources < <(git diff --name-only --diff-filter=d HEAD~1 -- '*.cpp' | grep -vE '^(tests|bench|fuzz|examples)/|/kernels/')
  [[ ${#sources[@]} -eq 0 ]] && return
  command -v clang-tidy >/dev/null
  # Time out or not, what was found by then counts.
  printf '%s\0' "${sources[@]}" |
    { timeout 180 xargs -0 -P "$(nproc)" -n 1 clang-tidy -p "$build" --quiet --warnings-as-errors='*' || true; } |
    { ! grep -A 3 ': error: '; }
}

for check in "${checks[@]}"; do "check_$check"; done
