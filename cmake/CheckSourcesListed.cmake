# SPDX-License-Identifier: Apache-2.0
# cmake -P CheckSourcesListed.cmake: fails when a source below a room, tests/ or bench/ is missing
# in that folder's CMakeLists.txt (sources are listed by name, so nobody would build it). A room
# may take all of a folder: file(GLOB ... FOLDER/*.cc).

cmake_minimum_required(VERSION 3.25)
get_filename_component(root "${CMAKE_CURRENT_LIST_DIR}" DIRECTORY)
file(GLOB lists RELATIVE "${root}" "${root}/*/CMakeLists.txt")
set(missing "")
foreach(list IN LISTS lists)
  get_filename_component(room "${list}" DIRECTORY)
  file(READ "${root}/${list}" text)
  string(REGEX REPLACE "#[^\n]*" "" text "${text}")
  string(REGEX MATCHALL "[A-Za-z0-9_/.]+\\.cc" listed "${text}")
  file(GLOB_RECURSE sources RELATIVE "${root}/${room}" "${root}/${room}/*.cc")
  foreach(source IN LISTS sources)
    get_filename_component(folder "${source}" DIRECTORY)
    string(FIND "${text}" " ${folder}/*.cc" globbed)
    if(globbed EQUAL -1 AND NOT source IN_LIST listed)
      string(APPEND missing "\n  ${room}/${source}")
    endif()
  endforeach()
endforeach()
if(missing)
  message(FATAL_ERROR "Not listed in the CMakeLists.txt of their room:${missing}")
endif()
