#!/usr/bin/env bash
# Usage: scripts/package_test.sh FOLDER
# Installs FOLDER/*.deb in a fresh Debian of its own, uses them there as two users without root and without network, and
# removes them. Prints a line for each thing that holds; stops at the first that does not. Run as root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:?usage: scripts/package_test.sh FOLDER}
[[ $EUID -eq 0 ]] || { echo "package_test.sh: it makes a root of its own; run it as root" >&2; exit 2; }
scripts/install_packages.sh mmdebstrap

root=$(mktemp -d) log=$(mktemp)
chmod 755 "$root"
trap 'rm -rf --one-file-system "$root" "$log"' EXIT
started=$SECONDS

holds() { printf '  holds after %3d s: %s\n' $((SECONDS - started)) "$*"; }
fails() {
  tail -40 "$log" >&2
  echo "package_test.sh: does not hold: $*" >&2
  exit 1
}
# as USER [--net] COMMAND: in the root, in the user's home, without network unless asked for; output goes to the log.
as() {
  local user=$1 net=(--net)
  shift
  [[ $1 != --net ]] || { net=(); shift; }
  unshare "${net[@]}" --mount --pid --fork --mount-proc="$root/proc" bash -c '
    mount -t devpts -o newinstance,ptmxmode=666 devpts "$0/dev/pts"
    exec chroot "$0" su - "$1" -c "export LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive; set -e; $2"' \
    "$root" "$user" "$1" >"$log" 2>&1 </dev/null
}
check() { as "$2" "$3" || fails "$1"; holds "$1"; }
# Ends with an exit code and says something.
refused() {
  local code=0
  as "$2" "$3" || code=$?
  if [[ $code -ne $4 ]] || ! grep -qF -- "$5" "$log"; then fails "$1 (exit code $code; expected $4 and '$5')"; fi
  holds "$1"
}

. /etc/os-release
mmdebstrap --quiet --variant=apt "$VERSION_CODENAME" "$root" >"$log" 2>&1 || fails "a fresh Debian"
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir "$root/packages"
cp "$folder"/*.deb "$root/packages"
cp -r tests/install "$root/packages/consumer"
cp scripts/install_packages.sh "$root/packages"
chroot "$root" useradd -m -s /bin/bash anna
chroot "$root" useradd -m -s /bin/bash ben
as root --net "apt-get update" || fails "apt-get update"
holds "a fresh Debian, $(cut -d. -f1 "$root/etc/debian_version")"

# What the README says first.
begun=$SECONDS
as root --net "apt-get install -y --no-install-recommends /packages/slipmode_*.deb" || fails "apt-get install ./slipmode_*.deb"
holds "slipmode installed, $((SECONDS - begun)) s with the download of what it depends on"
check "first figures and the report" anna "cp -r /usr/share/slipmode/datasets .
  slipmode run datasets/chain10/scene.toml -o out/chain10
  test -s out/chain10/history.svg; test -s out/chain10/bifurcation.png; test -s out/chain10/report.html"
echo "  from apt-get install to all figures: $((SECONDS - begun)) s"

check "doctor: nothing that is needed is missing" anna "slipmode doctor && slipmode --version | grep -q 'report  *D3'"
refused "doctor without gnuplot names its package" anna "PATH=/nowhere /usr/bin/slipmode doctor" 2 "apt-get install gnuplot-nox"
check "a new scene runs; editors find the schema of scenes" anna "slipmode new clearance -o mine.toml
  grep -q '^#:schema file:///usr/share/slipmode/scene.schema.json' mine.toml
  test -s /usr/share/slipmode/scene.schema.json; slipmode run mine.toml -o out/mine; test -s out/mine/report.html"
check "manual pages, completion" anna "test -s /usr/share/man/man1/slipmode-orbit-find.1.gz
  . /usr/share/bash-completion/completions/slipmode
  COMP_WORDS=(slipmode orbit f); COMP_CWORD=2; _slipmode slipmode f orbit; test \"\${COMPREPLY[*]}\" = find"
refused "a folder of root's is refused with its name" anna "slipmode run datasets/coulomb_decay/scene.toml -o /usr/share/out" 2 \
  "-o /usr/share/out: cannot write there"
check "a path with blanks and Unicode" anna "mkdir 'Träger, Messung 3'; cd 'Träger, Messung 3'
  cp ../datasets/coulomb_decay/scene.toml 'größte Dämpfung.toml'
  slipmode run 'größte Dämpfung.toml' -o 'Ergebnis α 1'; test -s 'Ergebnis α 1/history.png'
  slipmode report 'Ergebnis α 1' -o 'Übersicht 1.html'; test -s 'Übersicht 1.html'
  slipmode plot 'Ergebnis α 1/trajectory.h5' -o 'Bild 1.pdf'; test -s 'Bild 1.pdf'"
check "a second user gets the same bytes" ben "cp -r /usr/share/slipmode/datasets .
  slipmode simulate datasets/backlash_sdof/scene.toml -o run.h5"
as anna "slipmode simulate datasets/backlash_sdof/scene.toml -o run.h5" || fails "simulate"
cmp "$root/home/anna/run.h5" "$root/home/ben/run.h5" || fails "the same bytes for both users"
check "a terminal of 80 columns without colours" anna "export TERM=dumb NO_COLOR=1
  script -qec 'stty cols 80; slipmode simulate datasets/chain10/scene.toml -o e.h5; slipmode --help' said >/dev/null
  test -s e.h5; test -z \"\$(grep \$'\\e' said)\"
  tr '\\r' '\\n' <said | grep -v '^  slipmode \|^Script ' | awk 'length > 80 { print; bad = 1 } END { exit bad }'"
refused "packages without root: apt says who may" anna "apt-get install -y /packages/slipmode_*.deb" 100 "are you root?"
refused "a build without root says what is missing" anna "bash /packages/install_packages.sh" 1 "run this as root, or install sudo"

as root --net "apt-get install -y --no-install-recommends /packages/*.deb g++ cmake make qemu-user" || fails "apt-get install of all packages"
check "Python finds the package by itself" anna "cd datasets/chain10
  python3 -c 'import slipmode as sm; run = sm.simulate(\"scene.toml\"); assert run.q.shape[1] == 10, run.q.shape'"
check "a C++ project finds the library" anna "cmake -S /packages/consumer -B consumer && cmake --build consumer && consumer/consumer"
refused "an older processor is told what is missing" anna "qemu-x86_64 -cpu Nehalem /usr/bin/slipmode --version" 2 "built for processors with AVX2"
refused "in Python too" anna "qemu-x86_64 -cpu Nehalem /usr/bin/python3 -c 'import slipmode'" 2 "built for processors with AVX2"
check "tutorials and examples" anna "test -s /usr/share/doc/slipmode/docs/tutorial/chain.md; test -s /usr/share/doc/slipmode/examples/own_structure.cpp
  test -s /usr/share/doc/slipmode/datasets/README.md; test -s /usr/share/slipmode/matlab/+slipmode/call.m"

as root "apt-get purge -y slipmode libslipmode-dev python3-slipmode slipmode-doc" || fails "apt-get purge"
left=$(find "$root/usr" "$root/etc" "$root/var" -name '*slipmode*' -not -path '*/var/log/*')
[[ -z $left ]] || fails "nothing is left: $left"
holds "removed, nothing is left"
