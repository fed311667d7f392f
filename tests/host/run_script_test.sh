#!/usr/bin/env bash
# States what ./run promises, with stand-ins for apt-get, dpkg-query and cmake: nothing is installed or built.
# usage: run_script_test.sh RUN_SCRIPT
set -euo pipefail

run_script=$(readlink -f "$1")
box=$(mktemp -d)
trap 'rm -rf "$box"' EXIT
mkdir -p "$box/bin" "$box/project"
cp "$run_script" "$box/project/run"
cd "$box"

stand_in() { # NAME, body on standard input
  { echo '#!/bin/bash'; echo "box=$box"; cat; } >"$box/bin/$1"
  chmod +x "$box/bin/$1"
}
# All packages are there but those listed in the file `missing`.
stand_in dpkg-query <<'END'
for name in "${@:4}"; do grep -qx "$name" "$box/missing" || echo "$name installed"; done
END
# Notes its calls; fails as often as the file `failures` says.
stand_in apt-get <<'END'
echo "$DEBIAN_FRONTEND $*" >>"$box/apt_calls"
if [[ $* == *install* && -s $box/failures ]]; then
  sed -i 1d "$box/failures"
  echo 'E: Unable to locate package'
  exit 1
fi
END
# Builds programs that note their arguments; `armada run` exits as the file `run_exit_code` says. Makes the tests that the
# file `tests` lists for ctest, which is the real one.
stand_in cmake <<'END'
echo "$*" >>"$box/cmake_calls"
[[ $1 != --preset ]] || { mkdir -p "build/$2"; cp "$box/tests" "build/$2/CTestTestfile.cmake"; }
[[ ! -f $box/build_is_broken ]] || { echo '[1/2] Building'; echo 'a.cpp:1: error: broken'; exit 1; }
if [[ $* == "--build --preset sanitize"* ]]; then
  [[ ! -f $box/sanitize_is_broken ]] || { echo 'b.cpp:1: error: broken'; exit 1; }
  [[ ! -f $box/sanitize_takes_long ]] || sleep 60.25
fi
[[ ! -f build/release/old.pch ]] || { echo "fatal error: modified since the precompiled header 'old.pch'"; exit 1; }
mkdir -p build/release/bin
cat >build/release/bin/armada <<'PROGRAM'
#!/bin/bash
echo "armada $*"
[[ $1 != run ]] || { mkdir -p out/demo; : >out/demo/metrics.json; exit "$(cat run_exit_code)"; }
PROGRAM
chmod +x build/release/bin/armada
END
stand_in sudo <<'END'
exec "$@"
END
export PATH="$box/bin:/usr/sbin:/usr/bin:/sbin:/bin"

# given MISSING_PACKAGES APT_FAILURES RUN_EXIT_CODE: a fresh checkout in these circumstances.
given() {
  rm -rf project/build project/out apt_calls cmake_calls build_is_broken
  tr ' ' '\n' <<<"$1" >missing
  seq "$2" >failures
  echo "$3" >project/run_exit_code
  : >apt_calls
  : >tests
}

# when ARGUMENT...: runs the script without input, from another folder; leaves $code and the file `output`.
when() {
  code=0
  (cd / && "$box/project/run" "$@") </dev/null >output 2>&1 || code=$?
}

failed_checks=0
check() { # DESCRIPTION CONDITION...
  "${@:2}" || {
    echo "FAILED: $1"
    sed 's/^/  | /' output
    failed_checks=$((failed_checks + 1))
  }
}
says() { grep -qF -- "$1" output; }
silent_about() { ! says "$1"; }
ends_with() { tail -n 2 output | grep -qE "$1"; }

