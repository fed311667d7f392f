#!/usr/bin/env bash
# Runs all fuzzers, one on each processor, from seeds made on the spot. One line each; exit code 1 on a finding, with
# the input that leads to it.
# usage: run_fuzzers.sh BUILD_DIR OUT_DIR SECONDS
set -euo pipefail

if (($# != 3)) || ! [[ $3 =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: run_fuzzers.sh BUILD_DIR OUT_DIR SECONDS, was given: $*" >&2
  exit 2
fi
export fuzzers=$1/fuzzers out=$2
rm -rf "$out"
mkdir -p "$out"
"$1/fuzz_corpus" "$out/corpus"

# fuzz NAME SECONDS. The same seed, so that what is found once is found again.
fuzz() {
  local log=$out/$1.log status=0 executions coverage
  UBSAN_OPTIONS=print_stacktrace=1 "$fuzzers/$1" -seed=1 -max_total_time="$2" -max_len=400 -timeout=20 \
    -artifact_prefix="$out/$1-" -print_final_stats=1 "$out/corpus/$1" </dev/null >"$log" 2>&1 || status=$?
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  coverage=$(grep -aoE 'cov: [0-9]+' "$log" | tail -n 1 | cut -d ' ' -f 2 || true)
  if ((status == 0)); then
    printf '%-21s %9s executions, %4s edges, no finding\n' "$1" "$executions" "$coverage"
    return
  fi
  printf '%-21s FINDING, reproduce with: %s %s\n' "$1" "$fuzzers/$1" "$(ls "$out/$1"-* 2>/dev/null || echo "(see $log)")"
  grep -aE -A 12 '^violated:|runtime error:|ERROR:' "$log" | head -n 30
  return 1
}
export -f fuzz

# Files and the operator's board get half of the time each. Parsers and seals have little state and are exhausted soon: a
# sixth.
{
  printf '%s '"$3"'\n' link odrive_cansimple odrive_cansimple_v05 mini_cheetah cubemars damiao cia402 moteus
  printf '%s '"$((($3 + 1) / 2))"'\n' fleet scenario operator
  printf '%s '"$((($3 + 5) / 6))"'\n' udp_frame lcm_packet lcm_messages seal
} | xargs -P "$(nproc)" -L 1 bash -c 'set -o pipefail; fuzz "$@"' fuzz || exit 1
