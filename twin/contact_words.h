// SPDX-License-Identifier: Apache-2.0
// The coefficients of contact in words, for people: "restitution 0.5, friction 0.3".
#ifndef PHYSPRING_TWIN_CONTACT_WORDS_H_
#define PHYSPRING_TWIN_CONTACT_WORDS_H_

#include <fmt/format.h>

#include <string>

#include "twin/contact_law.h"

namespace physpring {

inline std::string DescribeCoefficients(const ContactPair<double>& pair) {
  std::string text;
  for (const auto& c : kContactCoefficients<double>) {
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", c.name, pair.*c.member);
  }
  return text;
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONTACT_WORDS_H_
