#!/usr/bin/env bash
# Builds and tests every combination of compiler and processor level, each in build/matrix-<compiler>-<level>:
#   scripts/matrix.sh [-c COMPILER]... [-a LEVEL]... [-- CTEST ARGUMENTS]
# Compilers: gcc clang; levels: x86-64-v2 x86-64-v3 x86-64-v4 native; default: all. Levels this machine lacks are skipped.
# Goes on after a failure; ends with a table and with exit code 1 if anything failed. Logs are in each build folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  sed -n '2,5s/^# \{0,1\}//p' scripts/matrix.sh >&2
  exit 2
}

compilers=() levels=()
while getopts c:a: option; do
  case $option in
    c) compilers+=("$OPTARG") ;;
    a) levels+=("$OPTARG") ;;
    *) usage ;;
  esac
done
shift $((OPTIND - 1))
[[ ${#compilers[@]} -gt 0 ]] || compilers=(gcc clang)
[[ ${#levels[@]} -gt 0 ]] || levels=(x86-64-v2 x86-64-v3 x86-64-v4 native)

program_of() {
  case $1 in
    gcc) echo g++ ;;
    clang) echo clang++ ;;
    *) usage ;;
  esac
}

# What /proc/cpuinfo has to name for a level, beside the levels below it.
features_of() {
  case $1 in
    x86-64-v2) echo sse4_2 ssse3 popcnt cx16 ;;
    x86-64-v3) echo avx2 bmi1 bmi2 fma f16c movbe ;;
    x86-64-v4) echo avx512f avx512bw avx512cd avx512dq avx512vl ;;
    native) ;;
    *) usage ;;
  esac
}

machine_has() {
  local feature
  for feature in $(features_of "$1"); do
    grep --quiet --word-regexp "$feature" /proc/cpuinfo || return 1
  done
}

for compiler in "${compilers[@]}"; do program_of "$compiler" >/dev/null; done
for level in "${levels[@]}"; do features_of "$level" >/dev/null; done

build() {
  local folder=$1 compiler=$2 level=$3
  cmake --preset release -B "$folder" -DCMAKE_CXX_COMPILER="$(program_of "$compiler")" -DSLIPMODE_ARCH="$level" &&
    cmake --build "$folder"
}

# "312 of 312" from the last line of ctest's summary: "100% tests passed, 0 tests failed out of 312".
count() {
  local failed total
  read -r failed total < <(sed -nE 's/.* ([0-9]+) tests failed out of ([0-9]+)$/\1 \2/p' "$1" | tail -1) || true
  [[ -n ${total:-} ]] && echo "$((total - failed)) of $total" || echo "not run"
}

minutes() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

scripts/install_packages.sh clang
rows=() failed=0
for compiler in "${compilers[@]}"; do
  for level in "${levels[@]}"; do
    if ! machine_has "$level"; then
      rows+=("| $compiler | $level | not on this machine | | | |")
      continue
    fi
    folder=build/matrix-$compiler-$level
    mkdir -p "$folder"
    echo "== $compiler, $level"
    SECONDS=0 tests="not run" test_seconds=0
    if build "$folder" "$compiler" "$level" </dev/null >"$folder/build.log" 2>&1; then
      build_seconds=$SECONDS result=passed SECONDS=0
      ctest --test-dir "$folder" --parallel 2 --output-on-failure --no-tests=error "$@" </dev/null \
        >"$folder/test.log" 2>&1 || result="tests failed"
      test_seconds=$SECONDS tests=$(count "$folder/test.log")
      [[ $result == passed ]] || sed -n '/The following tests FAILED/,$p' "$folder/test.log"
    else
      build_seconds=$SECONDS result="build failed"
      tail -20 "$folder/build.log"
    fi
    [[ $result == passed ]] || failed=1
    rows+=("| $compiler | $level | $result | $tests | $(minutes "$build_seconds") | $(minutes "$test_seconds") |")
  done
done

echo "$(date -u +%F), commit $(git rev-parse --short HEAD), $(sed -nE 's/^model name\s*: //p' /proc/cpuinfo | head -1), $(nproc) cores"
echo "$(g++ --version | head -1); $(clang++ --version | head -1)"
echo
echo "| compiler | level | outcome | tests passed | build, min | tests, min |"
echo "|---|---|---|---|---|---|"
printf '%s\n' "${rows[@]}"
exit "$failed"
