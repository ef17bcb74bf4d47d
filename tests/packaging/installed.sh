#!/usr/bin/env bash
# installed.sh BUILD SOURCE: installs to a folder of its own and builds a stranger's program against that, once by
# find_package and once by pkg-config. The build tree is not on any path that they are given.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/usr" >"$work/log" || { cat "$work/log"; exit 1; }

echo "-- the installed command runs"
"$work/usr/bin/hdr" --version

if grep -rlE "$build|$source" "$work/usr" --include='*.cmake' --include='*.pc' --include='*.h'; then
  echo "these installed files name the folders they were built in: they are of no use elsewhere" >&2
  exit 1
fi

echo "-- find_package(hdr)"
cp -r "$source/tests/packaging/consumer" "$work/consumer"
cmake -S "$work/consumer" -B "$work/by-cmake" -DCMAKE_PREFIX_PATH="$work/usr" -DCMAKE_BUILD_TYPE=Debug >"$work/log" ||
  { cat "$work/log"; exit 1; }
cmake --build "$work/by-cmake" >"$work/log" || { cat "$work/log"; exit 1; }
(cd "$work" && ./by-cmake/consumer)

echo "-- pkg-config"
export PKG_CONFIG_PATH=$(dirname "$(find "$work/usr" -name hdr.pc)")
flags=$(pkg-config --cflags --libs hdr)
# shellcheck disable=SC2086  # flags are words
g++ -std=c++20 "$work/consumer/consumer.cpp" -o "$work/by-pkg-config" $flags
(cd "$work" && ./by-pkg-config)
