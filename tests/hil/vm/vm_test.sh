#!/usr/bin/env bash
# A virtual machine as users and tests start it, hil/vm/run: what it promises, and that nothing is left behind.
# usage: vm_test.sh BIN_DIR SOURCE_DIR
set -u
source "$(dirname "${BASH_SOURCE[0]}")/checks.sh"

# Without a kernel: one message that says what to do.
ARMADA_VM_CACHE=$work/none "$vm" -- true >"$work/out" 2>&1
[ $? = 125 ] || fail "without a kernel: not exit code 125"
grep -q 'hil/vm/image' "$work/out" || fail "without a kernel: $(cat "$work/out")"

# The command's words, status and output come through; a folder is written to; CAN is there, with echo when asked, and
# candump sees what is sent.
cat >"$work/inside" <<'END'
echo "words: $# $2"
cat /sys/module/vcan/parameters/echo
ip link add dev vcan5 type vcan && ip link set dev vcan5 mtu 72 up
candump -L -n 2 vcan5 >"$1/frames" &
until grep -q '^ *vcan5 ' /proc/net/can/rcvlist_all; do :; done
cansend vcan5 123#DEADBEEF
cansend vcan5 12345678##1AA
wait
touch "$1/written" || exit 1
! touch /written 2>/dev/null || exit 1
exit 42
END
"$vm" -o "$work/shared" -m 'vcan echo=1' -- bash "$work/inside" "$work/shared" 'two words' >"$work/out" 2>"$work/errors"
[ $? = 42 ] || fail "exit code: $(cat "$work/out" "$work/errors")"
[ "$(cat "$work/out")" = "$(printf 'words: 2 two words\nY')" ] || fail "output: $(cat "$work/out")"
[ -e "$work/shared/written" ] || fail "a file written in the guest is not here"
[ "$(cut -d ' ' -f 2- "$work/shared/frames")" = "$(printf 'vcan5 123#DEADBEEF\nvcan5 12345678##5AA')" ] ||  # 1: bit rate switched; 4: the kernel says that it is CAN FD
  fail "candump: $(cat "$work/shared/frames")"

# Killed or interrupted, the virtual machine ends.
guests() { pgrep -f "qemu-system-x86_64 .*$work/" >/dev/null; }
wait_for() { # wait_for SECONDS COMMAND...
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $deadline ] || return 1
    read -rt 0.05 <> <(:) || true
  done
}
no_guest() { ! guests; }
for signal in TERM KILL; do
  "$vm" -- tail -f /dev/null >"$work/out" 2>&1 &
  run=$!
  wait_for 20 guests || fail "the guest did not start: $(cat "$work/out")"
  kill -$signal $run
  wait $run 2>/dev/null
  wait_for 10 no_guest || fail "SIG$signal left the virtual machine behind"
done

finish
