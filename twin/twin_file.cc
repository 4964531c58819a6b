// SPDX-License-Identifier: Apache-2.0
// The file of a twin, NAME.twin.npz: numbers as arrays (springs in int32, all else in double, so
// that what is read is what was written, bit for bit), words and counts as JSON in `meta`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "twin/cone_name.h"
#include "twin/effects/effect_json.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/json_fields.h"
#include "twin/level_numbers.h"
#include "twin/npz.h"
#include "twin/npz_fields.h"
#include "twin/quote.h"
#include "twin/recorded_rod.h"
#include "twin/twin.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "physpring twin";
constexpr int kVersion = 1;
constexpr double kUnit = 1e-9;  // rounding of a normal of length 1
constexpr const char* kStatePrefix = "train/";

std::string LevelPrefix(std::size_t level) { return fmt::format("level{}/", level); }

NpzArray StoreVector(const Eigen::VectorXd& values) {
  return NpzArray::Doubles({ExtentOf(values.size())}, values.data());
}

NpzArray StoreMatrix(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd transposed = values.transpose();  // rows first
  return NpzArray::Doubles({ExtentOf(values.rows()), ExtentOf(values.cols())}, transposed.data());
}

void StoreLinear(const LinearPredictor& linear, Npz& arrays) {
  arrays["linear/feature_mean"] = StoreVector(linear.feature_mean);
  arrays["linear/components"] = StoreMatrix(linear.components);
  arrays["linear/weights"] = StoreMatrix(linear.weights);
  arrays["linear/mean"] = StoreVector(linear.mean);
}

void StorePosterior(const Posterior& posterior, Npz& arrays) {
  arrays["posterior/stiffness"] = StoreMatrix(posterior.stiffness);
  arrays["posterior/loss_time"] = StoreMatrix(posterior.loss_time);
  arrays["posterior/drag"] = StoreVector(posterior.drag);
  arrays["posterior/contact"] = StoreMatrix(posterior.contact);
  arrays["posterior/effects"] = StoreMatrix(posterior.effects);
}

void StoreLevel(const TwinLevel& level, const std::string& prefix, Npz& arrays) {
  const SpringMassSystem& system = level.system;
  arrays[prefix + "position"] =
      NpzArray::Doubles({ExtentOf(system.position.cols()), 3}, system.position.data());
  std::vector<int> ends;
  for (const auto& [a, b] : system.springs) ends.insert(ends.end(), {a, b});
  arrays[prefix + "springs"] = NpzArray::Ints({system.springs.size(), 2}, ends.data());
  arrays[prefix + "substeps_per_second"] = NpzArray::Ints({}, &level.substeps_per_second);
  if (system.dashpot_stages > 1) {
    arrays[prefix + "dashpot_stages"] = NpzArray::Ints({}, &system.dashpot_stages);
  }
  if (!level.assignment.empty()) {
    arrays[prefix + "assignment"] =
        NpzArray::Ints({level.assignment.size()}, level.assignment.data());
  }
  if (!system.effects.empty()) {
    arrays[prefix + "effects"] = NpzArray::Text(EffectsToJson(system.effects));
  }
  if (system.contact.surface.cone == FrictionCone::kPyramidal) {  // absent where it is elliptic
    arrays[prefix + "cone"] = NpzArray::Text(kPyramidal);
  }
  for (const LevelScalar& number : kLevelScalars) {
    const double value = number.In(system);
    arrays[prefix + number.name] = NpzArray::Doubles({}, &value);
  }
  for (const LevelList& list : kLevelLists) {
    arrays[prefix + list.name] = StoreVector(list.In(system));
  }
}

// Adds the units of the level's numbers, of contacts or of all else.
void AddUnits(bool contacts, Json* units) {
  const auto add = [&](const auto& number) {
    const bool of_contacts =
        number.role != NumberRole::kBody && number.role != NumberRole::kSprings;
    if (of_contacts == contacts && *number.unit != '\0') (*units)[number.name] = number.unit;
  };
  for (const LevelList& list : kLevelLists) add(list);
  for (const LevelScalar& number : kLevelScalars) add(number);
}

Json Units() {
  Json units = {{"position", "m"}};
  AddUnits(false, &units);
  units.update({{"order", "m"}, {"fps", "1/s"}, {"gravity", "m/s^2"}});
  AddUnits(true, &units);
  return units;
}

