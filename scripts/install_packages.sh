#!/usr/bin/env bash
# Installs the Debian packages slipmode builds with, and those named. Says nothing when none is missing.
set -euo pipefail

packages=(
  # toolchain
  g++ cmake ninja-build git ca-certificates
  # libraries
  libeigen3-dev libspectra-dev liblapack-dev libfftw3-dev libhdf5-dev zlib1g-dev
  libfmt-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev
  # tests, benchmarks and the peers they measure against
  libgtest-dev libgmock-dev libarpack2-dev libbenchmark-dev libsundials-dev libboost-dev
  # figures
  gnuplot-nox node-d3
  # the Python package, its tests and examples
  pybind11-dev python3-dev python3-numpy python3-scipy python3-h5py python3-matplotlib
  python3-xarray python3-tqdm python3-nbclient python3-ipykernel
  # studies under mpirun
  libopenmpi-dev openmpi-bin
  "$@"
)

installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  grep --quiet --line-regexp --fixed-strings "installed $package" <<<"$installed" || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $EUID -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install_packages.sh: missing ${missing[*]}; run this as root, or install sudo" >&2
    exit 1
  fi
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" </dev/null >"$log" 2>&1 || {
    cat "$log" >&2
    echo "install_packages.sh: apt-get $1 failed" >&2
    exit 1
  }
}

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
apt update
apt install --yes --no-install-recommends "${missing[@]}"
