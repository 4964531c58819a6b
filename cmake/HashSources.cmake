# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=DIR -DSOURCES=A;B;... -DHEADER=FILE -P HashSources.cmake
# Writes a header with a hash of the sources that a training depends on.
set(all "")
foreach(source IN LISTS SOURCES)
  file(SHA256 "${ROOT}/${source}" hash)
  string(APPEND all "${source} ${hash}\n")
endforeach()
string(SHA256 code "${all}")
string(SUBSTRING "${code}" 0 16 code)
file(WRITE "${HEADER}" "// Made by cmake/HashSources.cmake.\n#pragma once\nnamespace physpring {\ninline constexpr char kTrainingCode[] = \"${code}\";\n}\n")
