#!/usr/bin/env bash
# Feeds the readers of scenes, CSV files and result files with mutated input: scripts/fuzz.sh [SECONDS EACH] [TARGET...]
# Targets: scene csv store. Stops with an error at the first crash, hang or leak; the input is kept in build/fuzz.
# Needs clang (apt-get install clang) and the release build; only the readers are compiled again, instrumented.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
targets=("${@:2}")
[[ ${#targets[@]} -gt 0 ]] || targets=(scene csv store)
release=${SLIPMODE_BUILD:-build/release}
out=build/fuzz
[[ -f $release/libslipmode.a ]] || scripts/build.sh release
mkdir -p "$out"

compiler=(clang++)
command -v ccache >/dev/null && compiler=(ccache clang++)
flags=(-std=c++20 -O1 -g1 -DEIGEN_MAX_ALIGN_BYTES=64 -I. -Ifuzz -isystem /usr/include/eigen3
  -isystem /usr/include/hdf5/serial -DFMT_SHARED -DTOML_HEADER_ONLY=0 -DTOML_SHARED_LIB=1
  -fsanitize=address,undefined -fno-sanitize-recover=undefined)
libraries=("$release/libslipmode.a" -lfmt -ltomlplusplus -llapack -lblas -larpack -lfftw3 -lhdf5_serial -lpthread)

sources_of() {
  case $1 in
    scene) ls scene/toml_*.cpp scene/scene_parse.cpp scene/parse_*.cpp scene/scene_write.cpp scene/write_*.cpp ;;
    csv) ls cli/csv_series.cpp ;;
    store) ls scene/store_reader.cpp scene/info.cpp scene/checked_read.cpp scene/records.cpp scene/*_record*.cpp ;;
    *) echo "no such target: $1 (scene, csv, store)" >&2; exit 2 ;;
  esac | sort -u
}

build() {
  local objects=() source object
  for source in $(sources_of "$1") "fuzz/$1_fuzz.cpp"; do
    object=$out/${source//\//_}.o
    "${compiler[@]}" "${flags[@]}" -fsanitize=fuzzer-no-link -c "$source" -o "$object"
    objects+=("$object")
  done
  clang++ -fsanitize=fuzzer,address,undefined "${objects[@]}" "${libraries[@]}" -o "$out/$1_fuzz"
}

# Seeds from what the project has anyway.
seed() {
  mkdir -p "$out/$1_corpus" "$out/$1_seeds"
  case $1 in
    scene) for scene in datasets/*/scene.toml; do cp "$scene" "$out/scene_seeds/$(basename "$(dirname "$scene")").toml"; done ;;
    csv) cp fuzz/corpus/csv/* "$out/csv_seeds/" ;;
    store)
      local slipmode=$release/cli/slipmode scene=fuzz/corpus/scene/two_masses.toml
      "$slipmode" simulate "$scene" -o "$out/store_seeds/run.h5" --quiet
      "$slipmode" pod "$out/store_seeds/run.h5" -o "$out/store_seeds/pod.h5" --quiet
      "$slipmode" reduce "$scene" "$out/store_seeds/pod.h5" --modes 1 -o "$out/store_seeds/reduced.h5" --quiet
      ;;
  esac
  [[ $1 != scene ]] || cp fuzz/corpus/scene/* "$out/scene_seeds/"
}

for target in "${targets[@]}"; do
  build "$target"
  seed "$target"
  dictionary=()
  [[ ! -f fuzz/$target.dict ]] || dictionary=(-dict="fuzz/$target.dict")
  (cd "$out" && "./${target}_fuzz" "${dictionary[@]/fuzz\//../../fuzz/}" -max_total_time="$seconds" -timeout=10 \
    -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="${target}_" \
    "${target}_corpus" "${target}_seeds" 2>&1 | grep -vE '^#[0-9]+\s+(NEW|REDUCE|pulse)' || exit 1)
done
