# What tests of commands share; sourced. It counts in $failures and keeps the last output in $work/out.
# shellcheck shell=bash disable=SC2154  # work: of the test
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# expect CODE PATTERN COMMAND...: the exit code, and a line of its output.
expect() {
  local code=$1 pattern=$2
  shift 2
  "$@" >"$work/out" 2>&1
  local got=$?
  [[ "$got" =~ ^($code)$ ]] || fail "exit code $got, not $code: $*: $(cat "$work/out")"
  grep -qE -- "$pattern" "$work/out" || fail "no line matches '$pattern': $*: $(cat "$work/out")"
}
