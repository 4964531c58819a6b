// SPDX-License-Identifier: Apache-2.0
// A library that looks like MuJoCo to the loader, of another version than the plugin's. It keeps
// what it was told.
#include <cstdarg>
#include <cstdio>

extern "C" {

char foreign_warning[1000] = "";
int foreign_registrations = 0;

int mj_version() { return 4001000; }

void mju_warning(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(foreign_warning, sizeof(foreign_warning), format, arguments);
  va_end(arguments);
}

int mjp_registerPlugin(const void*) { return foreign_registrations++; }

}  // extern "C"
