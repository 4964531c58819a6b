// SPDX-License-Identifier: Apache-2.0
#include "exporter/xml.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

TEST(Xml, NumbersReadBackAsTheyWere) {
  Random random(3);
  for (int i = 0; i < 10000; ++i) {
    const double value = random(-1, 1) * std::pow(10, random(-300, 300));
    EXPECT_EQ(std::strtod(Number(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(std::strtod(Number(std::numeric_limits<double>::denorm_min()).c_str(), nullptr),
            std::numeric_limits<double>::denorm_min());
}

TEST(Xml, NumbersAreShort) {
  EXPECT_EQ(Number(0.1), "0.1");
  EXPECT_EQ(Number(-0.0), "0");
  EXPECT_EQ(Number(5), "5");
  EXPECT_EQ(Numbers(Eigen::Vector3d(1, -0.5, 1e-9)), "1 -0.5 1e-09");
  EXPECT_EQ(Numbers(std::vector<int>{3, 1}), "3 1");
}

TEST(Xml, IsIndentedByTwo) {
  tinyxml2::XMLDocument document;
  XmlElement* top = document.NewElement("top");
  document.InsertEndChild(top);
  AddElement(AddElement(top, "a"), "b", {{"name", "x<&\">"}, {"value", "1"}});
  AddComment(top, "why");
  EXPECT_EQ(Print(document),
            "<top>\n  <a>\n    <b name=\"x&lt;&amp;&quot;&gt;\" value=\"1\"/>\n  </a>\n"
            "  <!-- why -->\n</top>\n");
}

}  // namespace
}  // namespace physpring
