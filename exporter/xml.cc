// SPDX-License-Identifier: Apache-2.0
#include "exporter/xml.h"

#include <fmt/format.h>

namespace physpring {
namespace {

class Printer : public tinyxml2::XMLPrinter {
 protected:
  void PrintSpace(int depth) override {
    for (int i = 0; i < depth; ++i) Write("  ");
  }
};

}  // namespace

std::string Number(double value) {
  // no "-0": it is a zero
  return fmt::format("{}", value == 0 ? 0.0 : value);
}

std::string Numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    text += Number(value);
  }
  return text;
}

std::string Numbers(const std::vector<int>& values) {
  return fmt::format("{}", fmt::join(values, " "));
}

XmlElement* AddElement(XmlElement* parent, const char* tag, XmlAttributes attributes) {
  XmlElement* element = parent->InsertNewChildElement(tag);
  for (const auto& [name, value] : attributes) element->SetAttribute(name, value.c_str());
  return element;
}

XmlElement* Section(XmlElement* parent, const char* tag) {
  XmlElement* section = parent->FirstChildElement(tag);
  return section ? section : AddElement(parent, tag);
}

void AddComment(XmlElement* parent, const std::string& text) {
  parent->InsertNewComment((" " + text + " ").c_str());
}

std::string Print(const tinyxml2::XMLDocument& document) {
  Printer printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace physpring
