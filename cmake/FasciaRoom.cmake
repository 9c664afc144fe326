# One room of the house, one library target.
#
#   fascia_room(NAME [SOURCES file...] [PUBLIC target...] [PRIVATE target...])
#
# makes the static library fascia_NAME with the alias fascia::NAME. Headers are included
# by their path from the root of the project: #include "geometry/mesh.h".

find_program(FASCIA_CCACHE ccache)
if(FASCIA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${FASCIA_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${FASCIA_CCACHE})
endif()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nlohmann_json 3.11 REQUIRED)

add_library(fascia_options INTERFACE)
target_include_directories(fascia_options INTERFACE ${PROJECT_SOURCE_DIR})
# Contraction into fused multiply-add changes values between machines; snapshots would differ.
target_compile_options(fascia_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A false alarm of g++ 12 in std::string's operator+.
  target_compile_options(fascia_options INTERFACE -Wno-restrict)
endif()
if(FASCIA_WARNINGS_AS_ERRORS)
  target_compile_options(fascia_options INTERFACE -Werror)
endif()
if(FASCIA_SANITIZE)
  target_compile_options(fascia_options INTERFACE -fsanitize=${FASCIA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(fascia_options INTERFACE -fsanitize=${FASCIA_SANITIZE})
endif()
add_library(fascia::options ALIAS fascia_options)

function(fascia_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ROOM_SOURCES)
    add_library(fascia_${name} STATIC ${ROOM_SOURCES})
    target_link_libraries(fascia_${name} PUBLIC fascia::options ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
  else()
    add_library(fascia_${name} INTERFACE)
    target_link_libraries(fascia_${name} INTERFACE fascia::options ${ROOM_PUBLIC} ${ROOM_PRIVATE})
  endif()
  add_library(fascia::${name} ALIAS fascia_${name})
endfunction()

# fascia_test(NAME [WHOLE] SOURCES file... LINKS target...): one GoogleTest program of tests/<room>/. WHOLE runs it
# as one test, for programs whose cases share a costly set-up.
function(fascia_test name)
  cmake_parse_arguments(TEST "WHOLE" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE fascia::options ${TEST_LINKS} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    FASCIA_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    FASCIA_SNAPSHOTS="${PROJECT_SOURCE_DIR}/tests/snapshots"
    FASCIA_MEASURED_DATA="${PROJECT_SOURCE_DIR}/../shared"
    FASCIA_TOOL="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/fascia")
  if(TEST_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 600)
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()
