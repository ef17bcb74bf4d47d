#!/usr/bin/env bash
# Are faults found? Each line of mutations.txt makes one in this checkout (a double sum made float, a seam that is not
# wrapped, a clamp removed), builds the stress tests and expects those that it names to fail. The checkout must have no
# changes of its own: each fault is taken back by git. Not a part of CI: a mutation takes a file's compilation and a link.
#   tests/stress/mutations.sh [WORD of the mutations to make]
set -euo pipefail
cd "$(dirname "$0")/../.."
word=${1:-}
git diff --quiet HEAD || { echo "mutations.sh: this checkout has changes; commit or stash them"; exit 1; }
log=$(mktemp) file=
restore() { [ -z "$file" ] || git checkout -q -- "$file"; }
trap 'restore; rm -f "$log"' EXIT

build() { cmake --build build/release --target stress >"$log" 2>&1; }
passes() { timeout 120 build/release/tests/stress/stress --gtest_filter="$1" --gtest_brief=1 >"$log" 2>&1; }

cmake --preset ci -DHDR_BUILD_TESTS=ON >/dev/null
build || { echo "mutations.sh: the stress tests do not build"; cat "$log"; exit 1; }
found=0 missed=0
while IFS='|' read -r name path expression filter; do
  case $name in '' | '#'*) continue ;; esac
  [[ -z $word || $name == *"$word"* ]] || continue
  filter=${filter// /}
  passes "$filter" || { echo "red before any mutation: $filter"; exit 1; }
  file=${path// /}
  sed -E -i "$expression" "$file"
  if git diff --quiet -- "$file"; then
    verdict="NOTHING CHANGED" missed=$((missed + 1))
  elif ! build; then
    verdict="DOES NOT BUILD" missed=$((missed + 1))
  elif passes "$filter"; then
    verdict="NOT FOUND" missed=$((missed + 1))
  else
    verdict="found" found=$((found + 1))
  fi
  printf '%-16s %s\n' "$verdict" "$name"
  restore
  file=
  build
done <tests/stress/mutations.txt
echo "$found found, $missed not"
[ "$missed" = 0 ]
