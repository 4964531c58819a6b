// SPDX-License-Identifier: Apache-2.0
// A library that looks like MuJoCo to the plugin, of a version that the test sets. It keeps what it
// was told.
#include <cstdarg>
#include <cstdio>

extern "C" {

int foreign_version = 0;
char foreign_warning[1000] = "";
int foreign_registrations = 0;

int mj_version() { return foreign_version; }

void mju_warning(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(foreign_warning, sizeof(foreign_warning), format, arguments);
  va_end(arguments);
}

void mjp_defaultPlugin(void*) {}
const void* mjp_getPlugin(const char*, int*) { return nullptr; }
int mjp_registerPlugin(const void*) { return foreign_registrations++; }

}  // extern "C"
