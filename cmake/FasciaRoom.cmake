# One room of the house, one library target.
#
#   fascia_room(NAME [COLD] [SOURCES file...] [PUBLIC target...] [PRIVATE target...])
#
# makes the static library fascia_NAME with the alias fascia::NAME. Headers are included
# by their path from the root of the project: #include "geometry/mesh.h". COLD: no inner loops in it, so it is
# optimised less, which compiles a third faster.

find_program(FASCIA_CCACHE ccache)
if(FASCIA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Objects that include a precompiled header are cached only when its macros are trusted.
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${FASCIA_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_C_COMPILER_LAUNCHER})
endif()

# For another system (emscripten, mingw-w64) only the header libraries of this one serve, without its C headers.
if(CMAKE_CROSSCOMPILING)
  set(FASCIA_HEADERS ${PROJECT_BINARY_DIR}/headers)
  file(MAKE_DIRECTORY ${FASCIA_HEADERS})
  foreach(header nlohmann tiny_gltf.h eigen3)
    if(NOT EXISTS /usr/include/${header})
      message(FATAL_ERROR "fascia: /usr/include/${header} is missing: run scripts/setup.sh --full")
    endif()
    file(CREATE_LINK /usr/include/${header} ${FASCIA_HEADERS}/${header} SYMBOLIC)
  endforeach()
  add_library(Eigen3::Eigen INTERFACE IMPORTED)
  target_include_directories(Eigen3::Eigen INTERFACE ${FASCIA_HEADERS}/eigen3)
  add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED)
  target_include_directories(nlohmann_json::nlohmann_json INTERFACE ${FASCIA_HEADERS})
  include_directories(SYSTEM ${FASCIA_HEADERS})  # tinygltf
else()
  find_package(Eigen3 3.4 REQUIRED NO_MODULE)
  find_package(nlohmann_json 3.11 REQUIRED)
endif()

