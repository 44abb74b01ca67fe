#!/usr/bin/env bash
# Feeds the readers of scenes, CSV files and result files with mutated input: scripts/fuzz.sh [SECONDS EACH] [TARGET...]
# Targets: scene csv store records, all at once. A crash, hang or leak is an error; the input is kept in build/fuzz.
# Installs clang if it is missing. Uses the release build; only the readers are compiled again, instrumented.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
targets=("${@:2}")
[[ ${#targets[@]} -gt 0 ]] || targets=(scene csv store records)
release=${SLIPMODE_BUILD:-build/release}
out=build/fuzz
scripts/install_packages.sh clang
[[ -f $release/libslipmode.a ]] || scripts/build.sh release
mkdir -p "$out"

compiler=(clang++)
command -v ccache >/dev/null && compiler=(ccache clang++)
flags=(-std=c++20 -O1 -g1 -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 -DEIGEN_NO_CPUID -I. -I"$release/include" -Ifuzz -isystem /usr/include/eigen3
  -isystem /usr/include/hdf5/serial -DFMT_SHARED -DTOML_HEADER_ONLY=0 -DTOML_SHARED_LIB=1
  -fsanitize=address,undefined -fno-sanitize-recover=undefined)
libraries=("$release/libslipmode.a" -lfmt -ltomlplusplus -llapack -lblas -lfftw3 -lhdf5_serial -lz -lpthread)

sources_of() {
  case $1 in
    scene) ls scene/internal/*.cpp scene/scene_parse.cpp scene/parse_*.cpp scene/scene_write.cpp scene/write_*.cpp ;;
    csv) ls results/csv_series.cpp ;;
    store | records)
      ls results/{store_reader,memory_store,info,records,branch_store,provenance}.cpp results/*_record*.cpp results/internal/*.cpp ;;
    *) echo "no such target: $1 (scene, csv, store, records)" >&2; exit 2 ;;
  esac | sort -u
  echo "fuzz/$1_fuzz.cpp"
}

object_of() { echo "$out/${1//\//_}.o"; }

compile() {
  local target source
  for target in "${targets[@]}"; do sources_of "$target"; done | sort -u | while read -r source; do
    printf '%s\0' "$(object_of "$source")" "$source"
  done | xargs -0 -n 2 -P "$(nproc)" "${compiler[@]}" "${flags[@]}" -fsanitize=fuzzer-no-link -c -o
}

link() {
  local objects=() source
  for source in $(sources_of "$1"); do objects+=("$(object_of "$source")"); done
  # The library's objects hold several sources each: what they have of the readers too gives way to what comes first.
  clang++ -fsanitize=fuzzer,address,undefined -Wl,--allow-multiple-definition "${objects[@]}" "${libraries[@]}" -o "$out/$1_fuzz"
}

# Seeds from what the project has anyway.
seed() {
  mkdir -p "$out/$1_corpus" "$out/$1_seeds"
  case $1 in
    scene) for scene in datasets/*/scene.toml; do cp "$scene" "$out/scene_seeds/$(basename "$(dirname "$scene")").toml"; done ;;
    csv) cp fuzz/corpus/csv/* "$out/csv_seeds/" ;;
    store | records)
      local slipmode=$release/cli/slipmode scene=fuzz/corpus/scene/two_masses.toml results=$out/store_seeds
      mkdir -p "$results"
      "$slipmode" simulate "$scene" -o "$results/run.h5" --quiet
      "$slipmode" pod "$results/run.h5" -o "$results/pod.h5" --quiet
      "$slipmode" reduce "$scene" "$results/pod.h5" --modes 1 -o "$results/reduced.h5" --quiet
      scene=datasets/backlash_sdof/scene.toml
      "$slipmode" orbit find "$scene" -o "$results/orbit.h5" --quiet
      "$slipmode" orbit continue "$scene" --over drive.omega=1.8:1.7 --start 2.5,0 -o "$results/branch.h5" --quiet
      ;;
  esac
  [[ $1 != scene ]] || cp fuzz/corpus/scene/* "$out/scene_seeds/"
}

run() {
  local dictionary=()
  [[ ! -f fuzz/$1.dict ]] || dictionary=(-dict="../../fuzz/$1.dict")
  # Freed memory is held back for reuse for some inputs only: a large store of it costs more than the inputs.
  (cd "$out" && ASAN_OPTIONS=quarantine_size_mb=8:malloc_context_size=8 "./$1_fuzz" "${dictionary[@]}" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
    -max_len=65536 -print_final_stats=1 -artifact_prefix="$1_" "$1_corpus" "$1_seeds" >"$1.log" 2>&1)
}

for target in "${targets[@]}"; do sources_of "$target" >/dev/null; done
compile
for target in "${targets[@]}"; do
  link "$target"
  seed "$target"
done
declare -A running
for target in "${targets[@]}"; do
  run "$target" &
  running[$target]=$!
done
failed=0
for target in "${targets[@]}"; do
  if wait "${running[$target]}"; then
    echo "fuzz $target: $(grep -oP 'number_of_executed_units:\s*\K[0-9]+' "$out/$target.log") inputs, no crash, hang or leak"
  else
    tail -40 "$out/$target.log" >&2
    echo "fuzz $target: failed; the input is in $out" >&2
    failed=1
  fi
done
exit "$failed"
