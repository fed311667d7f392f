# What tests of commands share; sourced. It counts in $failures and keeps the last output in $work/out.
# shellcheck shell=bash disable=SC2154  # work: of the test
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# expect CODES PATTERN COMMAND...: the exit code is one of them, and a line of its output.
expect() {
  local codes=$1 pattern=$2
  shift 2
  "$@" >"$work/out" 2>&1
  local got=$?
  [[ " $codes " == *" $got "* ]] || fail "exit code $got, not $codes: $*: $(cat "$work/out")"
  grep -qE -- "$pattern" "$work/out" || fail "no line matches '$pattern': $*: $(cat "$work/out")"
}