std::string StoreMeta(const Twin& twin, const std::string& path) {
  Json recordings = Json::array();
  for (const TrainedOn& recording : twin.trained_on) {
    recordings.push_back({{"name", recording.name},
                          {"hash", recording.hash},
                          {"train_frames", recording.train_frames}});
  }
  const JsonFields options(twin.options_json, path + ": options");
  Json meta = {{"format", kFormat},
               {"version", kVersion},
               {"program", "physpring " PHYSPRING_VERSION},
               {"units", Units()},
               {"name", twin.name},
               {"levels", twin.levels.size()},
               {"points", twin.points},
               {"interior", twin.interior},
               {"controllers", twin.levels.empty() ? 0 : twin.levels[0].system.controllers},
               {"controller_velocity", twin.controller_velocity},
               {"recordings", recordings},
               {"seed", twin.seed},
               {"options", options.json()}};
  if (twin.material) meta["material"] = MaterialToJson(*twin.material);
  if (twin.fit_errors) meta["fit_errors"] = FitErrorsToJson(*twin.fit_errors);
  if (twin.clock_offset) meta["clock_offset_s"] = *twin.clock_offset;
  if (twin.force_scale) meta["force_scale"] = *twin.force_scale;
  // a file name need not be UTF-8
  return meta.dump(1, ' ', false, Json::error_handler_t::replace);
}

// `rod` only where not all columns follow each other by their arc lengths.
void StoreRod(const Rod& rod, Npz& arrays) {
  if (rod.empty()) return;
  arrays["order"] = StoreVector(rod.arc);
  if (rod.edges == PlainRod(rod.arc).edges) return;
  arrays["rod"] = StoreRodEdges(rod.edges);
}

Rod ReadRod(NpzFields* fields) {
  if (!fields->Has("order")) return {};
  const Eigen::VectorXd arc = fields->Vector("order", "nodes+controllers");
  if (!fields->Has("rod")) return PlainRod(arc);
  return {arc, ReadRodEdges(*fields, arc.size())};
}

Npz StoreTwin(const Twin& twin, const std::string& path) {
  Npz arrays;
  arrays["meta"] = NpzArray::Text(StoreMeta(twin, path));
  arrays["fps"] = NpzArray::Doubles({}, &twin.fps);
  arrays["gravity"] = NpzArray::Doubles({3}, twin.gravity.data());
  if (twin.ground.known) {
    const auto& plane = twin.ground.plane;
    arrays["ground"] =
        plane ? NpzArray::Doubles({4}, plane->data()) : NpzArray::Doubles({0}, nullptr);
  }
  StoreRod(twin.rod, arrays);
  if (!twin.late.empty()) {
    const std::vector<int> late(twin.late.begin(), twin.late.end());
    arrays["late"] = NpzArray::Ints({late.size()}, late.data());
  }
  if (!twin.linear.empty()) StoreLinear(twin.linear, arrays);
  if (!twin.posterior.empty()) StorePosterior(twin.posterior, arrays);
  for (std::size_t n = 0; n < twin.levels.size(); ++n) {
    StoreLevel(twin.levels[n], LevelPrefix(n), arrays);
  }
  for (const auto& [name, array] : twin.training_state) {
    if (!name.starts_with(kStatePrefix)) {
      throw Error(fmt::format("{}: training state {} is not named {}NAME", path, Quote(name),
                              kStatePrefix));
    }
    arrays[name] = array;
  }
  return arrays;
}

TrainedOn ReadTrainedOn(const JsonFields& fields) {
  fields.ExpectOnly({"name", "hash", "train_frames"});
  TrainedOn recording{fields.Text("name"), fields.Text("hash"), fields.Count("train_frames")};
  const bool is_hash = recording.hash.empty() ||
                       (recording.hash.size() == 16 &&
                        recording.hash.find_first_not_of("0123456789abcdef") == std::string::npos);
  if (!is_hash) fields.Fail("hash", "is not 16 hexadecimal digits");
  return recording;
}

// Fills what `meta` says of the twin; returns the numbers of levels and of controllers.
std::pair<std::size_t, int> ReadMeta(const NpzFields& arrays, const std::string& path, Twin& twin) {
  const JsonFields meta(arrays.Text("meta"), path + ": array 'meta'");
  if (meta.Text("format") != kFormat) meta.Fail("format", fmt::format("is not '{}'", kFormat));
  const int version = meta.Count("version");
  if (version != kVersion) {
    meta.Fail("version", fmt::format("holds {}, expected {}", version, kVersion));
  }
  meta.ExpectOnly({"format", "version", "program", "units", "name", "levels", "points", "interior",
                   "controllers", "controller_velocity", "recordings", "seed", "options",
                   "material", "fit_errors", "clock_offset_s", "force_scale"});
  twin.name = meta.Text("name");
  twin.points = meta.Count("points");
  twin.interior = meta.Count("interior");
  twin.controller_velocity = meta.Flag("controller_velocity");
  for (const JsonFields& recording : meta.Objects("recordings")) {
    twin.trained_on.push_back(ReadTrainedOn(recording));
  }
  twin.seed = meta.Unsigned("seed");
  twin.options_json = meta.Object("options").Dump();
  if (meta.Has("material")) twin.material = MaterialFromJson(meta.Object("material"));
  if (meta.Has("fit_errors")) twin.fit_errors = FitErrorsFromJson(meta.Object("fit_errors"));
  if (meta.Has("clock_offset_s")) twin.clock_offset = meta.Number("clock_offset_s");
  if (meta.Has("force_scale")) twin.force_scale = meta.Number("force_scale");
  const int levels = meta.Count("levels");
  if (levels < 1) meta.Fail("levels", "holds 0, expected at least 1");
  return {static_cast<std::size_t>(levels), meta.Count("controllers")};
}