given '' 0 0
when dance
check 'an unknown command is a usage error' test "$code" = 2
check 'and its message names what there is' says "unknown command 'dance'; there are: build, campaign, demo, fuzz, hil, lint, test, help"
when test -R
check '-R without a pattern is a usage error' test "$code" = 2
when build now
check 'build takes no arguments' test "$code" = 2
when hil now
check 'hil takes no arguments' test "$code" = 2
when campaign --phases many
check 'the phases of a campaign are a number' test "$code" = 2
when campaign --phases 3 --guests
check 'and --guests comes first' test "$code" = 2
when campaign --seed
check 'and an option of it has a value' test "$code" = 2
when help
check 'help succeeds' test "$code" = 0
check 'none of them installs or builds anything' test ! -s apt_calls -a ! -e cmake_calls

when build
check 'build succeeds' test "$code" = 0
check 'and calls no apt-get when nothing is missing' test ! -s apt_calls
check 'and makes the programs, not the tests' \
  grep -qx -- '--build --preset release --target bin/armada bin/armada-arm bin/armada-leader bin/armada-hil' cmake_calls

check 'and tells the time of the stage' grep -qE '^build release +[0-9]+\.[0-9] s' output
check 'and of all' ends_with '^in all +[0-9]+\.[0-9] s'

given 'cmake gnuplot-nox' 0 0
when build
check 'a missing package is named with its reason' says 'cmake                configures the build'
check 'packages that are there are not' silent_about 'ninja-build'
check 'and its time is told' grep -qE '^packages +[0-9]+\.[0-9] s' output
check 'only missing ones are installed, with no questions and no extras' grep -qx \
  'noninteractive -q -o DPkg::Lock::Timeout=300 install --yes --no-install-recommends cmake gnuplot-nox' apt_calls
check 'test tools are not needed to build' silent_about 'clang-tidy'

given 'cmake' 1 0
when build
check 'a package that is not found is tried again' test "$code" = 0
check 'with fresh lists' test "$(cut -d ' ' -f 5 apt_calls | xargs)" = 'install update install'

given 'cmake' 2 0
when build
check 'a second failure is final' test "$code" = 1
check 'and shows what apt-get said' says 'Unable to locate package'
check 'and where all of it is' says 'out/setup.log'
check 'and builds nothing' test ! -e cmake_calls

given '' 0 0
touch build_is_broken
when build
check 'a broken build fails' test "$code" = 1
check 'and shows the error' says 'a.cpp:1: error: broken'
check 'without the progress lines' silent_about '[1/2]'

given '' 0 0
when demo --seed 7
check 'the demo runs the paper for 20 s with further options' \
  says 'armada run hil/scenarios/paper.toml --seconds 20 --time stepped --out out/demo --seed 7'
check 'and reports' says 'armada report out/demo'
check 'and succeeds' test "$code" = 0

# Stand-ins for what hil/vm does: the kernels, and two runs with a line of figures.
mkdir -p project/hil/vm
printf '#!/bin/bash\necho "image into $ARMADA_VM_CACHE" >>%q\n' "$box/vm_calls" >project/hil/vm/image
printf '#!/bin/bash\necho "hil $* $ARMADA_VM_CACHE" >>%q\necho figures\nexit "$(cat run_exit_code)"\n' "$box/vm_calls" \
  >project/hil/vm/hil
mkdir -p project/hil/campaign
for place in in_guests in_stepped_time; do
  printf '#!/bin/bash\necho "%s $* $ARMADA_VM_CACHE" >>%q\necho figures\nexit "$(cat run_exit_code)"\n' $place \
    "$box/vm_calls" >project/hil/campaign/$place
