# How every target of the project is made: one standard, one set of warnings, includes from the root.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(mapweld_options INTERFACE)
target_include_directories(mapweld_options INTERFACE "${CMAKE_SOURCE_DIR}")
target_compile_options(mapweld_options INTERFACE -Wall -Wextra)
# GCC 12 warns of overlapping copies in "text" + std::string(...) where there are none (GCC bug 105651, mended in 13).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(mapweld_options INTERFACE -Wno-restrict)
endif()
# Words, votes and verdicts must be the same on every processor: no fused multiply-add that one machine has and
# another has not, no -march. What needs wide registers dispatches at run time.
target_compile_options(mapweld_options INTERFACE -ffp-contract=off)
if(MAPWELD_WERROR)
  target_compile_options(mapweld_options INTERFACE -Werror)
endif()
if(MAPWELD_SANITIZE)
  target_compile_options(mapweld_options INTERFACE
    "-fsanitize=${MAPWELD_SANITIZE}" -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # Instrumented, the standard library's own <regex> looks uninitialized to GCC.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(mapweld_options INTERFACE -Wno-maybe-uninitialized)
  endif()
  target_link_options(mapweld_options INTERFACE "-fsanitize=${MAPWELD_SANITIZE}")
endif()

# mapweld_library(name SOURCES ... LINK ... [PRIVATE_LINK ...]): a static library of one folder.
function(mapweld_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC mapweld_options ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
endfunction()

# mapweld_test(name SOURCES ... LINK ... [LABELS ...] [TIMEOUT s]): a GoogleTest program; each TEST is a ctest entry.
function(mapweld_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE mapweld_options ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()

# mapweld_benchmark(name SOURCES ... LINK ...): a Google Benchmark program; built, not run, by the test suite.
function(mapweld_benchmark name)
  if(MAPWELD_BENCHMARKS)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE mapweld_options ${ARG_LINK} benchmark::benchmark benchmark::benchmark_main)
  endif()
endfunction()
