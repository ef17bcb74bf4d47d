#!/usr/bin/env bash
# The tests under sanitizers: addresses and undefined behaviour over the unit tests and the seeds of the fuzzers, threads
# over what runs in parallel, and half a minute of libFuzzer for each reader. All of it, from nothing, takes over an hour.
#
#   tests/sanitize.sh                        everything
#   tests/sanitize.sh asan:merge fuzz:jpeg   some parts; --list names them all
#   tests/sanitize.sh --minutes 10           what that time allows; what is left out is named, and another part comes
#                                            first after each commit, so that all have their turn
#
# Exit code 1 when a part failed. One that time ran out on is left out, and no failure.
set -uo pipefail
cd "$(dirname "$0")/.."
source samples/packages.sh

modules=(core io response align merge filter probe light render capture report)
parallel=(core merge align filter probe light render)
fuzzers=(radiance pfm exposure_list response jpeg dng map)
every=("${modules[@]/#/asan:}" asan:fuzz "${parallel[@]/#/tsan:}" "${fuzzers[@]/#/fuzz:}")

quietly() { "$@" >build/sanitize.log 2>&1 || { cat build/sanitize.log; return 1; }; }

# run_part SANITIZER NAME: builds what that part needs, and runs it.
run_part() {
  local preset=$1 name=$2 target label seeds=../shared/data/formats
  if [ "$preset" = fuzz ]; then install_packages "${HDR_FUZZ_PACKAGES[@]}" || return 1; fi
  mkdir -p build
  quietly cmake --preset "$preset" -DHDR_BUILD_TESTS=ON || return 1
  case $preset:$name in
    fuzz:*) target=fuzz_$name label= ;;
    asan:fuzz) target=fuzzers label=fuzz ;;
    *) target=unit_$name label=unit_$name ;;
  esac
  quietly cmake --build "build/$preset" --target "$target" || return 1
  if [ -n "$label" ]; then
    quietly ctest --test-dir "build/$preset" --output-on-failure -j "$(nproc)" -L "^$label\$"
    return
  fi
  mkdir -p "build/fuzz/corpus/$name"
  [ -d "$seeds" ] || seeds=
  LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp quietly "build/fuzz/tests/fuzz/$target" -max_total_time=30 \
    -rss_limit_mb=4096 -timeout=60 -artifact_prefix=build/fuzz/ "build/fuzz/corpus/$name" $seeds
}

minutes=0 parts=()
while [ $# -gt 0 ]; do
  case $1 in
    --list) printf '%s\n' "${every[@]}"; exit ;;
    --part) run_part "${2%%:*}" "${2##*:}"; exit ;;
    --minutes) minutes=${2:?--minutes wants a number}; shift 2 ;;
    *)
      case " ${every[*]} " in *" $1 "*) ;; *) echo "tests/sanitize.sh: no part $1; see --list" >&2; exit 1 ;; esac
      parts+=("$1"); shift ;;
  esac
done
if [ ${#parts[@]} = 0 ]; then
  first=0
  if [ "$minutes" != 0 ]; then first=$(( $(git rev-list --count HEAD 2>/dev/null || echo 0) % ${#every[@]} )); fi
  parts=("${every[@]:first}" "${every[@]:0:first}")
fi

install_packages "${HDR_BUILD_PACKAGES[@]}" "${HDR_TEST_PACKAGES[@]}" || exit 1
SECONDS=0 passed=() left_out=() failed=()
for part in "${parts[@]}"; do
  limit=0 began=$SECONDS
  if [ "$minutes" != 0 ]; then
    limit=$((minutes * 60 - SECONDS))
    if [ "$limit" -le 0 ]; then left_out+=("$part"); continue; fi
  fi
  timeout -k 10 "$limit" bash tests/sanitize.sh --part "$part"
  case $? in
    0) passed+=("$part"); verdict=passed ;;
    124 | 137) left_out+=("$part"); verdict="no time" ;;
    *) failed+=("$part"); verdict=FAILED ;;
  esac
  echo "$part: $verdict, $((SECONDS - began)) s"
done
echo "sanitizers: passed ${passed[*]:-none}; failed ${failed[*]:-none}; left out for want of time ${left_out[*]:-none}"
[ ${#failed[@]} = 0 ]
