#!/usr/bin/env bash
# The walls of the house, from the #include lines of all sources: scripts/check_house.sh [ROOT]
# A room uses those before it in SLIPMODE_MODULES of CMakeLists.txt, then python, selftest, cli; tests, bench, fuzz and
# examples use all. Headers in internal/ serve their own room (and tests, bench, fuzz) and no installed header. No circles
# among headers.
# Prints each breach as FILE: what; exit code 1 if there is one.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

modules=$(sed -nE 's/^set\(SLIPMODE_MODULES (.*)\)$/\1/p' CMakeLists.txt)
[[ -n $modules ]] || { echo "check_house.sh: no set(SLIPMODE_MODULES ...) in CMakeLists.txt" >&2; exit 2; }
folders=()
for folder in $modules python selftest cli tests bench fuzz examples; do
  [[ ! -d $folder ]] || folders+=("$folder")
done
mapfile -t files < <(find "${folders[@]}" -name '*.hpp' -o -name '*.cpp' | LC_ALL=C sort)

edges=$(mktemp)
trap 'rm -f "$edges"' EXIT
failed=0

# One line for each include of a header of the project: FILE HEADER, both from the root.
awk -v list="${files[*]}" '
  BEGIN { n = split(list, names, " "); for (i = 1; i <= n; ++i) known[names[i]] = 1 }
  match($0, /^[ \t]*#[ \t]*include[ \t]*[<"][^>"]+[>"]/) {
    header = substr($0, RSTART, RLENGTH)
    gsub(/^[^<"]*[<"]|[>"]$/, "", header)
    beside = FILENAME
    sub(/[^\/]*$/, header, beside)
    public = sub(/^slipmode\//, "", header)
    if (header in known || public) print FILENAME, header
    else if (beside in known) print FILENAME, beside
    else if ("tests/" header in known) print FILENAME, "tests/" header
  }' "${files[@]}" >"$edges"

awk -v order="$modules python selftest cli" -v installed="$modules" -v list="${files[*]}" '
  function breach(what) { print $1 ": " what; bad = 1 }
  BEGIN {
    n = split(list, names, " "); for (i = 1; i <= n; ++i) known[names[i]] = 1
    n = split(order, rooms, " "); for (i = 1; i <= n; ++i) rank[rooms[i]] = i
    n = split(installed, rooms, " "); for (i = 1; i <= n; ++i) ships[rooms[i]] = 1
  }
  {
    split($1, from, "/"); split($2, to, "/")
    if (!($2 in known)) breach("includes " $2 ", which is not there")
    inside = $2 ~ /\/internal\//
    if (from[1] in rank && !(to[1] in rank && rank[to[1]] <= rank[from[1]]))
      breach("includes " $2 ", but " from[1] " may not use " to[1])
    if (inside && from[1] != to[1] && from[1] !~ /^(tests|bench|fuzz)$/)
      breach("includes " $2 ", which is internal to " to[1])
    if (inside && from[1] in ships && $1 ~ /\.hpp$/ && $1 !~ /\/internal\//)
      breach("is installed and includes " $2 ", which is not")
    if ($1 ~ /^diagnostics\/series\// && $2 !~ /^(core|diagnostics\/series)\//)
      breach("includes " $2 ", but diagnostics/series uses core only")
  }
  END { exit bad }' "$edges" || failed=1

awk '$1 ~ /\.hpp$/' "$edges" | tsort 2>&1 >/dev/null | sed 's/^tsort: //; s/^-: input contains a loop:$/a circle of headers:/' |
  awk '{ print; bad = 1 } END { exit bad }' || failed=1

exit "$failed"
