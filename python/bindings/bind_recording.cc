// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/given_recordings.h"
#include "twin/error.h"

namespace physpring {
namespace {

GivenRecording Load(const RecordingEntry& entry) {
  GivenRecording given = Given(entry, ReadNpz(entry.path));
  given.recording.hash = HashFile(entry.path);
  Warn(given.recording.warnings);
  return given;
}

// A NumPy array of numbers, or what becomes one.
NpzArray ArrayOf(const std::string& name, nb::handle value) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  nb::object array = numpy.attr("ma").attr("asanyarray")(value);
  if (nb::cast<bool>(numpy.attr("ma").attr("is_masked")(array))) {  // masked is not seen
    array = array.attr("astype")("float64").attr("filled")(numpy.attr("nan"));
  }
  array = numpy.attr("asarray")(array);
  // big endian, long double, and objects that are numbers
  const auto kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  const bool odd =
      kind == "O" || (kind == "f" && !(nb::cast<bool>(array.attr("dtype").attr("isnative")) &&
                                       nb::cast<int>(array.attr("dtype").attr("itemsize")) <= 8));
  if (odd) {
    try {
      array = array.attr("astype")("float64");
    } catch (const nb::python_error&) {
      throw Error(fmt::format("array '{}' is not of numbers or truth values", name));
    }
  }
  nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu> numbers;
  if (!nb::try_cast(numpy.attr("ascontiguousarray")(array), numbers)) {
    throw Error(fmt::format("array '{}' is not of numbers or truth values", name));
  }
  NpzArray result = NpzFrom(numbers, name);
  // of a scalar, ascontiguousarray makes a list of one
  if (nb::cast<int>(array.attr("ndim")) == 0) result.shape.clear();
  return result;
}

GivenRecording FromArrays(const std::string& name, const nb::kwargs& arrays) {
  if (name.empty() || name.find_first_of(std::string("/\0", 2)) != std::string::npos) {
    throw Error("name is empty or has a '/': it is that of a file without its ending");
  }
  Npz npz;
  for (const auto& [key, value] : arrays) {
    if (value.is_none()) continue;
    const std::string array = nb::cast<std::string>(key);
    npz[array] = ArrayOf(array, value);
  }
  const auto measured = npz.contains("points") ? npz.find("points") : npz.find("surface");
  if (!npz.contains("controllers") && measured != npz.end() && !measured->second.shape.empty()) {
    npz["controllers"] = NpzArray::Floats({measured->second.shape[0], 0, 3}, nullptr);
  }
  GivenRecording given = InMemory(name, std::move(npz));
  Warn(given.recording.warnings);
  return given;
}

std::vector<GivenRecording> LoadDataset(const std::vector<std::string>& paths,
                                        const std::string& role) {
  if (role != "fit" && role != "heldout") throw Error("role is 'fit' or 'heldout'");
  std::vector<GivenRecording> recordings;
  for (const RecordingEntry& entry :
       ListRecordings(paths, role == "fit" ? Role::kFit : Role::kHeldout)) {
    recordings.push_back(Load(entry));
  }
  return recordings;
}

std::string ReprOfRecording(const GivenRecording& given) {
  const Recording& recording = given.recording;
  const std::string seen =
      recording.point_count() > 0 ? fmt::format("{} points", recording.point_count()) : "clouds";
  return fmt::format(
      "<physpring.Recording '{}': {}, {} controllers, {} frames at {:.4g} fps, {:.4g} kg>",
      recording.name, seen, recording.controller_count(), recording.frame_count(), recording.fps,
      recording.mass);
}

}  // namespace

