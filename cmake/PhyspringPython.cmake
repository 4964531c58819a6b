# SPDX-License-Identifier: Apache-2.0
# What the Python package needs, before all targets: pyproject.toml turns this on.
find_package(Python 3.10 REQUIRED COMPONENTS Interpreter Development.Module)
execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir
                OUTPUT_VARIABLE nanobind_ROOT OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
find_package(nanobind CONFIG REQUIRED)

# Python's MuJoCo, which pyproject.toml asks for, if no other is named
if(NOT DEFINED MuJoCo_ROOT AND NOT DEFINED ENV{MuJoCo_ROOT})
  execute_process(COMMAND "${Python_EXECUTABLE}" -c
    "import importlib.util as u; s = u.find_spec('mujoco'); print(s.submodule_search_locations[0] if s else '')"
    OUTPUT_VARIABLE python_mujoco OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(python_mujoco)
    set(MuJoCo_ROOT "${python_mujoco}")
  endif()
endif()

# the rooms go into a shared library
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
