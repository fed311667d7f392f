# What tests of virtual machines share: $bin, $source, $vm, an empty folder $work, fail and finish.
bin=$1
source=$2
vm=$source/hil/vm/run
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export TMPDIR=$work
mkdir "$work/shared"
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

finish() {
  [ $failures = 0 ] && echo "virtual machine: all as promised"
  exit $((failures > 0))
}