// Every node of the level below goes to a node of this level, and every node is gone to.
void ExpectOnto(const NpzFields& fields, const std::string& name,
                const std::vector<int>& assignment, int nodes) {
  std::vector<bool> used(static_cast<std::size_t>(nodes), false);
  for (std::size_t i = 0; i < assignment.size(); ++i) {
    if (assignment[i] < 0 || assignment[i] >= nodes) {
      fields.Fail(name, fmt::format("holds {} at [{}], expected nodes from 0 to {}", assignment[i],
                                    i, nodes - 1));
    }
    used[static_cast<std::size_t>(assignment[i])] = true;
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused == used.end()) return;
  fields.Fail(name, fmt::format("gives nothing to node {}", unused - used.begin()));
}

// Reads where the nodes are and which of them springs join: these say how many there are of each,
// and every other list of the level is compared with that.
void ReadShape(NpzFields* fields, const std::string& prefix, int controllers,
               SpringMassSystem* system) {
  const std::string position = prefix + "position";
  system->position = fields->Positions(position, "nodes+controllers");
  const std::size_t count = fields->Extent("nodes+controllers");
  if (count <= ExtentOf(controllers)) {
    fields->Fail(position, fmt::format("holds {} places, {} of them controllers, expected a node "
                                       "or more",
                                       count, controllers));
  }
  fields->SetExtent("nodes", count - ExtentOf(controllers));
  system->controllers = controllers;
  const std::vector<int> ends = fields->Ints(prefix + "springs", {"springs", "2"});
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    system->springs.push_back({ends[i], ends[i + 1]});
  }
}

TwinLevel ReadLevel(NpzFields fields, const std::string& where, std::size_t n, int controllers,
                    int nodes_below) {
  const std::string prefix = LevelPrefix(n);
  TwinLevel level;
  ReadShape(&fields, prefix, controllers, &level.system);
  for (const LevelList& list : kLevelLists) {
    list.In(level.system) =
        fields.Vector(prefix + list.name, list.of_springs ? "springs" : "nodes");
  }
  for (const LevelScalar& number : kLevelScalars) {
    number.In(level.system) = fields.Scalar(prefix + number.name);
  }
  if (fields.Has(prefix + "cone")) {
    const std::string cone = fields.Text(prefix + "cone");
    if (cone != kPyramidal) {
      fields.Fail(prefix + "cone", fmt::format("holds {}, expected {}", Quote(cone), kPyramidal));
    }
    level.system.contact.surface.cone = FrictionCone::kPyramidal;
  }
  if (fields.Has(prefix + "effects")) {
    level.system.effects =
        EffectsFromJson(fields.Text(prefix + "effects"), where + ": array 'effects'");
  }
  if (fields.Has(prefix + "dashpot_stages")) {  // absent where it is 1
    level.system.dashpot_stages = fields.Ints(prefix + "dashpot_stages", {})[0];
  }
  level.system.Validate(where);
  if (level.system.springs.empty())
    fields.Fail(prefix + "springs", "holds no spring, expected one or more");

  level.substeps_per_second = fields.Ints(prefix + "substeps_per_second", {})[0];
  if (level.substeps_per_second < 1) {
    fields.Fail(prefix + "substeps_per_second",
                fmt::format("holds {}, expected more than 0", level.substeps_per_second));
  }
  if (n == 0) return level;
  fields.SetExtent("nodes below", static_cast<std::size_t>(nodes_below));
  level.assignment = fields.Ints(prefix + "assignment", {"nodes below"});
  ExpectOnto(fields, prefix + "assignment", level.assignment, level.system.node_count());
  return level;
}

// Four numbers, or none where there was no ground.
TrainedGround ReadTrainedGround(NpzFields* fields) {
  const Eigen::VectorXd plane = fields->Vector("ground", "ground");
  if (plane.size() == 0) return {.known = true, .plane = {}};
  if (plane.size() != 4) {
    fields->Fail("ground",
                 fmt::format("has {} numbers, expected 4 (a, b, c, d), or none", plane.size()));
  }
  const double length = plane.head<3>().norm();
  if (std::abs(length - 1) > kUnit) {
    fields->Fail("ground", fmt::format("has a normal of length {}, expected 1", length));
  }
  return {.known = true, .plane = Eigen::Vector4d(plane)};
}

