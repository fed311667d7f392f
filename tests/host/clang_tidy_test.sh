#!/usr/bin/env bash
# States what cmake/cached_clang_tidy.py promises, on a small project with planted faults: batches drop no finding, what
# passed is not checked again. usage: clang_tidy_test.sh SOURCE_DIR
set -euo pipefail
source_dir=$(readlink -f "$1")
box=$(mktemp -d)
trap 'rm -rf "$box"' EXIT
cd "$box"
mkdir -p cmake firmware build/one
cp "$source_dir/cmake/cached_clang_tidy.py" cmake
cp "$source_dir/.clang-tidy" .

cat >firmware/shared.h <<'END'
#pragma once
namespace shared {
struct Arm {};
inline int Twice(int value) { return 2 * value; }
}
END
# Two that fit in one batch, two that declare the same name, and two of which one hides the other's unused declaration.
echo '#include "firmware/shared.h"
int First() { return shared::Twice(1); }' >firmware/first.cpp
echo '#include "firmware/shared.h"
int Second() { return shared::Twice(2); }' >firmware/second.cpp
for name in third fourth; do
  printf 'namespace {\nint Own(int x) {\n  return x;\n}\n}\nint %s() { return Own(3); }\n' $name >firmware/$name.cpp
done
echo '#include "firmware/shared.h"
void UsesArm(shared::Arm /*arm*/) {}' >firmware/user.cpp

batch=build/one/Unity/unity_0_cxx.cxx  # as CMake makes them

lint() { # leaves $code and the file `output`
  {
    printf 'rule cc\n  command = g++ -std=c++20 $flags -I%s -o $out -c $in -MD -MF $out.d\n  deps = gcc\n  depfile = $out.d\n' "$box"
    for file in firmware/*.cpp; do
      printf 'build %s.o: cc %s\n  flags = %s\n' "$(basename $file)" "$box/$file" "$(sed -n 's/^flags //p' $file.flags 2>/dev/null)"
    done
    [[ ! -e $batch ]] || printf 'build batch.o: cc %s\n' "$box/$batch"
  } >build/one/build.ninja
  ninja -C build/one >/dev/null
  ninja -C build/one -t compdb >build/one/compile_commands.json
  code=0
  /usr/bin/python3 cmake/cached_clang_tidy.py build/cache build/one >output 2>&1 || code=$?
}

failed=0
check() { # DESCRIPTION CONDITION...
  "${@:2}" || {
    echo "FAILED: $1"
    sed 's/^/  | /' output
    failed=1
  }
}
says() { grep -qF -- "$1" output; }

lint
check 'a clean project passes' test "$code" = 0
check 'and all of it is checked' says '5 files, 5 checked'
lint
check 'only once' says '5 files, 0 checked'
touch firmware/first.cpp
lint
check 'times do not matter' says '5 files, 0 checked'

echo 'int* Nowhere() { return 0; }' >>firmware/second.cpp
lint
check 'a fault fails' test "$code" = 1
check 'and is named' says 'firmware/second.cpp:3:25: error: use nullptr [modernize-use-nullptr'
check 'only what changed is checked' says '5 files, 1 checked'
echo '// A changed header changes all that includes it.' >>firmware/shared.h
lint
check 'a fault in a batch is found' says 'firmware/second.cpp:3:25: error: use nullptr [modernize-use-nullptr'
check 'of all that the header changed' says '5 files, 3 checked'
lint
check 'the others of the batch have passed' says '5 files, 1 checked'
sed -i '$d' firmware/second.cpp

cp firmware/shared.h clean.h
printf 'inline int* Nowhere() {\n  return 0;\n}\n' >>firmware/shared.h
lint
check 'a fault in a header is found' says 'firmware/shared.h:8:10: error: use nullptr'
cp clean.h firmware/shared.h
lint
check 'a mended header passes' test "$code" = 0

sed -i '1a using shared::Arm;' firmware/first.cpp
echo '// changed' >>firmware/user.cpp
lint
check 'what another source of the batch uses is unused in this one' says 'using decl '\''Arm'\'' is unused'
check 'and in no other' says '5 files, 2 checked'
sed -i 2d firmware/first.cpp

mkdir -p build/one/Unity firmware/batch
for name in sixth seventh; do
  printf 'int %s() {\n  return 6;\n}\n' $name >firmware/batch/$name.cpp
  printf '#include "%s"\n\n' "$box/firmware/batch/$name.cpp" >>$batch
done
lint
check 'the sources of a batch of the compiler are checked' says '7 files, 2 checked'
echo 'int* Nowhere() { return 0; }' >>firmware/batch/seventh.cpp
lint
check 'a fault in one is found' says 'firmware/batch/seventh.cpp:4:25: error: use nullptr [modernize-use-nullptr'
check 'and the other is not checked again' says '7 files, 1 checked'

# Macros: what another source of the batch is compiled with hides nothing. The only fault is one that would be hidden.
sed -i '$d' firmware/batch/seventh.cpp
echo 'int Other() { return 1; }' >firmware/other.cpp
echo 'flags -DOTHER=1' >firmware/other.cpp.flags
lint
check 'no fault is left' test "$code" = 0
touch_all() { for file in firmware/*.cpp; do echo '// again' >>"$file"; done; }
printf '#ifndef OTHER\nint* Without() { return 0; }\n#endif\n' >firmware/without.cpp
touch_all
lint
check 'nor the macro of another source' says 'firmware/without.cpp:2:25: error: use nullptr'
rm firmware/without.cpp
echo 'flags -DOTHER=2' >firmware/two.cpp.flags
printf '#if OTHER == 2\nint* WithTwo() { return 0; }\n#endif\n' >firmware/two.cpp
touch_all
lint
check 'nor another value of it' says 'firmware/two.cpp:2:25: error: use nullptr'
rm firmware/two.cpp

# Each fuzzer has the same entry.
for name in eighth ninth; do
  printf 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long);\nextern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }\n' >firmware/$name.cpp
done
echo 'int* Nowhere() { return 0; }' >>firmware/ninth.cpp
lint
check 'a fault in a fuzzer is found' says 'firmware/ninth.cpp:3:25: error: use nullptr'

((failed == 0)) || exit 1
echo 'all as promised'