void BindRecording(nb::module_& module) {
  using Class = GivenRecording;
  nb::class_<Class> recording(
      module, "Recording",
      "Measured 3-D points of one deformable object, and of what holds and moves it. SI units, z "
      "up.");
  recording.def_static(
      "load",
      [](const std::filesystem::path& path) {
        RecordingEntry entry;
        entry.path = path.string();
        return Load(entry);
      },
      nb::arg("path"),
      "Reads NAME.npz (docs/files.md). Raises Error, one line that names file, array and what is\n"
      "expected, if anything in it is malformed. What the reader had to assume is a warning.");
  recording.def_static(
      "from_arrays", &FromArrays, nb::arg("name") = "recording", nb::arg("arrays"),
      nb::sig("def from_arrays(name: str = 'recording', **arrays: numpy.typing.ArrayLike) -> "
              "Recording"),
      "A recording of arrays, those of a file (docs/files.md). SI units, z up:\n"
      "  points       (T, N, 3) measured points, followed through T frames; NaN: not seen.\n"
      "               Without them: surface (T, S, 3), clouds, for `register` and `track`\n"
      "  fps          frames per second; or timestamps (T,), s\n"
      "  controllers  (T, C, 3) what holds and moves the object; default: nothing does\n"
      "  mass         of the object, kg; default 0.1, with a warning\n"
      "and, optional: ground (4,), gravity (3,), rest, interior, velocity, order, rod,\n"
      "held, weight, train_frames, surface, track, force, timestamps ... Raises Error as `load` "
      "does.");
  recording.def(
      "save",
      [](const Class& self, const std::filesystem::path& path) {
        WriteNpz(self.arrays, path.string());
      },
      nb::arg("path"),
      "Writes the arrays that it was made of, whole or not at all. The file is the same "
      "recording:\n"
      "a twin that was trained on the one knows the other.");
  recording.def(
      "arrays",
      [](const Class& self) {
        nb::dict arrays;
        for (const auto& [name, array] : self.arrays) arrays[name.c_str()] = CopyOf(array);
        return arrays;
      },
      "The arrays that it was made of, by name.");
  recording.def(
      "check",
      [](const Class& self) {
        std::vector<std::string> remarks = self.recording.warnings;
        for (const std::string& note : self.recording.notes) remarks.push_back(note);
        return remarks;
      },
      "What the reader had to assume, finds odd or worked out, a line each. Malformed recordings\n"
      "do not get this far: `load` and `from_arrays` raise Error.");
  const auto of = [](auto member) {
    return [member](const Class& self) { return self.recording.*member; };
  };
  recording.def_prop_ro("name", of(&Recording::name), "File name without folder and ending.");
  recording.def_prop_ro("path", [](const Class& self) { return self.entry.path; });
  recording.def_prop_ro("hash", of(&Recording::hash), "Of the content, 16 hex digits.");
  recording.def_prop_ro("fps", of(&Recording::fps), "Frames per second.");
  recording.def_prop_ro("mass", of(&Recording::mass), "Of the object, kg.");
  recording.def_prop_ro("train_frames", of(&Recording::train_frames),
                        "Frames before it are for fitting, the rest is the future to predict.");
  recording.def_prop_ro("warnings", of(&Recording::warnings));
  recording.def_prop_ro("notes", of(&Recording::notes));
  const auto copy = [](auto member) {
    return [member](const Class& self) { return CopyOf(self.recording.*member); };
  };
  recording.def_prop_ro("points", copy(&Recording::points),
                        "(T, N, 3) measured points, m; NaN: not seen.", kHasOwner);
  recording.def_prop_ro("controllers", copy(&Recording::controllers),
                        "(T, C, 3) what holds and moves the object, m; C may be 0.", kHasOwner);
  recording.def_prop_ro("start", copy(&Recording::start),
                        "(N + M + C, 3) points, interior particles and controllers in frame 0, m.",
                        kHasOwner);
  recording.def_prop_ro("rest", copy(&Recording::rest), "(N + M + C, 3) stress-free positions, m.",
                        kHasOwner);
  recording.def_prop_ro("velocity", copy(&Recording::velocity),
                        "(N + M, 3) velocities in frame 0, m/s.", kHasOwner);
  recording.def_prop_ro(
      "gravity", [](const Class& self) { return CopyOf(Eigen::VectorXd(self.recording.gravity)); },
      "(3,) m/s^2.", kHasOwner);
  recording.def_prop_ro(
      "ground",
      [](const Class& self) -> std::optional<NumpyDoubles> {
        if (!self.recording.ground) return std::nullopt;
        return CopyOf(Eigen::VectorXd(*self.recording.ground));
      },
      "(4,) a, b, c, d of the plane a x + b y + c z = d, or None.", kHasOwner);
  recording.def("__getstate__", [](const Class& self) {
    const std::string file = PackNpz(self.arrays, self.entry.path);
    return nb::make_tuple(self.entry.path, self.entry.heldout, self.entry.continuous_recording,
                          self.entry.published_l1, self.recording.hash,
                          nb::bytes(file.data(), file.size()));
  });
  recording.def("__setstate__", [](Class& self, const nb::tuple& parts) {
    RecordingEntry entry;
    entry.path = nb::cast<std::string>(parts[0]);
    entry.heldout = nb::cast<bool>(parts[1]);
    entry.continuous_recording = nb::cast<int>(parts[2]);
    entry.published_l1 = nb::cast<bool>(parts[3]);
    const auto file = nb::cast<nb::bytes>(parts[5]);
    Npz arrays = ParseNpz(std::string(file.c_str(), file.size()), entry.path);
    new (&self) Class(Given(std::move(entry), std::move(arrays)));
    self.recording.hash = nb::cast<std::string>(parts[4]);
  });
  recording.def("__copy__", [](const Class& self) { return Class(self); });
  recording.def("__deepcopy__", [](const Class& self, const nb::dict&) { return Class(self); });
  recording.def("__len__", [](const Class& self) { return self.recording.frame_count(); });
  recording.def("__repr__", &ReprOfRecording);
  module.def("load_dataset", &LoadDataset, nb::arg("paths"), nb::arg("role"));
}

}  // namespace physpring
