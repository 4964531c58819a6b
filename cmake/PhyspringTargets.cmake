# SPDX-License-Identifier: Apache-2.0
# One CMake target a room, one executable a test file.

# physpring_room(twin SOURCES npz.cc ... LIBS Eigen3::Eigen ...)
# makes the static library physpring_twin. Its libraries reach those who link it.
function(physpring_room name)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "" "SOURCES;LIBS")
  add_library(physpring_${name} STATIC ${room_SOURCES})
  target_link_libraries(physpring_${name} PUBLIC physpring_options ${room_LIBS})
endfunction()

# The work is in the rooms: compiling the tests took more time than running them.
function(physpring_test_options name)
  target_compile_definitions(${name} PRIVATE PHYSPRING_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1;-g0>)
endfunction()

# physpring_test(twin/npz_test.cc LIBS physpring_twin [LABELS slow] [SUPPORT more.cc ...])
# makes the program twin_npz_test and one CTest test for each TEST in it. Tests with the label
# `slow` are left out of the default suite.
function(physpring_test source)
  cmake_parse_arguments(PARSE_ARGV 1 test "" "" "LIBS;LABELS;SUPPORT")
  set(properties TIMEOUT 300)
  if(PHYSPRING_SANITIZE)
    set(properties TIMEOUT 1500)
  endif()
  if(test_LABELS)
    list(APPEND properties LABELS "${test_LABELS}")
  endif()
  string(REGEX REPLACE "\\.cc$" "" name "${source}")
  string(REPLACE "/" "_" name "${name}")
  add_executable(${name} ${source} ${test_SUPPORT})
  target_link_libraries(${name} PRIVATE
    physpring_options physpring_test_support ${test_LIBS} GTest::gmock GTest::gtest_main)
  physpring_test_options(${name})
  target_precompile_headers(${name} REUSE_FROM physpring_test_headers)
  gtest_discover_tests(${name}
    TEST_PREFIX "${name}."
    DISCOVERY_MODE PRE_TEST
    PROPERTIES ${properties})
endfunction()
