# SPDX-License-Identifier: Apache-2.0
# All compiler flags of the project, once: every target links `physpring_options`.

option(PHYSPRING_WERROR "Treat warnings as errors" OFF)
option(PHYSPRING_SANITIZE "Build with AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
option(PHYSPRING_FUZZ "Build the fuzz targets for libFuzzer, too (needs clang)" OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo)
endif()
# no -DNDEBUG: asserts stay on; -g1, lines for backtraces, compiles a third faster than -g
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O3 -g1")
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)  # an installed program still finds libmujoco

add_library(physpring_options INTERFACE)
target_compile_features(physpring_options INTERFACE cxx_std_20)
target_compile_definitions(physpring_options INTERFACE
  PHYSPRING_VERSION="${PROJECT_VERSION}"
  # Eigen cuts sums of matrix products to the processor's caches: with fixed sizes every machine
  # gives the same bits
  EIGEN_NO_CPUID)
target_include_directories(physpring_options INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(physpring_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast
  -Wcast-qual -Wvla
  $<$<BOOL:${PHYSPRING_WERROR}>:-Werror>
  # g++ 12 sees an overflow in fmt's headers that is not there
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-stringop-overflow>
  # clang does not know g++'s ivdep
  $<$<CXX_COMPILER_ID:Clang>:-Wno-unknown-pragmas>
  # a fused multiply-add rounds once instead of twice: without it every machine gives the same bits
  -ffp-contract=off)

if(PHYSPRING_SANITIZE)
  set(sanitize -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(physpring_options INTERFACE -O1 -g1 ${sanitize})
  target_link_options(physpring_options INTERFACE ${sanitize})
endif()
if(PHYSPRING_FUZZ)
  # libFuzzer's view of which code an input reaches; its main comes with the targets alone
  target_compile_options(physpring_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
