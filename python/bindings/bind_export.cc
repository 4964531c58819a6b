// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "exporter/folder.h"
#include "jobs/export.h"
#include "jobs/export_words.h"
#include "python/bindings/bindings.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace nb = nanobind;

// What `word` stands for.
template <class Kind, std::size_t kCount>
Kind KindOf(const char* name, const std::string& word, const Word<Kind> (&words)[kCount]) {
  if (const auto kind = MeaningOf(words, word)) return *kind;
  std::string choices;
  for (const auto& [choice, meaning] : words) {
    choices += (choices.empty() ? "'" : ", '") + std::string(choice) + "'";
  }
  throw Error(fmt::format("{} is '{}', expected one of {}", name, word, choices));
}

}  // namespace

void BindExport(nb::module_& module) {
  nb::class_<ExportedFolder> folder(module, "ExportedFolder");
  folder.def_prop_ro("files", [](const ExportedFolder& self) {
    nb::dict files;
    for (const auto& [name, content] : self.files) {
      files[name.c_str()] = nb::bytes(content.data(), content.size());
    }
    return files;
  });
  folder.def(
      "write",
      [](const ExportedFolder& self, const std::string& path, bool force) {
        WriteFolder(path, self.files, force);
      },
      nb::arg("path"), nb::arg("force"));
  module.def(
      "export_twin",
      [](const GivenTwin& twin, const std::string& command, const std::string& name, int level,
         const std::string& springs, const std::string& controllers, const std::string& contact,
         int flexes, double timestep, const std::string& mesh, int samples, std::uint64_t seed) {
        ExportOptions options;
        options.name = name;
        options.level = level;
        options.springs = KindOf("springs", springs, kSpringWords);
        options.controllers = KindOf("controllers", controllers, kControllerWords);
        options.contact = KindOf("contact", contact, kContactWords);
        options.flexes = flexes;
        options.timestep = timestep;
        options.mesh = mesh;
        ExportedFolder result = MakeExport(Checked(twin), options, command, {samples, seed});
        std::vector<std::string> warnings;
        for (const std::string& warning : result.warnings) {
          warnings.push_back(twin.path + ": " + warning);
        }
        Warn(warnings);
        return result;
      },
      nb::arg("twin"), nb::arg("command"), nb::arg("name"), nb::arg("level"), nb::arg("springs"),
      nb::arg("controllers"), nb::arg("contact"), nb::arg("flexes"), nb::arg("timestep"),
      nb::arg("mesh"), nb::arg("samples"), nb::arg("seed"));
}

}  // namespace physpring
