// SPDX-License-Identifier: Apache-2.0
// MJCF as text: numbers that read back as the same doubles, elements with attributes in the order
// given, 2-space indent.
#ifndef PHYSPRING_EXPORTER_XML_H_
#define PHYSPRING_EXPORTER_XML_H_

#include <tinyxml2.h>

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace physpring {

using XmlElement = tinyxml2::XMLElement;
using XmlAttributes = std::initializer_list<std::pair<const char*, std::string>>;

// The shortest decimal that reads back as the same double.
std::string Number(double value);

// Numbers with a space in between.
std::string Numbers(const Eigen::Ref<const Eigen::VectorXd>& values);
std::string Numbers(const std::vector<int>& values);

// Appends <tag .../> to `parent`.
XmlElement* AddElement(XmlElement* parent, const char* tag, XmlAttributes attributes = {});

// The element <tag> of `parent`, appended if there is none.
XmlElement* Section(XmlElement* parent, const char* tag);

// Appends <!-- text -->; the text must not hold "--".
void AddComment(XmlElement* parent, const std::string& text);

std::string Print(const tinyxml2::XMLDocument& document);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_XML_H_
