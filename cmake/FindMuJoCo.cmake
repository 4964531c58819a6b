# SPDX-License-Identifier: Apache-2.0
# Finds MuJoCo and makes the target MuJoCo::MuJoCo.
#
# MuJoCo_ROOT (CMake or environment variable) may be
#   a wheel folder      .../site-packages/mujoco, or the folder that holds it
#   a release tarball   mujoco-4.0.0/ with include/mujoco/ and lib/
#   an install prefix   /opt/mujoco or /usr/local, also of an installed CMake package
# and is then the only place searched. Without it: CMAKE_PREFIX_PATH, the wheel that scripts/setup
# put into .deps/mujoco, the system. A version outside the range asked for is refused. Sets
# MuJoCo_VERSION, MuJoCo_INCLUDE_DIR and MuJoCo_LIBRARY.

if(DEFINED MuJoCo_ROOT)
  set(_root "${MuJoCo_ROOT}")
elseif(DEFINED ENV{MuJoCo_ROOT})
  set(_root "$ENV{MuJoCo_ROOT}")
else()
  set(_root "")
endif()

if(_root)
  get_filename_component(_root "${_root}" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
  set(_where PATHS "${_root}" NO_DEFAULT_PATH)
  set(_searched "${_root} (MuJoCo_ROOT)")
else()
  set(_where HINTS "${CMAKE_CURRENT_LIST_DIR}/../.deps/mujoco")
  set(_searched "CMAKE_PREFIX_PATH, .deps/mujoco and the system")
endif()

# searched again at every run, so that a new MuJoCo_ROOT takes effect
find_path(MuJoCo_INCLUDE_DIR NAMES mujoco/mujoco.h ${_where}
          PATH_SUFFIXES include mujoco/include NO_CACHE)

# mjVERSION_HEADER is MMMmmmppp: 4000000 is 4.0.0 (before 3.5 it had one digit each: 334 is 3.3.4)
if(MuJoCo_INCLUDE_DIR)
  file(STRINGS "${MuJoCo_INCLUDE_DIR}/mujoco/mujoco.h" _line REGEX "#define mjVERSION_HEADER +[0-9]+")
  if(_line MATCHES "mjVERSION_HEADER +([0-9]+)")
    set(_base 10)
    if(CMAKE_MATCH_1 GREATER 9999)
      set(_base 1000)
    endif()
    math(EXPR _major "${CMAKE_MATCH_1} / ${_base} / ${_base}")
    math(EXPR _minor "${CMAKE_MATCH_1} / ${_base} % ${_base}")
    math(EXPR _patch "${CMAKE_MATCH_1} % ${_base}")
    set(MuJoCo_VERSION "${_major}.${_minor}.${_patch}")
  endif()
endif()

# a wheel has the library under its full name only
find_library(MuJoCo_LIBRARY NAMES mujoco libmujoco.so.${MuJoCo_VERSION} ${_where}
             PATH_SUFFIXES lib lib64 lib/${CMAKE_LIBRARY_ARCHITECTURE} mujoco NO_CACHE)

# the library carries its version in its file name
set(_problem "")
if(NOT MuJoCo_INCLUDE_DIR)
  set(_problem "no mujoco/mujoco.h")
elseif(NOT MuJoCo_LIBRARY)
  set(_problem "headers of ${MuJoCo_VERSION} in ${MuJoCo_INCLUDE_DIR}, but no libmujoco.so of that version")
else()
  file(REAL_PATH "${MuJoCo_LIBRARY}" _file)
  if(_file MATCHES "\\.so\\.([0-9]+\\.[0-9]+\\.[0-9]+)$" AND MuJoCo_VERSION
     AND NOT CMAKE_MATCH_1 VERSION_EQUAL MuJoCo_VERSION)
    set(_problem "headers of ${MuJoCo_VERSION} in ${MuJoCo_INCLUDE_DIR}, but library ${_file}")
    set(MuJoCo_LIBRARY MuJoCo_LIBRARY-NOTFOUND)
  endif()
endif()
if(_problem)
  set(_problem "Searched ${_searched}: ${_problem}.")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MuJoCo
  REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR
  VERSION_VAR MuJoCo_VERSION
  HANDLE_VERSION_RANGE
  REASON_FAILURE_MESSAGE "${_problem}
  MuJoCo ${MuJoCo_FIND_VERSION_MAJOR}.${MuJoCo_FIND_VERSION_MINOR} is needed: run scripts/setup, or give -DMuJoCo_ROOT=DIR (wheel folder, release tarball or install prefix).")

if(MuJoCo_FOUND AND NOT TARGET MuJoCo::MuJoCo)
  add_library(MuJoCo::MuJoCo SHARED IMPORTED)
  set_target_properties(MuJoCo::MuJoCo PROPERTIES
    IMPORTED_LOCATION "${MuJoCo_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MuJoCo_INCLUDE_DIR}")
endif()
