# What compiling costs: how far code is optimised, and which headers come precompiled. docs/development.md has figures.
#
#   armada_code(hot TARGET...)    what runs in every tick of a board, of an emulation or of a simulation
#   armada_code(warm TARGET...)   what runs long in tests or fuzzers only: tests that calculate, judges, configuration
#   armada_code(cold TARGET...)   what runs once or for people: command lines, reports, other tests
#   armada_in_batches(TARGET...)  sources are compiled a few at a time, as one
#   armada_first(TARGET...)       of what several targets instantiate, programs get what these libraries have compiled

option(ARMADA_PCH "Precompile headers that are not ours" ON)
option(ARMADA_BATCHES "Compile several sources at once, where a target says so" ON)

# Boards and sweeps spend no time in warm and in cold code. A build with sanitizers is for finding defects: there cold code
# is compiled as fast as can be.
add_library(armada_hot INTERFACE)
add_library(armada_warm INTERFACE)
target_compile_options(armada_warm INTERFACE $<$<CONFIG:Release>:-O1>)
# At -O1 GCC 12 sees overlaps and overflows in std::string's operator+ that are not there (its bugs 105329, 105651).
target_compile_options(armada_warm INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>)
add_library(armada_cold INTERFACE)
target_link_libraries(armada_cold INTERFACE armada_warm)
if(ARMADA_SANITIZE)
  target_compile_options(armada_cold INTERFACE -O0)
endif()

# Our own headers change too often, and a source must name what it uses. GCC 12 instantiates what a precompiled header
# has left open in every source anew: with Eigen, GoogleTest, nlohmann/json or CLI11 in it, it becomes slower. Clang
# does not.
set(armada_precompiled
  <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <iostream> <map> <memory> <optional>
  <sstream> <string> <string_view> <variant> <vector>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  list(APPEND armada_precompiled <Eigen/Core>)
endif()
foreach(kind hot warm cold)
  add_library(armada_${kind}_headers OBJECT ${CMAKE_CURRENT_LIST_DIR}/headers.cpp)
  target_link_libraries(armada_${kind}_headers PRIVATE armada_options armada_${kind})
  if(ARMADA_PCH)
    target_precompile_headers(armada_${kind}_headers PRIVATE ${armada_precompiled})
  endif()
endforeach()

function(armada_code kind)
  foreach(target IN LISTS ARGN)
    target_link_libraries(${target} PRIVATE armada_${kind})
    if(ARMADA_PCH)
      target_precompile_headers(${target} REUSE_FROM armada_${kind}_headers)
    endif()
  endforeach()
endfunction()

# The linker keeps the first of several copies of an inline function, and the objects of a program come first: with
# sanitizers a controller would run Eigen as its cold code or its test has compiled it, without optimisation.
function(armada_first)
  if(ARMADA_SANITIZE)
    foreach(target IN LISTS ARGN)
      target_link_options(${target} INTERFACE LINKER:--whole-archive,$<TARGET_FILE:${target}>,--no-whole-archive)
    endforeach()
  endif()
endfunction()

# What templates of the standard library and of Eigen instantiate is shared by a batch. Names of one batch must not clash,
# those in unnamed namespaces included: give helpers that two sources have the same name one place, or two names.
function(armada_in_batches)
  set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ${ARMADA_BATCHES} UNITY_BUILD_BATCH_SIZE 10)
endfunction()