ControllerMask ReadLate(NpzFields* fields, int controllers) {
  fields->SetExtent("controllers", static_cast<std::size_t>(controllers));
  const std::vector<int> late = fields->Ints("late", {"controllers"});
  for (int one : late) {
    if (one != 0 && one != 1) fields->Fail("late", fmt::format("holds {}, expected 0 or 1", one));
  }
  return {late.begin(), late.end()};
}

LinearPredictor ReadLinear(NpzFields* fields, int points, int controllers) {
  fields->SetExtent("features", static_cast<std::size_t>(LinearFeatures(controllers)));
  fields->SetExtent("3 points", 3 * static_cast<std::size_t>(points));
  LinearPredictor linear;
  linear.feature_mean = fields->Vector("linear/feature_mean", "features");
  linear.components = fields->Matrix("linear/components", "features", "components");
  linear.weights = fields->Matrix("linear/weights", "3 points", "components");
  linear.mean = fields->Vector("linear/mean", "3 points");
  return linear;
}

Posterior ReadPosterior(NpzFields* fields, const SpringMassSystem& dense) {
  fields->SetExtent("springs", ExtentOf(dense.spring_count()));
  fields->SetExtent("coefficients", ExtentOf(kContactCount));
  fields->SetExtent("values of effects", ExtentOf(EffectValueCount(dense.effects)));
  Posterior posterior;
  posterior.stiffness = fields->Matrix("posterior/stiffness", "directions", "springs");
  posterior.loss_time = fields->Matrix("posterior/loss_time", "directions", "springs");
  posterior.drag = fields->Vector("posterior/drag", "directions");
  posterior.contact = fields->Matrix("posterior/contact", "directions", "coefficients");
  posterior.effects = fields->Matrix("posterior/effects", "directions", "values of effects");
  return posterior;
}

}  // namespace

Twin ParseTwin(const Npz& arrays, const std::string& path) {
  NpzFields fields(arrays, path);
  if (!arrays.contains("meta") && arrays.contains("points"))
    fields.Fail("is a recording, not a twin");
  Twin twin;
  const auto [levels, controllers] = ReadMeta(fields, path, twin);

  int nodes_below = 0;
  for (std::size_t n = 0; n < levels; ++n) {
    const std::string where = fmt::format("{}: level {}", path, n);
    twin.levels.push_back(ReadLevel(fields, where, n, controllers, nodes_below));
    nodes_below = twin.levels[n].system.node_count();
  }
  const int nodes = twin.levels[0].system.node_count();
  if (twin.points < 1 || twin.points > nodes || twin.interior != nodes - twin.points) {
    fields.Fail("meta", fmt::format("counts {} points and {} interior particles, but level 0 has "
                                    "{} nodes",
                                    twin.points, twin.interior, nodes));
  }
  twin.fps = fields.Scalar("fps");
  if (twin.fps <= 0) fields.Fail("fps", fmt::format("holds {}, expected more than 0", twin.fps));
  twin.gravity = fields.Vector("gravity", "3");
  if (fields.Has("ground")) twin.ground = ReadTrainedGround(&fields);
  fields.SetExtent("nodes+controllers", ExtentOf(twin.levels[0].system.position.cols()));
  twin.rod = ReadRod(&fields);
  SpreadRod(&twin);
  if (fields.Has("late")) twin.late = ReadLate(&fields, controllers);
  if (fields.Has("linear/mean")) twin.linear = ReadLinear(&fields, twin.points, controllers);

  if (fields.Has("posterior/stiffness")) {
    twin.posterior = ReadPosterior(&fields, twin.levels[0].system);
  }

  for (const auto& [name, array] : arrays) {
    if (name.starts_with(kStatePrefix)) twin.training_state[name] = array;
  }
  // what was read is all there is: storing it again gives the same names
  const Npz known = StoreTwin(twin, path);
  for (const auto& [name, array] : arrays) {
    if (known.contains(name)) continue;
    fields.Fail(fmt::format("array {} is not part of a twin of {} levels", Quote(name), levels));
  }
  return twin;
}

Twin ReadTwin(const std::string& path) { return ParseTwin(ReadNpz(path), path); }

Npz CheckedArraysOf(const Twin& twin, const std::string& path) {
  Npz arrays = StoreTwin(twin, path);
  ParseTwin(arrays, path);
  return arrays;
}

void WriteTwin(const Twin& twin, const std::string& path) {
  WriteNpz(CheckedArraysOf(twin, path), path);  // what the reader would refuse is not written
}

}  // namespace physpring
