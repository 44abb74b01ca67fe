#!/usr/bin/env bash
# Usage: scripts/package.sh [--test]
# Debian packages of what is committed, into build/package, read by lintian. With --test (root) they are also installed,
# used and removed in a fresh Debian: scripts/package_test.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[[ ${1:-} == "" || $1 == --test ]] || { echo "usage: scripts/package.sh [--test]" >&2; exit 2; }
[[ ${1:-} != --test || $EUID -eq 0 ]] || { echo "package.sh: --test makes a root of its own; run it as root" >&2; exit 2; }
version=$(sed -nE 's/^project\(slipmode VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
grep -q "^slipmode ($version) " debian/changelog || {
  echo "package.sh: CMakeLists.txt has version $version, debian/changelog begins with $(head -1 debian/changelog)" >&2
  exit 2
}

scripts/install_packages.sh dpkg-dev debhelper dh-python lintian
rm -rf build/package
mkdir -p build/package/slipmode
git archive HEAD | tar -x -C build/package/slipmode
if command -v ccache >/dev/null; then  # the packages' build has a home of its own
  CCACHE_DIR=$(ccache --get-config cache_dir)
  export CCACHE_DIR CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=true
fi
echo "Building packages of $(git describe --always) (log: build/package/log)"
(cd build/package/slipmode && dpkg-buildpackage --build=binary --no-sign) >build/package/log 2>&1 </dev/null || {
  tail -20 build/package/log >&2
  echo "package.sh: dpkg-buildpackage failed" >&2
  exit 1
}
rm -rf build/package/slipmode
lintian --allow-root --fail-on error,warning build/package/*.changes
ls -sh build/package/*.deb
[[ ${1:-} != --test ]] || scripts/package_test.sh build/package