add_library(fascia_options INTERFACE)
target_include_directories(fascia_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/fascia-builder>)
# Contraction into fused multiply-add changes values between machines; snapshots would differ.
if(MSVC AND NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  target_compile_options(fascia_options INTERFACE $<BUILD_INTERFACE:/W4;/fp:precise;/utf-8>)
elseif(MSVC)  # clang-cl
  target_compile_options(fascia_options INTERFACE
    $<BUILD_INTERFACE:/W4;/clang:-ffp-contract=off;-Wno-microsoft-include>)
else()
  target_compile_options(fascia_options INTERFACE
    $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-ffp-contract=off>)
endif()
# Eigen cuts large products to the processor's caches, and the order of sums with them: fixed sizes give the same bits
# on every processor.
target_compile_definitions(fascia_options INTERFACE
  $<BUILD_INTERFACE:EIGEN_NO_CPUID;EIGEN_DEFAULT_L2_CACHE_SIZE=524288>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms of g++ 12 in std::string's operator+.
  target_compile_options(fascia_options INTERFACE
    $<BUILD_INTERFACE:-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>)
  # More memory before the compiler looks for garbage in it: a tenth of its time, for half a gigabyte at most.
  target_compile_options(fascia_options INTERFACE $<BUILD_INTERFACE:--param=ggc-min-heapsize=524288>)
endif()
# Outside the loops on lanes, which ask for it themselves, -O3 gains a hundredth of a frame's instructions and costs a
# tenth of the build. Results are the same bits at every level: no floating-point operation may be reordered.
target_compile_options(fascia_options INTERFACE
  $<BUILD_INTERFACE:$<$<CONFIG:Release>:$<IF:$<BOOL:$<TARGET_PROPERTY:FASCIA_COLD>>,-O1,-O2>>>)
if(FASCIA_WARNINGS_AS_ERRORS)
  target_compile_options(fascia_options INTERFACE $<BUILD_INTERFACE:$<IF:$<BOOL:${MSVC}>,/WX,-Werror>>)
endif()
if(FASCIA_SANITIZE)
  target_compile_options(fascia_options INTERFACE -fsanitize=${FASCIA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(fascia_options INTERFACE -fsanitize=${FASCIA_SANITIZE})
  if(FASCIA_SANITIZE MATCHES undefined)  # else it is printed, and the test passes
    target_compile_options(fascia_options INTERFACE -fno-sanitize-recover=undefined)
  endif()
endif()
add_library(fascia::options ALIAS fascia_options)
set(FASCIA_LOOP_OPTIONS $<$<CONFIG:Release>:$<IF:$<BOOL:${MSVC}>,/O2,-O3>>)

# The headers that most files parse, once for all rooms of one level of optimisation: g++ takes the level from a
# precompiled header, whatever its command line says. Clang's would be rebuilt with every time stamp.
function(fascia_common_headers target)
  add_library(${target} OBJECT ${PROJECT_SOURCE_DIR}/cmake/common_headers.cpp)
  target_link_libraries(${target} PRIVATE fascia::options Eigen3::Eigen)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_precompile_headers(${target} PRIVATE
      <algorithm> <array> <cmath> <cstdint> <cstdio> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers>
      <optional> <random> <set> <span> <sstream> <string> <vector> <Eigen/Core> <Eigen/Geometry> <Eigen/LU> ${ARGN})
  endif()
endfunction()
fascia_common_headers(fascia_common_headers)
fascia_common_headers(fascia_common_headers_cold <nlohmann/json.hpp>)
set_target_properties(fascia_common_headers_cold PROPERTIES FASCIA_COLD ON)

# fascia_use_common_headers(TARGET [COLD]): for targets whose sources include Eigen and are compiled with the common options.
function(fascia_use_common_headers target)
  set(headers fascia_common_headers)
  if("COLD" IN_LIST ARGN)
    set(headers fascia_common_headers_cold)
    set_target_properties(${target} PROPERTIES FASCIA_COLD ON)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ refuses a precompiled header of -fPIC in a source of -fPIE, which CMake gives to programs.
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "EXECUTABLE")
      set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
      target_compile_options(${target} PRIVATE -fPIC)
    endif()
    target_precompile_headers(${target} REUSE_FROM ${headers})
  endif()
endfunction()

# Sources of a room compiled several at a time parse their headers once: a first build takes a quarter less time, one
# changed file brings its batch along. Names in anonymous namespaces must differ within a room.
option(FASCIA_BATCHES "Compile the sources of a room in batches" OFF)
function(fascia_compile_in_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${FASCIA_BATCHES} UNITY_BUILD_BATCH_SIZE 16)
endfunction()

function(fascia_room name)
  cmake_parse_arguments(ROOM "COLD" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(temperature "")
  if(ROOM_COLD)
    set(temperature COLD)
  endif()
  if(ROOM_SOURCES)
    add_library(fascia_${name} STATIC ${ROOM_SOURCES})
    target_link_libraries(fascia_${name} PUBLIC fascia::options ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
    fascia_use_common_headers(fascia_${name} ${temperature})
    fascia_compile_in_batches(fascia_${name})
  else()
    add_library(fascia_${name} INTERFACE)
    target_link_libraries(fascia_${name} INTERFACE fascia::options ${ROOM_PUBLIC} ${ROOM_PRIVATE})
  endif()
  add_library(fascia::${name} ALIAS fascia_${name})
endfunction()

# fascia_library(NAME ...): a room no product path uses, a library for tools, benchmarks and whoever builds on Fascia;
# built only where something links it.
function(fascia_library name)
  fascia_room(${name} ${ARGN})
  set_target_properties(fascia_${name} PROPERTIES EXCLUDE_FROM_ALL ON)
endfunction()

# fascia_test(NAME [WHOLE] SOURCES file... LINKS target...): one GoogleTest program of tests/<room>/. WHOLE runs it
# as one test, for programs whose cases share a costly set-up.
function(fascia_test name)
  cmake_parse_arguments(TEST "WHOLE" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE fascia::options ${TEST_LINKS} fascia_test_paths GTest::gtest_main)
  fascia_use_common_headers(${name})
  if(TEST_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 600)
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()