done
chmod +x project/hil/vm/* project/hil/campaign/*
export ARMADA_VM_CACHE=$box/kernels
given '' 0 0
when hil
check 'hil succeeds' test "$code" = 0
check 'and gets the kernels, then runs' test "$(cat vm_calls)" = \
  "$(printf '%s\n' "image into $box/kernels" "hil build/release/bin out/hil $box/kernels")"
check 'and prints the figures' says 'figures'
given '' 0 1
when hil
check 'a hil that fails is a failure' test "$code" = 1
given '' 0 0
: >vm_calls
when campaign --phases 20 --seed 3
check 'a campaign runs with its options' test "$(cat vm_calls)" = \
  "in_stepped_time build/release/bin out/processes_in_stepped_time --phases 20 --seed 3 $box/kernels"
check 'and prints the figures' says 'figures'
: >vm_calls
when campaign --guests --phases 20
check 'in guests it gets the kernels first' test "$(cat vm_calls)" = "$(printf '%s\n' \
  "image into $box/kernels" "in_guests build/release/bin out/processes_in_guests --phases 20 $box/kernels")"
given '' 0 1
when campaign
check 'a campaign with a finding is a failure' test "$code" = 1
given '' 0 0
mkdir -p project/tests/core
touch project/tests/core/CMakeLists.txt
cat >tests <<'END'
add_test(core.Supervisor.Stops true)
add_test(core.Supervisor.Waits true)
add_test(host.Report.IsWritten true)
END
builds() { [[ $(grep -o -- '--target .*' cmake_calls | sort -u) == "--target $1" ]]; }
when test -R core
check 'tests of a folder pass, in both builds' test "$(tail -n 1 output)" = 'tests: 4 passed, 0 failed'
check 'and nothing else is built' builds tests/core/all
check 'and the time of all stands before' ends_with '^in all +[0-9]+\.[0-9] s'
rm cmake_calls
when test -R core.Supervisor.Waits
check 'one test of a folder alone' test "$(tail -n 1 output)" = 'tests: 2 passed, 0 failed'
check 'builds that folder only, too' builds tests/core/all
for regex in Report 'core|host' cor; do
  rm cmake_calls
  when test -R "$regex"
  check "$regex is no folder: all is built" builds all
done
check 'and what matches is run' test "$(tail -n 1 output)" = 'tests: 4 passed, 0 failed'
when test -R nothing
check 'a pattern without a test fails' test "$code" = 1
echo 'add_test(core.Supervisor.Breaks false)' >>tests
when test -R core
check 'a test that fails is a failure' test "$code" = 1
check 'and is named' says 'core.Supervisor.Breaks'
check 'and counted' test "$(tail -n 1 output)" = 'tests: 2 passed, 1 failed'
check 'after the time of all' ends_with '^in all +[0-9]+\.[0-9] s'
touch sanitize_takes_long
when test -R core
check 'then nobody waits for the build that goes on beside' says 'tests: 2 passed, 1 failed'
check 'which ends' timeout 5 bash -c 'while pgrep -f "sleep 60.2[5]"; do :; done'
check 'without a word of the shell' silent_about 'erminated'
rm sanitize_takes_long
sed -i '$d' tests
touch sanitize_is_broken
when test -R core
check 'a build with sanitizers that fails is a failure' test "$code" = 1
check 'with its message' says 'b.cpp:1: error: broken'
check 'and says which build it was' says 'the sanitize build failed'
rm sanitize_is_broken

given '' 0 0
mkdir -p project/build/release
touch project/build/release/old.pch
when build
check 'what was precompiled of former headers is made anew' test "$code" = 0

given '' 0 0
when fuzz --seconds 0
check 'a fuzzer runs for some time' test "$code" = 2

given 'qemu-system-x86' 0 0
when hil
check 'hil installs the virtual machine' says "qemu-system-x86      runs Debian's kernels"

given '' 0 1
when demo
check 'a demo that misses its criterion fails' test "$code" = 1
check 'but is reported' says 'armada report out/demo'

given '' 0 1
sed -i 's/: >out.demo.metrics.json;//' bin/cmake
when demo
check 'a demo that broke off fails' test "$code" = 1
check 'and there is nothing to report' silent_about 'armada report'

given '' 0 0
mkdir -p project/build/release
flock project/build/release/.lock sleep 1 &
while flock --nonblock project/build/release/.lock true; do :; done
when build
check 'a build waits for another one in its folder' says 'another ./run builds in build/release; waiting'
check 'and then succeeds' test "$code" = 0
wait

given '' 0 78
when demo
check 'a configuration error is passed on' test "$code" = 78
check 'and not reported' silent_about 'armada report'

((failed_checks == 0)) || exit 1
echo 'all as promised'
