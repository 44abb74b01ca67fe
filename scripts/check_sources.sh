#!/usr/bin/env bash
# What builds and tests do not show: scripts/check_sources.sh [format] [alone] [everything-alone] [tidy]
#   format  clang-format finds nothing to change in any tracked source
#   alone   every source of library and executable that changed within four hours, or includes a header that did, compiles
#           by itself, and so does every such header without a source of its name: the builds join two dozen sources,
#           which hides an include that is missing. What is not reached after 60 seconds stays unread, changed sources
#           come first. everything-alone: all of them, some ten minutes of processor
#   tidy    clang-tidy on the sources that changed within four hours, 60 seconds too
# Both read with clang, which takes some 60 % of GCC's time.
# By default format, alone and tidy.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
checks=("$@")
[[ ${#checks[@]} -gt 0 ]] || checks=(format alone tidy)
build=build/alone

configure() {
  scripts/install_packages.sh clang clang-tidy
  cmake --preset release -B "$build" -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_UNITY_BUILD=OFF -DSLIPMODE_TESTS=OFF >/dev/null
  ninja -C "$build" slipmode_version >/dev/null
}

check_format() { git ls-files -z '*.hpp' '*.cpp' | xargs -0 clang-format --dry-run -Werror; }

# The build's own compile commands without their outputs, one a line, SOURCE last.
commands() {
  local targets=(slipmode_cli)
  ! ninja -C "$build" -t query slipmode_python >/dev/null 2>&1 || targets+=(slipmode_python)
  ninja -C "$build" -t commands "${targets[@]}" | sed -nE 's/ -MD -MT .* -c / -fsyntax-only /p'
}

# What changed in the four hours before the last commit: what is pushed together. Nothing without a history.
changed() {
  local base
  base=$(git rev-list -1 --before="$(($(git log -1 --format=%ct) - 14400))" HEAD)
  [[ -n $base ]] || return 0
  git diff --name-only --diff-filter=d "$base" -- "$@" | { grep -vE '^(tests|bench|fuzz|examples)/|/kernels/' || true; }
}

# Sources and headers on standard input, each compiled by itself, until one does not or the time given is over.
compile_alone() {
  local seconds=$1
  configure
  local file like all to_compile wanted=() headers=()
  while read -r file; do
    if [[ $file == *.cpp ]]; then
      wanted+=("/$file")
    elif [[ ! -e ${file%.hpp}.cpp ]]; then
      headers+=("$file")
    fi
  done
  all=$(commands)
  to_compile=$({
    for file in "${wanted[@]}"; do grep -m1 -F "$file" <<<"$all" || true; done
    for file in "${headers[@]}"; do  # as a source of its room: each room links what it needs
      like=$(grep -m1 "/${file%%/*}/[^ ]*$" <<<"$all")
      printf "echo '#include \"%s\"' | %s -x c++ -\n" "$file" "${like% *}"
    done
  })
  [[ -n $to_compile ]] || return 0
  # 143: stopped by timeout.
  (cd "$build" && timeout --preserve-status "$seconds" xargs -0 -P "$(nproc)" -I{} bash -c '{} || exit 255' \
    < <(tr '\n' '\0' <<<"$to_compile")) || [[ $? -eq 143 ]]
}

check_everything-alone() { git ls-files '*.hpp' '*.cpp' | grep -vE '^(tests|bench|fuzz|examples)/|/kernels/' | compile_alone 3600; }

check_alone() {
  local files headers
  mapfile -t files < <(changed '*.cpp' '*.hpp')
  mapfile -t headers < <(printf '%s\n' "${files[@]}" | grep 'hpp$' || true)
  {
    printf '%s\n' "${files[@]}"
    [[ ${#headers[@]} -eq 0 ]] || git grep -lF -f <(printf '%s\n' "${headers[@]}") -- '*.cpp' |
      { grep -vE '^(tests|bench|fuzz|examples)/|/kernels/' || true; }
  } | awk 'NF && !seen[$0]++' | compile_alone 60
}

check_tidy() {
  local sources
  configure
  mapfile -t sources < <(changed '*.cpp')
  [[ ${#sources[@]} -eq 0 ]] && return
  # Time out or not, what was found by then counts.
  printf '%s\0' "${sources[@]}" |
    { timeout 60 xargs -0 -P "$(nproc)" -n 1 clang-tidy -p "$build" --quiet --warnings-as-errors='*' || true; } |
    { ! grep -A 3 ': error: '; }
}

for check in "${checks[@]}"; do "check_$check"; done
