// SPDX-License-Identifier: Apache-2.0
// The one function of the formatting library that the plugin and twin/ call, compiled into the
// plugin (this file alone has FMT_HEADER_ONLY), so that users need no libfmt.
#include <fmt/format.h>

namespace physpring {

[[gnu::used]] static std::string (*const vformat)(fmt::string_view,
                                                  fmt::format_args) = &fmt::vformat;

}  // namespace physpring
