# What the guests of hil/vm have in common; sourced by run and run_virtual, which set $here and $guest_program.
# shellcheck shell=bash disable=SC2154

fail() {
  printf '%s: %s\n' "$guest_program" "$1" >&2
  exit 125
}

# find_kernel stock|rt: sets $kernel.
find_kernel() {
  kernel=${ARMADA_VM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/armada/vm}/$1
  [[ -f $kernel/vmlinux ]] || fail "no kernel in $kernel; get it with $here/image (it needs the network once)"
  local tool
  for tool in qemu-system-x86_64 busybox cpio modprobe; do
    command -v "$tool" >/dev/null ||
      fail "$tool is missing; install qemu-system-x86 busybox-static cpio kmod, as ./run does"
  done
}

# start_root: makes the folder $work and in it the root of the initramfs, $root. All of it goes with this program.
start_root() {
  work=$(mktemp -d)
  root=$work/root
  qemu=''
  trap '[[ -z $qemu ]] || kill -KILL "$qemu" 2>/dev/null || :; rm -rf "$work"' EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  trap 'exit 129' HUP
  mkdir -p "$root"/{bin,dev,proc,sys,run,tmp,modules}
  cp "$(command -v busybox)" "$root/bin/busybox"
}

# add_modules LIST NAME...: the modules and what they depend on, in order of loading. A name may carry options:
# 'vcan echo=1'. LIST, in the root, is the script that loads them.
add_modules() {
  local list=$1 version wanted names=() line file
  shift
  version=$(basename "$kernel"/lib/modules/*)
  declare -A options=()
  for wanted in "$@"; do
    names+=("${wanted%% *}")
    [[ $wanted != *' '* ]] || options[${wanted%% *}]=${wanted#* }
  done
  modprobe -C /dev/null -d "$kernel" -S "$version" -a -D "${names[@]}" >"$work/modules" 2>"$work/complaint" ||
    fail "the kernel in $kernel lacks a module of: ${names[*]}: $(head -n 1 "$work/complaint")"
  while read -r line file _; do
    [[ $line == insmod ]] || continue
    wanted=$(basename "${file%.ko}")
    [[ ! -e $root/modules/$wanted.ko ]] || continue
    cp "$file" "$root/modules/"
    echo "insmod /modules/$wanted.ko ${options[$wanted]:-}" >>"$root/$list"
  done <"$work/modules"
}

# pack: the root as $work/initramfs. Times and owners are fixed and the order is sorted, so that the same files give
# the same bytes. Not compressed: the guest would have to unpack it.
pack() {
  find "$root" -exec touch -h -d @0 {} +
  (cd "$root" && find . | LC_ALL=C sort | cpio --quiet -o -H newc --reproducible -R 0:0) >"$work/initramfs"
}

# boot KERNEL_ARGUMENTS QEMU_OPTION...: runs the guest to its end and leaves its command's exit status in $status. Its
# serial ports are the kernel's console, the command's output (to $output_port) and the exit status. Emulated,
# never with KVM, which a rented machine may offer and not bear; time is counted in instructions of 1 ns.
# Should this program be killed, the kernel ends qemu.
sleep=''  # ,sleep=off: a guest that waits for its next timer is there at once
output_port=stdio
beside=(:)  # called while the guest runs
# Hardening costs instructions, and there is nothing to protect.
lean='mitigations=off init_on_alloc=0 hardened_usercopy=off apparmor=0 audit=0 nowatchdog'
boot() {
  local arguments=$1
  shift
  pack
  setpriv --pdeathsig KILL qemu-system-x86_64 -nodefaults -no-user-config -display none -no-reboot -net none \
    -machine pc -cpu max,-rdrand,-rdseed -accel tcg -smp 1 -m 1024 -icount "shift=0$sleep" \
    -kernel "$kernel/vmlinux" -initrd "$work/initramfs" \
    -append "console=ttyS0 quiet loglevel=4 panic=-1 $lean $arguments" \
    -serial "file:$work/console" -serial "$output_port" -serial "file:$work/status" \
    "$@" </dev/null &
  qemu=$!
  "${beside[@]}"
  wait "$qemu" || true
  qemu=''
  status=$(tr -d '\r\n' <"$work/status") || true
  [[ $status =~ ^[0-9]+$ ]] || {
    tail -n 20 "$work/console" >&2 || true
    fail 'the guest ended before its command did; the end of its console is above'
  }
}
