#!/usr/bin/env bash
# The walls of the house, from names and #include lines of all sources: scripts/check_house.sh [ROOT]
# A room is a folder at the top. Those of SLIPMODE_MODULES in CMakeLists.txt are installed, python, selftest and cli come
# after them; each uses itself and those before it, and so do the folders of orbits and of diagnostics. tests, bench and
# fuzz use all, examples what is installed. Headers in internal/ serve their own room (and tests, bench, fuzz) and no
# installed header.
# A header is named in one way, from the root, and a library in its room alone. No circles among headers.
# Prints each breach as FILE:LINE: what; remedy. Exit code 1 if there is one.
set -euo pipefail
shopt -s nullglob
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

installed=$(sed -nE 's/^set\(SLIPMODE_MODULES (.*)\)$/\1/p' CMakeLists.txt)
[[ -n $installed ]] || { echo "check_house.sh: no set(SLIPMODE_MODULES ...) in CMakeLists.txt" >&2; exit 2; }
order=" $installed python selftest cli "
floors="diagnostics/series diagnostics diagnostics/exponents diagnostics/attractors diagnostics/validation"
order=${order/ diagnostics / $floors }
floors="orbits orbits/balance orbits/mixed orbits/branches"
order=${order/ orbits / $floors }
libraries="hdf5 results H5 results toml++ scene pybind11 python"  # how a header's name begins, its room

skipped=(-path './.?*' -o -path ./build -o -path ./out -o -path ./debian)
for cache in */CMakeCache.txt; do skipped+=(-o -path "./${cache%/*}"); done
mapfile -t files < <(find . \( "${skipped[@]}" \) -prune -o -type f -regextype posix-extended \
  -regex '.*\.(h|hh|hxx|inl|ipp|tpp|c|cc|cxx|[ch]pp|hpp\.in)' -printf '%P\n' | LC_ALL=C sort)

pairs=$(mktemp)
trap 'rm -f "$pairs"' EXIT
failed=0

awk -v order="$order" -v installed="$installed" -v libraries="$libraries" -v pairs="$pairs" '
  function say(where, what, remedy) { print where ": " what "; " remedy; bad = 1 }
  function breach(what, remedy) { say(FILENAME ":" FNR, what, remedy) }
  function room(path) { sub(/\/.*/, "", path); return path }
  # The nearest folder of a file that has a place in the order; empty where none has.
  function place(path) { do sub(/\/?[^\/]*$/, "", path); while (path != "" && !(path in rank)); return path }
  function plain(path) {
    while (sub(/\/\.\//, "/", path) || sub(/[^\/]+\/\.\.\//, "", path)) {}
    return path
  }
  # The file of the project that an include names, from the root; empty where it names none.
  function target(name,   beside) {
    if (sub(/^slipmode\//, "", name)) return plain(name)
    beside = FILENAME
    sub(/[^\/]*$/, name, beside)
    if (plain(name) in known) return plain(name)
    if (plain(beside) in known) return plain(beside)
    return "tests/" name in known ? "tests/" name : ""
  }
  BEGIN {
    n = split(order, names, " "); for (i = 1; i <= n; ++i) rank[names[i]] = i
    n = split(installed, names, " "); for (i = 1; i <= n; ++i) ships[names[i]] = 1
    n = split("tests bench fuzz", names, " "); for (i = 1; i <= n; ++i) uses_all[names[i]] = 1
    n = split(libraries, names, " "); for (i = 1; i < n; i += 2) home[names[i]] = names[i + 1]
    for (i = 1; i < ARGC; ++i) {
      known[ARGV[i]] = 1
      folder = room(ARGV[i])
      if (!(folder in rank || folder in uses_all || folder == "examples") && !said[folder]++)
        say(ARGV[i], folder " is no room",
            "move it to one, or name its folder in SLIPMODE_MODULES of CMakeLists.txt or in scripts/check_house.sh")
      if (ARGV[i] !~ /\.([ch]pp|hpp\.in)$/) say(ARGV[i], "is neither .hpp nor .cpp", "rename it")
    }
  }
  match($0, /^[ \t]*#[ \t]*include[ \t]*[<"][^>"]+[>"]/) {
    written = substr($0, RSTART, RLENGTH)
    sub(/^[^<"]*/, "", written)
    name = substr(written, 2, length(written) - 2)
    from = room(FILENAME)
    file = target(name)
    if (file == "") {
      for (library in home)
        if (index(name, library) == 1 && from != home[library] && !(from in uses_all))
          breach("includes " written, "only " home[library] " uses it: call " home[library] " instead")
      if (written !~ /^"/ || (name ".in") in known) next
    }
    if (!(file in known)) {
      breach("includes " written ", which is not there", "mend the path")
      next
    }
    to = room(file)
    inside = file ~ /\/internal\//
    right = to in ships && !inside ? "<slipmode/" file ">" : "\"" file "\""
    if (to == "tests") sub(/tests\//, "", right)
    if (written ~ /\.\.\// || (written != right && to !~ /^(tests|fuzz)$/)) breach("includes " written, "write " right)

    user = place(FILENAME)
    used = place(file)
    if (user != "" && !(used in rank && rank[used] <= rank[user]))
      breach("includes " file ", but " user " may not use " (used == "" ? to : used),
             "move what both need to a room before " user)
    if (FILENAME ~ /^diagnostics\/series\// && file !~ /^(core|diagnostics\/series)\//)
      breach("includes " file, "diagnostics/series uses core only")
    if (from == "examples" && to != from && !(to in ships)) breach("includes " file, "examples use what is installed only")
    if (inside && from != to && !(from in uses_all))
      breach("includes " file ", which is internal to " to, "use a header that " to " offers")
    if (inside && from in ships && FILENAME ~ /\.hpp$/ && FILENAME !~ /\/internal\//)
      breach("is installed and includes " file ", which is not", "include it in the source")
    if (FILENAME ~ /\.hpp$/) print FILENAME, file >pairs
  }
  END { exit bad }' "${files[@]}" || failed=1

tsort "$pairs" 2>&1 >/dev/null | sed -nE 's/^tsort: ([^:]*)$/\1/p' | LC_ALL=C sort -u | paste -sd ' ' |
  awk 'NF { print $1 ": these include each other: " $0 "; move what both need to a header of its own"; bad = 1 }
       END { exit bad }' || failed=1

exit "$failed"
